//! The anisotropic GGX microfacet BRDF with height-correlated masking and shadowing.

use crate::{Alpha, Real, Vector, fresnel::schlick_weight};

/// GGX of given widths, in the shading frame (normal +z, tangent +x carries `alpha_x`), with F = 1.
///
/// All directions are unit vectors. Formulas: Heitz 2014 (NDF, Λ, G2), Heitz 2018 (sampling), as collected in
/// KT et al. 2022, §3.1, eq. 4–6, rearranged so that nothing divides by a cosine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ggx<R> {
    alpha_x: R,
    alpha_y: R,
}

impl<R: Real> Ggx<R> {
    /// GGX of these widths.
    pub fn new(alpha: Alpha) -> Self {
        Self { alpha_x: R::of(alpha.x()), alpha_y: R::of(alpha.y()) }
    }

    /// Distribution of normals `D(ωh) = 1 / (π αx αy (x²/αx² + y²/αy² + z²)²)` in 1/sr (eq. 4); 0 below the horizon.
    pub fn d(&self, wh: R::Vec3) -> R {
        if wh.z() <= R::ZERO {
            return R::ZERO;
        }
        let stretched =
            (wh.x() / self.alpha_x).squared() + (wh.y() / self.alpha_y).squared() + wh.z().squared();
        R::ONE / (R::PI * self.alpha_x * self.alpha_y * stretched.squared())
    }

    /// Smith's `Λ(ω) = ½(−1 + √(1 + (αx²x² + αy²y²)/z²))` (eq. 5): 0 along the normal, +∞ at the horizon.
    pub fn lambda(&self, w: R::Vec3) -> R {
        if w.z() == R::ZERO {
            return R::ONE / R::ZERO;
        }
        self.lambda_cos(w) / w.z().abs()
    }

    /// `Λ(ω)·|cos θ|`, finite everywhere: `½ s² / (|z| + √(z² + s²))` with `s² = αx²x² + αy²y²`.
    fn lambda_cos(&self, w: R::Vec3) -> R {
        let s2 = (self.alpha_x * w.x()).squared() + (self.alpha_y * w.y()).squared();
        let z = w.z().abs();
        let denominator = z + (z.squared() + s2).sqrt();
        if denominator > R::ZERO { R::of(0.5) * s2 / denominator } else { R::ZERO }
    }

    /// Height-correlated masking and shadowing `G2 = 1 / (1 + Λ(ωo) + Λ(ωi))` (eq. 5).
    pub fn g2(&self, wo: R::Vec3, wi: R::Vec3) -> R {
        if wo.z() <= R::ZERO || wi.z() <= R::ZERO {
            return R::ZERO;
        }
        R::ONE / (R::ONE + self.lambda(wo) + self.lambda(wi))
    }

    /// The cosine-weighted BRDF `ρ cos θi = D G2 / (4 cos θo)` in 1/sr with F = 1 (eq. 6); 0 unless both directions
    /// are above the horizon. Finite for grazing `wo`.
    pub fn eval_cos(&self, wo: R::Vec3, wi: R::Vec3) -> R {
        let Some(wh) = half_vector::<R>(wo, wi) else { return R::ZERO };
        let (zo, zi) = (wo.z(), wi.z());
        let denominator = zo * zi + zo * self.lambda_cos(wi) + zi * self.lambda_cos(wo);
        if denominator <= R::ZERO {
            return R::ZERO;
        }
        self.d(wh) * zi / (R::of(4.0) * denominator)
    }

    /// The density, per solid angle of `wi`, of [`Ggx::sample`]: `D / (4 cos θo (1 + Λ(ωo)))`.
    pub fn pdf(&self, wo: R::Vec3, wi: R::Vec3) -> R {
        let Some(wh) = half_vector::<R>(wo, wi) else { return R::ZERO };
        let denominator = wo.z() + self.lambda_cos(wo);
        if denominator <= R::ZERO {
            return R::ZERO;
        }
        self.d(wh) / (R::of(4.0) * denominator)
    }

    /// `ρ cos / pdf = (1 + Λ(ωo)) / (1 + Λ(ωo) + Λ(ωi))`, in [0, 1]: the weight of a sample of [`Ggx::sample`].
    pub fn sample_weight(&self, wo: R::Vec3, wi: R::Vec3) -> R {
        if wo.z() <= R::ZERO || wi.z() <= R::ZERO {
            return R::ZERO;
        }
        let masked = wo.z() + self.lambda_cos(wo);
        masked * wi.z() / (masked * wi.z() + wo.z() * self.lambda_cos(wi))
    }

    /// Samples the visible normals as seen from `wo` (Heitz 2018, listing in §4) with `u` ∈ [0, 1)².
    pub fn sample_visible_normal(&self, wo: R::Vec3, u: [R; 2]) -> R::Vec3 {
        let up = R::Vec3::new(R::ZERO, R::ZERO, R::ONE);
        let v = R::Vec3::new(self.alpha_x * wo.x(), self.alpha_y * wo.y(), wo.z()).try_unit().unwrap_or(up);
        let t1 = up.cross(v).try_unit().unwrap_or(R::Vec3::new(R::ONE, R::ZERO, R::ZERO));
        let t2 = v.cross(t1);
        let r = u[0].sqrt();
        let (sin, cos) = (R::of(2.0) * R::PI * u[1]).sin_cos();
        let p1 = r * cos;
        let s = R::of(0.5) * (R::ONE + v.z());
        let p2 = (R::ONE - s) * (R::ONE - p1 * p1).max(R::ZERO).sqrt() + s * (r * sin);
        let p3 = (R::ONE - p1 * p1 - p2 * p2).max(R::ZERO).sqrt();
        let n = t1 * p1 + t2 * p2 + v * p3;
        R::Vec3::new(self.alpha_x * n.x(), self.alpha_y * n.y(), n.z().max(R::ZERO)).try_unit().unwrap_or(up)
    }

