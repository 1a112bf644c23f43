//! Charlie, the sheen of cloth.

use core::f64::consts::TAU;

use glam::DVec3;
use ltc_core::{Alpha, Vector};
use serde_json::{Value, json};

use crate::Brdf;

/// The sheen of Estevez & Kulla 2017 ("Production Friendly Microfacet Sheen BRDF"), as `KHR_materials_sheen` has it:
/// without the paper's softened terminator, which is not reciprocal. At sheen colour 1.
///
/// `ρ cos θi = D(ωh) / (4 cos θo (1 + Λ(ωo) + Λ(ωi)))`, `D = (2 + 1/r) sin^(1/r) θh / 2π`, and Λ the paper's fit: with
/// `L(x) = a/(1 + b x^c) + d x + e`, `Λ = exp L(cos θ)` for cos θ < ½, else `exp(2 L(½) − L(1 − cos θ))`; a to e go from
/// the values of r = 0 to those of r = 1 by `(1 − r)²`. The roughness r is α; glTF's sheen roughness is √α.
///
/// Smooth cloth is all but dark from above (magnitude 5e-18 at α = 0.01, and below the smallest number from α = 4e-4 down) and shines
/// at grazing angles, back to the eye and to both sides. There the fit of Λ, within 0.04 of Smith's G1 elsewhere, lets it
/// reflect more than it gets: 1.7 at θ = 89°, α = 0.01; up to 86° it stays below 0.79. There is no Fresnel channel: it
/// is 0.
#[derive(Clone, Copy, Debug, Default)]
pub struct CharlieSheen;

impl Brdf for CharlieSheen {
    fn name(&self) -> &'static str {
        "charlie-sheen"
    }

    fn eval_cos(&self, wo: DVec3, wi: DVec3, alpha: Alpha) -> f64 {
        if !(wo.z > 0.0 && wi.z > 0.0) {
            return 0.0;
        }
        let Some(wh) = (wo + wi).try_unit() else { return 0.0 };
        let r = alpha.major();
        let shadowing = Shadowing::new(r);
        let d = (2.0 + 1.0 / r) / TAU * (wh.x * wh.x + wh.y * wh.y).powf(0.5 / r);
        d / (4.0 * wo.z * (1.0 + shadowing.lambda(wo.z) + shadowing.lambda(wi.z)))
    }

    fn fresnel_weight(&self, _: DVec3, _: DVec3) -> f64 {
        0.0
    }

    /// The model has no bound: its Λ is finite at the horizon, where Smith's rises as 1/cos θ.
    fn max_magnitude(&self) -> f64 {
        f64::INFINITY
    }

    fn parameters(&self) -> Value {
        json!({
            "variant": "Estevez & Kulla 2017, fitted Lambda, no terminator softening",
            "roughness": "r = alpha; KHR_materials_sheen's sheenRoughness is sqrt(alpha)",
            "magnitude": "directional albedo at sheen colour 1; above 1 beyond 88 degrees for alpha below 0.05",
            "fresnel": "0: reflectance is sheen colour x magnitude",
        })
    }

    /// Half of the directions anywhere above the horizon, half in the band below `zi = w` where the lobe of a low roughness
    /// lies.
    fn sample(&self, wo: DVec3, alpha: Alpha, u: [f64; 2]) -> DVec3 {
        let [first, second] = u;
        let z = if first < 0.5 { band(wo, alpha) * 2.0 * first } else { 2.0 * first - 1.0 };
        let (sin, cos) = (TAU * second).sin_cos();
        let radius = ((1.0 - z) * (1.0 + z)).max(0.0).sqrt();
        DVec3::new(radius * cos, radius * sin, z)
    }

    fn pdf(&self, wo: DVec3, wi: DVec3, alpha: Alpha) -> f64 {
        let band = band(wo, alpha);
        if wi.z <= 0.0 { 0.0 } else { (0.5 + if wi.z < band { 0.5 / band } else { 0.0 }) / TAU }
    }
}

/// Height w of the band above the horizon that holds most of the lobe, in (0, 1]:
/// `sin^(1/r) θh ≈ exp(−(zo + zi)² / 4r(1 + ωo·ωi))` has fallen by e² or more at `(zo + w)² = zo² + 16 r`.
fn band(wo: DVec3, alpha: Alpha) -> f64 {
    let r = alpha.major();
    (16.0 * r / (wo.z + (wo.z * wo.z + 16.0 * r).sqrt())).min(1.0)
}

/// The fit of Λ for one roughness.
struct Shadowing {
    a: f64,
    b: f64,
    c: f64,
    d: f64,
    e: f64,
}

impl Shadowing {
    fn new(r: f64) -> Self {
        let smooth = (1.0 - r).powi(2);
        let between = |at_0: f64, at_1: f64| at_1 + smooth * (at_0 - at_1);
        Self {
            a: between(25.3245, 21.5473),
            b: between(3.32435, 3.82987),
            c: between(0.16801, 0.19823),
            d: between(-1.27393, -1.97760),
            e: between(-4.85967, -4.32054),
        }
    }

    fn l(&self, x: f64) -> f64 {
        self.a / (1.0 + self.b * x.powf(self.c)) + self.d * x + self.e
    }

    fn lambda(&self, cos: f64) -> f64 {
        let exponent = if cos < 0.5 { self.l(cos) } else { 2.0 * self.l(0.5) - self.l((1.0 - cos).max(0.0)) };
        exponent.exp()
    }
}
