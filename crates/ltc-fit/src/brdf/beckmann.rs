//! Beckmann.

use core::f64::consts::PI;

use glam::DVec3;
use ltc_core::{Alpha, Ggx, Vector};
use serde_json::{Value, json};

use crate::{Brdf, DiskPoints, GgxFamily, Lobe};

/// Microfacets with Beckmann's distribution of normals and height-correlated Smith masking and shadowing, F = 1.
///
/// `ρ cos θi = D(ωh) G2 / (4 cos θo)` with
/// `D = exp(−(x²/αx² + y²/αy²)/z²) / (π αx αy z⁴)` (Beckmann & Spizzichino 1963; Heitz 2014, eq. 68 and 85),
/// `G2 = 1 / (1 + Λ(ωo) + Λ(ωi))` (Heitz 2014, eq. 99), and
/// `Λ = (erf(a) − 1)/2 + exp(−a²)/(2a√π)`, `a = z/√(αx²x² + αy²y²)` (eq. 65), exact to 1e-7 of `1 + Λ` (the error function is
/// approximated). α is √2 times the standard deviation of the slopes, on the same axis as the GGX width.
///
/// Samples are drawn from the visible normals of GGX of the same widths, whose tails are the wider ones: no sample weighs more
/// than `4√π/e = 2.61`, the largest ratio of the distributions times that of the masking.
#[derive(Clone, Copy, Debug, Default)]
pub struct Beckmann;

impl Brdf for Beckmann {
    fn name(&self) -> &'static str {
        "beckmann"
    }

    fn eval_cos(&self, wo: DVec3, wi: DVec3, alpha: Alpha) -> f64 {
        value(wo, wo.z + lambda_cos(wo, alpha), wi, alpha)
    }

    fn parameters(&self) -> Value {
        json!({
            "distribution": "Beckmann; alpha = sqrt(2) x standard deviation of the slopes",
            "masking_shadowing": "Smith, height-correlated",
            "magnitude": "directional albedo at F = 1",
            "fresnel": "Schlick's weight at the half vector",
        })
    }

    fn sample(&self, wo: DVec3, alpha: Alpha, u: [f64; 2]) -> DVec3 {
        Ggx::<f64>::new(alpha).sample(wo, u)
    }

    fn pdf(&self, wo: DVec3, wi: DVec3, alpha: Alpha) -> f64 {
        Ggx::<f64>::new(alpha).pdf(wo, wi)
    }

    /// The same samples, by way of the faster ones of GGX.
    fn sample_lobe(&self, wo: DVec3, alpha: Alpha, points: &DiskPoints, lobe: &mut Lobe) {
        GgxFamily.sample_lobe(wo, alpha, points, lobe);
        let masked = wo.z + lambda_cos(wo, alpha);
        lobe.reweigh(points.len(), |wi| value(wo, masked, wi, alpha), |wi| self.fresnel_weight(wo, wi));
    }
}

/// `D G2 / (4 zo)` with G2's denominator times zo zi, so that nothing divides by a cosine; `masked = zo + Λ(ωo) zo`.
fn value(wo: DVec3, masked: f64, wi: DVec3, alpha: Alpha) -> f64 {
    if !(wo.z >= 0.0 && wi.z > 0.0) {
        return 0.0;
    }
    let Some(wh) = (wo + wi).try_unit() else { return 0.0 };
    let denominator = masked * wi.z + wo.z * lambda_cos(wi, alpha);
    if denominator > 0.0 { normals(wh, alpha) * wi.z / (4.0 * denominator) } else { 0.0 }
}

/// `D(ωh)` in 1/sr; 0 at and below the horizon.
fn normals(wh: DVec3, alpha: Alpha) -> f64 {
    let z2 = wh.z * wh.z;
    let squared_slope = ((wh.x / alpha.x()).powi(2) + (wh.y / alpha.y()).powi(2)) / z2;
    // exp(−700) is 0 for all that follows, and z⁴ may be, too.
    if !(wh.z > 0.0 && squared_slope < 700.0) {
        return 0.0;
    }
    (-squared_slope).exp() / (PI * alpha.x() * alpha.y() * z2 * z2)
}