    /// A light direction of density [`Ggx::pdf`]; it may lie below the horizon, where the BRDF is 0.
    pub fn sample(&self, wo: R::Vec3, u: [R; 2]) -> R::Vec3 {
        let wh = self.sample_visible_normal(wo, u);
        let wi = wh * (R::of(2.0) * wo.dot(wh)) - wo;
        wi.try_unit().unwrap_or(wh)
    }

    /// Schlick's weight `(1 − ωo·ωh)^5` of this pair of directions; 0 for opposite ones.
    pub fn fresnel_weight(&self, wo: R::Vec3, wi: R::Vec3) -> R {
        half_vector::<R>(wo, wi).map_or(R::ZERO, |wh| schlick_weight(wo.dot(wh)))
    }
}

/// The half vector of two directions that are both above the horizon.
fn half_vector<R: Real>(wo: R::Vec3, wi: R::Vec3) -> Option<R::Vec3> {
    if wo.z() < R::ZERO || wi.z() <= R::ZERO {
        return None;
    }
    (wo + wi).try_unit()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{direction, r2};
    use core::f64::consts::PI;
    use glam::DVec3;

    const CASES: [(f64, f64, f64, f64); 6] = [
        (0.5, 0.5, 0.0, 0.0),
        (0.8, 0.2, 0.6, 1.1),
        (0.15, 0.9, 1.3, 4.0),
        (1.0, 1.0, 1.5, 2.0),
        (0.3, 0.3, 1.55, 0.2),
        (1.0, 0.1, 1.2, 1.5),
    ];

    /// ∫ f dω over the upper hemisphere by the midpoint rule in cos θ and φ.
    fn integrate_hemisphere(mut f: impl FnMut(DVec3) -> f64) -> f64 {
        let (rows, columns) = (1500, 1500);
        let mut sum = 0.0;
        for i in 0..rows {
            // u = (1 − cos)^(1/2) spaces the rows towards the pole, where the lobes are.
            let u = (f64::from(i) + 0.5) / f64::from(rows);
            let theta = (1.0 - u * u).acos();
            for j in 0..columns {
                let phi = 2.0 * PI * (f64::from(j) + 0.5) / f64::from(columns);
                sum += f(direction(theta, phi)) * 2.0 * u;
            }
        }
        sum * 2.0 * PI / f64::from(rows) / f64::from(columns)
    }

    #[test]
    fn normals_project_to_one() {
        for (ax, ay, ..) in CASES {
            let ggx = Ggx::<f64>::new(Alpha::new(ax, ay).unwrap());
            let area = integrate_hemisphere(|wh| ggx.d(wh) * wh.z);
            assert!((area - 1.0).abs() < 2e-4, "{ax} {ay}: {area}");
            let wrong = integrate_hemisphere(|wh| ggx.d(wh));
            assert!((wrong - 1.0).abs() > 1e-2, "the check misses a forgotten cosine: {wrong}");
        }
    }

    #[test]
    fn samples_average_to_the_integral() {
        for (ax, ay, theta, phi) in CASES {
            let ggx = Ggx::<f64>::new(Alpha::new(ax, ay).unwrap());
            let wo = direction(theta, phi);
            let quadrature = integrate_hemisphere(|wi| ggx.eval_cos(wo, wi));
            let n = 1 << 16;
            let sampled: f64 =
                (0..n).map(|i| ggx.sample_weight(wo, ggx.sample(wo, r2(i)))).sum::<f64>() / n as f64;
            assert!((sampled - quadrature).abs() < 1e-3, "{ax} {ay} {theta}: {sampled} {quadrature}");
            assert!(quadrature < 1.0 + 1e-3);
        }
    }

    #[test]
    fn weight_is_value_over_density_and_the_formula_is_the_papers() {
        for (ax, ay, theta, phi) in CASES {
            let ggx = Ggx::<f64>::new(Alpha::new(ax, ay).unwrap());
            let wo = direction(theta, phi);
            for i in 0..500 {
                let wi = ggx.sample(wo, r2(i));
                if wi.z < 1e-3 {
                    continue;
                }
                let wh = (wo + wi).try_unit().unwrap();
                let paper = ggx.d(wh) * ggx.g2(wo, wi) / (4.0 * wo.z);
                let value = ggx.eval_cos(wo, wi);
                assert!((value - paper).abs() <= 1e-9 * paper, "{value} {paper}");
                let weight = ggx.sample_weight(wo, wi);
                assert!((weight - value / ggx.pdf(wo, wi)).abs() < 1e-9 * (1.0 + weight));
            }
        }
    }

    #[test]
    fn nothing_is_nan_at_the_edges() {
        for alpha in [0.0, 1e-4, 1.0] {
            let ggx = Ggx::<f32>::new(Alpha::new(alpha, 1.0 - alpha).unwrap());
            for wo in [glam::Vec3::Z, glam::Vec3::X, glam::Vec3::NEG_Z, glam::Vec3::ZERO] {
                for u in [[0.0, 0.0], [1.0, 0.5], [0.999_999_9, 0.25], [0.5, 1.0]] {
                    let wi = ggx.sample(wo, u);
                    let values = [
                        ggx.eval_cos(wo, wi),
                        ggx.pdf(wo, wi),
                        ggx.sample_weight(wo, wi),
                        ggx.fresnel_weight(wo, wi),
                    ];
                    assert!(
                        wi.is_finite() && values.iter().all(|v| v.is_finite() && *v >= 0.0),
                        "{wo} {u:?} {values:?}"
                    );
                }
            }
        }
    }
}
