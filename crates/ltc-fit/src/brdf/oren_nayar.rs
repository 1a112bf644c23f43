//! Oren–Nayar.

use core::f64::consts::FRAC_1_PI;

use glam::DVec3;
use ltc_core::Alpha;
use serde_json::{Value, json};

use crate::{Brdf, brdf::proposal};

/// The qualitative model of Oren & Nayar 1994 (eq. 30) for rough Lambertian surfaces, at facet albedo 1: the one that renderers
/// mean by the name.
///
/// `ρ = 1/π (A + B max(0, cos(φi − φo)) sin max(θi, θo) tan min(θi, θo))`, `A = 1 − ½ σ²/(σ² + 0.33)`,
/// `B = 0.45 σ²/(σ² + 0.09)`. The facets' tilt has standard deviation σ = α, in radians: up to 57°.
///
/// Light that bounces between facets is left out, so that rough surfaces are dark (magnitude 0.62 from above at
/// α = 1), and the simplification makes a little energy: up to 1.016 at grazing angles around α = 0.2. There is no Fresnel channel:
/// it is 0.
#[derive(Clone, Copy, Debug, Default)]
pub struct OrenNayar;

impl Brdf for OrenNayar {
    fn name(&self) -> &'static str {
        "oren-nayar"
    }

    fn eval_cos(&self, wo: DVec3, wi: DVec3, alpha: Alpha) -> f64 {
        if !(wo.z >= 0.0 && wi.z > 0.0) {
            return 0.0;
        }
        let variance = alpha.major().powi(2);
        let a = 1.0 - 0.5 * variance / (variance + 0.33);
        let b = 0.45 * variance / (variance + 0.09);
        // sin θi sin θo cos(φi − φo); over the larger cosine it is cos · sin · tan of the formula.
        let across = wo.x * wi.x + wo.y * wi.y;
        FRAC_1_PI * wi.z * (a + b * across.max(0.0) / wi.z.max(wo.z))
    }

    fn fresnel_weight(&self, _: DVec3, _: DVec3) -> f64 {
        0.0
    }

    fn max_magnitude(&self) -> f64 {
        1.02
    }

    fn parameters(&self) -> Value {
        json!({
            "variant": "qualitative model (Oren & Nayar 1994, eq. 30)",
            "sigma": "alpha, in radians",
            "magnitude": "directional albedo at facet albedo 1; up to 1.016 at grazing angles",
            "fresnel": "0: reflectance is albedo x magnitude",
        })
    }

    fn sample(&self, _: DVec3, _: Alpha, u: [f64; 2]) -> DVec3 {
        proposal::broad(u)
    }

    fn pdf(&self, _: DVec3, wi: DVec3, _: Alpha) -> f64 {
        proposal::broad_pdf(wi)
    }
}
