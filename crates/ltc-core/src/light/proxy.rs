//! A light's place taken by the sphere of the same vector form factor, so that nothing is clipped in cosine space.

use super::{EdgeForm, Polygon, Quad};
use crate::{Ltc, Real, Vector as _};

/// The form factor of a sphere cut by the horizon, `1/π ∫ max(0, cos θ) dω` over its directions; exact.
///
/// `form_factor` is `S = sin² σ` ∈ [0, 1], σ the sphere's angular radius; `cosine` is `c = cos ω`, ω the angle of its centre
/// to the normal. `S c` above the horizon (c ≥ √S), 0 below it (c ≤ −√S); between (Snyder 1996), with
/// `g = asin(cos σ / sin ω)`:
///
/// ```text
/// G = π/2 − g + sin g cos g − 2 sin ω cos σ cos g
/// H = c (cos g √(S − cos² g) + S asin(cos g / sin σ))
/// c ≥ 0: S c + (G − H)/π;   c < 0: (G + H)/π
/// ```
pub fn clipped_sphere<R: Real>(form_factor: R, cosine: R) -> R {
    let (s, c) = (form_factor.clamped(R::ZERO, R::ONE), cosine.clamped(-R::ONE, R::ONE));
    if c * c >= s {
        return c.max(R::ZERO) * s;
    }
    // sin² ω, not 0 here; sin g and cos g; √(S − cos² g) without its cancellation.
    let squared = R::ONE - c * c;
    let (sine, cos_sigma) = (squared.sqrt(), (R::ONE - s).sqrt());
    let (sin_g, cos_g) = ((cos_sigma / sine).min(R::ONE), ((s - c * c) / squared).sqrt());
    let lift = cos_sigma * c.abs() / sine;
    let g = cos_g.atan2(sin_g) + sin_g * cos_g - R::of(2.0) * sine * cos_sigma * cos_g;
    let h = c * (cos_g * lift + s * cos_g.atan2(lift));
    let between = if c >= R::ZERO { R::PI * c * s + g - h } else { g + h };
    (between / R::PI).clamped(R::ZERO, R::ONE)
}

/// [`clipped_sphere`] without transcendental functions: at most 1.9e-3 off, 9e-4 RMS over the domain where the horizon
/// cuts, exact where it does not. What a shader would otherwise fetch from a table.
///
/// Of `x = c/√S` the odd part is x/2; the even one is fitted by least squares towards minimax as
/// `½ − (1 − x²) cos σ Q(cos σ, x²)`, Q of degree 2 in both.
pub fn clipped_sphere_fit<R: Real>(form_factor: R, cosine: R) -> R {
    let (s, c) = (form_factor.clamped(R::ZERO, R::ONE), cosine.clamped(-R::ONE, R::ONE));
    if c * c >= s {
        return c.max(R::ZERO) * s;
    }
    let (k, y) = ((R::ONE - s).sqrt(), c * c / s);
    let quadratic = |a: f64, b: f64, d: f64| (R::of(d) * y + R::of(b)) * y + R::of(a);
    let q = quadratic(0.651444, -0.201736, 1.36968)
        + k * (quadratic(-0.715293, 1.33957, -4.83414) + k * quadratic(0.395187, -1.42406, 4.04594));
    let even = R::of(0.5) - (R::ONE - y) * k * q;
    (s * (R::of(0.5) * c + s.sqrt() * even)).clamped(R::ZERO, R::ONE)
}

impl<R: Real> Polygon<'_, R> {
    /// The fraction of `ltc` that a sphere sees that has the light's vector form factor in cosine space
    /// ([`Polygon::vector_form_factor`] by the edge term `F`): nothing is clipped there.
    ///
    /// Exact for lights above the horizon of cosine space, and near that for spheres; of [`EdgeForm`]'s domain those lights
    /// that the horizon cuts are at most 0.02 off, 1e-3 RMS (kept true by `tests/edge_forms.rs`). With `surface` the light is cut
    /// by the surface's horizon first, as for [`crate::Horizon::BOTH`]; published shaders do not.
    pub fn integrate_proxy<F: EdgeForm>(&self, ltc: &Ltc<R>, surface: bool) -> R {
        from_vector(self.vector_form_factor::<F>(ltc, surface))
    }
}

impl<R: Real> Quad<R> {
    /// As [`Polygon::integrate_proxy`].
    pub fn integrate_proxy<F: EdgeForm>(&self, ltc: &Ltc<R>, surface: bool) -> R {
        from_vector(self.vector_form_factor::<F>(ltc, surface))
    }
}

fn from_vector<R: Real>(vector: R::Vec3) -> R {
    let length = vector.length();
    if length <= R::TINY { R::ZERO } else { clipped_sphere_fit(length, vector.z() / length) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::r2;
    use glam::DVec3;

    /// By its definition: points of the sphere's cap, uniform in solid angle.
    fn sampled(s: f64, c: f64) -> f64 {
        let (cap, count) = (1.0 - (1.0 - s).sqrt(), 1 << 16);
        let sum: f64 = (0..count)
            .map(|i| {
                let [u, v] = r2(i);
                let z = 1.0 - cap * u;
                let r = (1.0 - z * z).sqrt();
                let w = DVec3::new(r * (core::f64::consts::TAU * v).cos(), 0.0, z);
                (c * w.z + (1.0 - c * c).sqrt() * w.x).max(0.0)
            })
            .sum();
        sum / f64::from(count as u32) * 2.0 * cap
    }

    #[test]
    fn the_clipped_sphere_is_its_integral() {
        for s in [1e-4, 0.05, 0.3, 0.8, 0.99] {
            for i in -10..=10 {
                let c = f64::from(i) * 0.1;
                let (exact, count) = (clipped_sphere(s, c), sampled(s, c));
                assert!((exact - count).abs() < 1e-3 * s, "{s} {c}: {exact} {count}");
            }
        }
    }

    #[test]
    fn the_fit_keeps_its_errors() {
        let (mut max, mut squares, mut count) = (0.0_f64, 0.0, 0.0);
        for i in 1..400 {
            let s = f64::from(i) / 400.0;
            for j in -200..=200 {
                let c = f64::from(j) / 200.0 * s.sqrt();
                let error: f64 = clipped_sphere_fit(s, c) - clipped_sphere(s, c);
                max = max.max(error.abs());
                squares += error * error;
                count += 1.0;
            }
        }
        let rms = (squares / count).sqrt();
        assert!((1.5e-3..1.9e-3).contains(&max) && rms < 9e-4, "{max} {rms}");
    }

    #[test]
    fn ends_of_the_domain_are_finite() {
        for s in [0.0_f32, f32::MIN_POSITIVE, 1e-20, 0.5, 1.0 - f32::EPSILON, 1.0, 2.0, f32::NAN] {
            for c in [-1.0_f32, -1e-30, 0.0, 1e-30, 0.5, 1.0, f32::NAN] {
                for value in [clipped_sphere(s, c), clipped_sphere_fit(s, c)] {
                    assert!((0.0..=1.0).contains(&value), "{s} {c}: {value}");
                }
            }
        }
    }
}
