//! The Beckmann microfacet reflection lobe, its masking by quadrature.

use std::f64::consts::PI;

use glam::{DVec3, dvec3};

use crate::error::ReferenceError;
use crate::ggx::Ggx;
use crate::lobe::{Lobe, hints_from};
use crate::quadrature::GaussLegendre;

/// Beckmann's distribution of normals with Smith's masking, seen from one direction, F = 1.
#[derive(Clone, Debug, PartialEq)]
pub struct BeckmannLobe {
    alpha_x: f64,
    alpha_y: f64,
    wo: DVec3,
    rule: GaussLegendre,
}

impl BeckmannLobe {
    /// Widths along tangent and bitangent (√2 × the standard deviation of the slopes), both > 0, and the unit view
    /// direction.
    ///
    /// # Errors
    /// [`ReferenceError::NonFiniteInput`] and [`ReferenceError::InvalidAlpha`].
    pub fn new(alpha_x: f64, alpha_y: f64, wo: DVec3) -> Result<Self, ReferenceError> {
        for alpha in [alpha_x, alpha_y] {
            if alpha <= 0.0 {
                return Err(ReferenceError::InvalidAlpha { alpha });
            }
        }
        if !(alpha_x.is_finite() && alpha_y.is_finite() && wo.is_finite()) {
            return Err(ReferenceError::NonFiniteInput { what: "Beckmann lobe" });
        }
        Ok(Self { alpha_x, alpha_y, wo, rule: GaussLegendre::new(32) })
    }

    /// Slopes `(−x/z, −y/z)` are normally distributed with variances `α²/2`: `D(wh) = P(slopes) / cos⁴θh`, per steradian
    /// (Heitz 2014, eq. 49). `∫ D(wh) cos dwh = 1`.
    pub fn ndf(&self, wh: DVec3) -> f64 {
        if wh.z <= 0.0 {
            return 0.0;
        }
        let normal = |slope: f64, alpha: f64| (-(slope / alpha).powi(2)).exp() / (alpha * PI.sqrt());
        let density = normal(wh.x / wh.z, self.alpha_x) * normal(wh.y / wh.z, self.alpha_y);
        // Underflown together with cos⁴: the exponential has won.
        if density == 0.0 { 0.0 } else { density / wh.z.powi(4) }
    }

    /// Smith's `Λ(w) = ∫_μ^∞ (x/μ − 1) P(x) dx` over the slopes x towards w that hide it, `μ = cot θ` (Smith 1967; Walter et
    /// al. 2007, appendix A), by quadrature. With `t = x/α(φ)` the integrand is `(t/a − 1) exp(−t²)/√π` from `a = μ/α(φ)`.
    pub fn lambda(&self, w: DVec3) -> f64 {
        let width = (self.alpha_x * w.x).hypot(self.alpha_y * w.y);
        let a = w.z.abs() / width;
        // Along the normal nothing is hidden; e^(−36) is nothing.
        if a.is_nan() || a > 6.0 {
            return 0.0;
        }
        self.rule.integrate(a, a + 6.5, |t| (t / a - 1.0) * (-t * t).exp() / PI.sqrt())
    }

    /// Schlick's weight `(1 − wo·wh)^5`; `wo·wh = |wo + wi| / 2`.
    pub fn fresnel_weight(&self, wi: DVec3) -> f64 {
        (1.0 - 0.5 * (self.wo + wi).length()).clamp(0.0, 1.0).powi(5)
    }
}

impl Lobe for BeckmannLobe {
    fn density(&self, wi: DVec3) -> f64 {
        if self.wo.z <= 0.0 || wi.z <= 0.0 {
            return 0.0;
        }
        let Some(wh) = (self.wo + wi).try_normalize() else { return 0.0 };
        let g2 = 1.0 / (1.0 + self.lambda(self.wo) + self.lambda(wi));
        self.ndf(wh) * g2 / (4.0 * self.wo.z)
    }

    fn half_spaces(&self) -> Vec<DVec3> {
        vec![dvec3(0.0, 0.0, 1.0)]
    }

    fn hints(&self) -> Vec<DVec3> {
        // GGX of the same widths lies in the same place.
        Ggx::new(self.alpha_x, self.alpha_y)
            .map(|ggx| hints_from(|u| ggx.sample(self.wo, u).map(|(wi, _)| wi)))
            .unwrap_or_default()
    }
}
