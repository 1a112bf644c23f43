//! Disney's diffuse.

use core::f64::consts::FRAC_1_PI;

use glam::DVec3;
use ltc_core::{Alpha, schlick_weight};
use serde_json::{Value, json};

use crate::{Brdf, brdf::proposal};

/// The diffuse term of Disney's principled BRDF (Burley 2012, §5.3), without renormalisation, at base colour 1.
///
/// `ρ = 1/π (1 + (FD90 − 1)(1 − cos θi)^5) (1 + (FD90 − 1)(1 − cos θo)^5)`, `FD90 = ½ + 2 r cos²θd`, with
/// `θd` the angle between `ωi` and the half vector: `2 cos²θd = 1 + ωo·ωi`. Its roughness r is perceptual: r = √α
/// ([`Alpha::perceptual`]), so that one α serves this lobe and the specular one above it.
///
/// The model makes energy: at r = 1 its magnitude rises from 1.036 seen from above to 1.558 at θ = 90°. The table holds what it
/// is. There is no Fresnel channel: it is 0.
#[derive(Clone, Copy, Debug, Default)]
pub struct DisneyDiffuse;

impl Brdf for DisneyDiffuse {
    fn name(&self) -> &'static str {
        "disney-diffuse"
    }

    fn eval_cos(&self, wo: DVec3, wi: DVec3, alpha: Alpha) -> f64 {
        if !(wo.z >= 0.0 && wi.z > 0.0) {
            return 0.0;
        }
        let rise = alpha.perceptual().get() * (1.0 + wo.dot(wi)) - 0.5;
        let towards = |cos: f64| (1.0 + rise * schlick_weight(cos)).max(0.0);
        FRAC_1_PI * wi.z * towards(wi.z) * towards(wo.z)
    }

    fn fresnel_weight(&self, _: DVec3, _: DVec3) -> f64 {
        0.0
    }

    fn max_magnitude(&self) -> f64 {
        1.56
    }

    fn parameters(&self) -> Value {
        json!({
            "variant": "Burley 2012, not renormalised",
            "roughness": "sqrt(alpha)",
            "magnitude": "directional albedo at base colour 1; above 1 for rough surfaces at grazing angles",
            "fresnel": "0: reflectance is base colour x magnitude",
        })
    }

    fn sample(&self, _: DVec3, _: Alpha, u: [f64; 2]) -> DVec3 {
        proposal::broad(u)
    }

    fn pdf(&self, _: DVec3, wi: DVec3, _: Alpha) -> f64 {
        proposal::broad_pdf(wi)
    }
}