/// `Λ(ω) cos θ = s·aΛ(a)` with `s = √(αx²x² + αy²y²)`, `a = z/s`: finite at the horizon, where it is `s/(2√π)`.
///
/// `aΛ(a) = ½ exp(−a²) (1/√π − a·erfcx(a))`, with Hastings's approximation of `erfcx(a) = exp(a²) erfc(a)`
/// (Abramowitz & Stegun 1964, 7.1.26: erf within 1.5e-7).
fn lambda_cos(w: DVec3, alpha: Alpha) -> f64 {
    const FRAC_1_SQRT_PI: f64 = 0.564_189_583_547_756_3;
    let s = ((alpha.x() * w.x).powi(2) + (alpha.y() * w.y).powi(2)).sqrt();
    let a = w.z / s;
    // Along the normal, s = 0 and a = ∞. Λ(6) is below 1e-18.
    if a.is_nan() || a > 6.0 {
        return 0.0;
    }
    let t = 1.0 / (1.0 + 0.327_591_1 * a);
    let polynomial = 1.421_413_741 + t * (-1.453_152_027 + t * 1.061_405_429);
    let erfcx = t * (0.254_829_592 + t * (-0.284_496_736 + t * polynomial));
    (0.5 * s * (-a * a).exp() * (FRAC_1_SQRT_PI - a * erfcx)).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::direction;
    use ltc_reference::BeckmannLobe;

    #[test]
    fn masking_is_smiths_integral() {
        let (mut largest, mut control) = (0.0_f64, 0.0_f64);
        for (ax, ay) in [(1.0, 1.0), (0.5, 0.1), (0.02, 0.3), (1e-3, 1e-3)] {
            let alpha = Alpha::new(ax, ay).unwrap();
            let reference = BeckmannLobe::new(ax, ay, DVec3::Z).unwrap();
            for i in 0..400 {
                let w = direction(f64::from(i) * 1.5706 / 399.0, f64::from(i));
                let difference = |w: DVec3| (lambda_cos(w, alpha) / w.z - reference.lambda(w)).abs();
                largest = largest.max(difference(w) / (1.0 + reference.lambda(w)));
                control = control
                    .max((ggx_lambda(w, alpha) - reference.lambda(w)).abs() / (1.0 + reference.lambda(w)));
            }
        }
        println!("1 + Λ within {largest:.1e}");
        assert!(largest < 1e-7, "{largest:e}");
        assert!(control > 0.1, "another distribution's masking would pass: {control}");
    }

    fn ggx_lambda(w: DVec3, alpha: Alpha) -> f64 {
        Ggx::<f64>::new(alpha).lambda(w)
    }

    #[test]
    fn the_fast_samples_are_those_of_the_density() {
        let points = DiskPoints::new(256, [0.5, 0.5]);
        let mut lobe = Lobe::default();
        for (theta, phi, ax, ay) in [(0.0, 0.0, 0.5, 0.5), (1.2, 0.7, 0.4, 0.05), (1.5, 2.0, 0.01, 0.9)] {
            let (wo, alpha) = (direction(theta, phi), Alpha::new(ax, ay).unwrap());
            Beckmann.sample_lobe(wo, alpha, &points, &mut lobe);
            let above = points.square.iter().map(|u| Beckmann.sample(wo, alpha, *u)).filter(|wi| wi.z > 0.0);
            let (mut magnitude, mut fresnel) = (0.0, 0.0);
            for (i, wi) in above.enumerate() {
                assert!((wi - lobe.direction(i)).length() < 1e-6);
                let wi = lobe.direction(i);
                let weight = Beckmann.eval_cos(wo, wi, alpha) / Beckmann.pdf(wo, wi, alpha) / 256.0;
                assert!(
                    (lobe.weight[i] * lobe.magnitude - weight).abs() < 1e-8,
                    "{} {weight}",
                    lobe.weight[i]
                );
                assert!(weight * 256.0 < 2.61, "the proposal suits: {weight}");
                magnitude += weight;
                fresnel += weight * Beckmann.fresnel_weight(wo, wi);
            }
            assert!((lobe.magnitude - magnitude).abs() < 1e-9 && (lobe.fresnel - fresnel).abs() < 1e-9);
        }
    }
}
