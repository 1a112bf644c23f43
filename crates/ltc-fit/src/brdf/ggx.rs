//! GGX.

use glam::DVec3;
use ltc_core::{Alpha, Ggx, Real, Vector, schlick_weight};
use serde_json::{Value, json};

use crate::{Brdf, DiskPoints, DiskRule, Lobe, albedo::ggx_albedo};

/// GGX with height-correlated masking and shadowing, F = 1.
#[derive(Clone, Copy, Debug, Default)]
pub struct GgxFamily;

impl Brdf for GgxFamily {
    fn name(&self) -> &'static str {
        "ggx"
    }

    fn eval_cos(&self, wo: DVec3, wi: DVec3, alpha: Alpha) -> f64 {
        Ggx::<f64>::new(alpha).eval_cos(wo, wi)
    }

    fn parameters(&self) -> Value {
        json!({ "masking_shadowing": "Smith, height-correlated", "fresnel": 1 })
    }

    fn sample(&self, wo: DVec3, alpha: Alpha, u: [f64; 2]) -> DVec3 {
        Ggx::<f64>::new(alpha).sample(wo, u)
    }

    fn pdf(&self, wo: DVec3, wi: DVec3, alpha: Alpha) -> f64 {
        Ggx::<f64>::new(alpha).pdf(wo, wi)
    }

    /// Visible normals (Heitz 2018), as [`ltc_core::Ggx::sample`] has it, with what the samples of one lobe share taken
    /// out of the loop. For a normal stretched to length `l`, `D = l⁴ / (π αx αy)`.
    fn sample_lobe(&self, wo: DVec3, alpha: Alpha, points: &DiskPoints, lobe: &mut Lobe) {
        lobe.clear();
        let n = points.len();
        let stretch = DVec3::new(alpha.x(), alpha.y(), 1.0);
        let v = (wo * stretch).try_unit().unwrap_or(DVec3::Z);
        let t1 = DVec3::Z.cross(v).try_unit().unwrap_or(DVec3::X);
        let t2 = v.cross(t1);
        let (a1, a2, a3) = (t1 * stretch, t2 * stretch, v * stretch);
        let s = 0.5 * (1.0 + v.z);
        let masked = wo.z + lambda_cos(wo, alpha);
        // 1/pdf = 4 (zo + Λ zo) / D
        let inverse_scale = 4.0 * masked * f64::PI * alpha.x() * alpha.y() / n as f64;
        for i in 0..n {
            let p1 = points.x[i];
            let p2 = (1.0 - s) * points.half_chord[i] + s * points.y[i];
            let p3 = (1.0 - p1 * p1 - p2 * p2).max(0.0).sqrt();
            let h = a1 * p1 + a2 * p2 + a3 * p3;
            let squared = h.dot(h);
            if squared <= 0.0 {
                continue;
            }
            let cos = wo.dot(h) / squared.sqrt();
            let wi = h * (2.0 * wo.dot(h) / squared) - wo;
            if wi.z <= 0.0 {
                continue;
            }
            let weight = masked * wi.z / (masked * wi.z + wo.z * lambda_cos(wi, alpha));
            lobe.push(wi, weight, inverse_scale / (squared * squared));
            lobe.fresnel += weight * schlick_weight(cos);
        }
        lobe.finish(n);
    }

    fn albedo(&self, wo: DVec3, alpha: Alpha, rule: &DiskRule, _: &mut Lobe) -> (f64, f64) {
        ggx_albedo(wo, alpha, rule)
    }
}

/// `Λ(ω) cos θ`, see [`ltc_core::Ggx`].
pub(crate) fn lambda_cos(w: DVec3, alpha: Alpha) -> f64 {
    let s2 = (alpha.x() * w.x).squared() + (alpha.y() * w.y).squared();
    0.5 * s2 / (w.z + (w.z * w.z + s2).sqrt()).max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lobe::LANES;

    #[test]
    fn samples_and_densities_are_those_of_core() {
        let points = DiskPoints::new(256, [0.5, 0.5]);
        let mut lobe = Lobe::default();
        for (theta, phi, ax, ay) in [(0.0, 0.0, 0.5, 0.5), (1.2, 0.7, 0.4, 0.05), (1.5, 2.0, 0.001, 0.9)] {
            let wo = crate::direction(theta, phi);
            let alpha = Alpha::new(ax, ay).unwrap();
            let ggx = Ggx::<f64>::new(alpha);
            GgxFamily.sample_lobe(wo, alpha, &points, &mut lobe);
            let above = points.square.iter().map(|u| ggx.sample(wo, *u)).filter(|wi| wi.z > 0.0);
            for (i, wi) in above.enumerate() {
                assert!((wi - lobe.direction(i)).length() < 1e-6, "{wi} {}", lobe.direction(i));
                let inverse = 1.0 / (256.0 * ggx.pdf(wo, lobe.direction(i)));
                assert!((lobe.inverse[i] / inverse - 1.0).abs() < 1e-6);
                let weight = ggx.sample_weight(wo, lobe.direction(i));
                assert!((lobe.weight[i] * lobe.magnitude * 256.0 - weight).abs() < 1e-6);
            }
            assert!((lobe.weight.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            assert_eq!(lobe.len() % LANES, 0);
        }
    }
}
