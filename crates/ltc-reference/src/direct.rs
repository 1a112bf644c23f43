//! Direct light on GGX and Lambert, by multiple importance sampling.

use std::f64::consts::PI;

use glam::{DVec3, dvec3};

use crate::emitter::Emitter;
use crate::ggx::Ggx;
use crate::points::{R2, cosine_direction};
use crate::rect_light::LightHit;

/// What a light of unit radiance sends towards the eye, split so that any Fresnel and any albedo follow linearly.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Direct {
    /// `∫ D G2 / (4 cos θo) dw` over the light: the specular radiance at F = 1.
    pub magnitude: f64,
    /// The same with the weight `(1 - wo·wh)^5`.
    pub fresnel: f64,
    /// `∫ cos θ / π dw` over the light: the radiance of a white Lambert surface.
    pub diffuse: f64,
}

impl Direct {
    /// Specular radiance `F0 · n + (F90 - F0) · f` with Schlick's Fresnel.
    pub fn specular(&self, f0: f64, f90: f64) -> f64 {
        f0 * self.magnitude + (f90 - f0) * self.fresnel
    }

    /// [`Direct::specular`] for three colour channels.
    pub fn specular_rgb(&self, f0: DVec3, f90: DVec3) -> DVec3 {
        f0 * self.magnitude + (f90 - f0) * self.fresnel
    }

    /// Diffuse radiance of a Lambert surface, BRDF `albedo / π`.
    pub fn diffuse(&self, albedo: f64) -> f64 {
        albedo * self.diffuse
    }

    /// Adds the three integrals of one sample, `weight` = 1 / density.
    fn add(&mut self, ggx: &Ggx, wo: DVec3, wi: DVec3, weight: f64) {
        let specular = ggx.eval_cos(wo, wi) * weight;
        self.magnitude += specular;
        self.fresnel += specular * ggx.fresnel_weight(wo, wi);
        self.diffuse += wi.z.max(0.0) / PI * weight;
    }
}

/// Direct light at a surface point, unshadowed. See [`direct_light_visible`].
pub fn direct_light(wo: DVec3, ggx: &Ggx, light: &impl Emitter, samples: u32, seed: u64) -> Direct {
    direct_light_visible(wo, ggx, light, samples, seed, |_| true)
}

/// Direct light of `light` (unit radiance) at the origin of the shading frame, seen from the unit direction `wo`.
///
/// Unbiased: `samples` light directions from each of three techniques (the light's own, visible GGX normals,
/// cosine-weighted directions) share one estimator by the balance heuristic (Veach 1995), every sample
/// serving all three integrals. Points are the R2 sequence, shifted by `seed`, so that the error falls almost like
/// 1/n; equal seeds give equal results. The cost is `3 · samples` evaluations, and nothing is allocated.
///
/// `visible(hit)` says whether the light's point at `hit.distance · hit.wi` is in sight; it is only asked about
/// directions above the horizon that meet the light.
///
/// Zero for `wo` below the horizon, for no samples, and for a light that does not face the origin. A `wo` that is not
/// finite gives zero, too.
pub fn direct_light_visible(
    wo: DVec3,
    ggx: &Ggx,
    light: &impl Emitter,
    samples: u32,
    seed: u64,
    mut visible: impl FnMut(&LightHit) -> bool,
) -> Direct {
    let mut direct = Direct::default();
    estimate(wo, ggx, light, samples, seed, |hit, weight| {
        if visible(hit) {
            direct.add(ggx, wo, hit.wi, weight);
        }
    });
    direct
}

/// Direct light of a light whose `radiance(hit)` varies over it, one result a colour channel: as [`direct_light`] from the
/// same samples.
pub fn direct_light_coloured(
    wo: DVec3,
    ggx: &Ggx,
    light: &impl Emitter,
    samples: u32,
    seed: u64,
    radiance: impl Fn(&LightHit) -> DVec3,
) -> [Direct; 3] {
    let mut direct = [Direct::default(); 3];
    estimate(wo, ggx, light, samples, seed, |hit, weight| {
        for (channel, radiance) in direct.iter_mut().zip(radiance(hit).to_array()) {
            channel.add(ggx, wo, hit.wi, weight * radiance);
        }
    });
    direct
}

/// Gives every sample that meets the light to `add`, with its weight.
fn estimate(
    wo: DVec3,
    ggx: &Ggx,
    light: &impl Emitter,
    samples: u32,
    seed: u64,
    mut add: impl FnMut(&LightHit, f64),
) {
    if !wo.is_finite() || wo.z < 0.0 || !light.faces_origin() {
        return;
    }
    let streams = [0, 1, 2].map(|technique: u64| R2::shifted(seed.wrapping_mul(3).wrapping_add(technique)));
    for i in 0..u64::from(samples) {
        let [on_light, normal, cosine] = streams.map(|stream| stream.point(i));
        let hits = [
            light.sample(on_light),
            ggx.sample(wo, normal).and_then(|(wi, _)| light.hit(wi)),
            light.hit(cosine_direction(cosine)),
        ];
        for hit in hits.into_iter().flatten() {
            if hit.wi.z > 0.0 {
                let density = hit.pdf + ggx.pdf(wo, hit.wi) + hit.wi.z / PI;
                add(&hit, 1.0 / (density * f64::from(samples)));
            }
        }
    }
}

/// The unit view direction at `theta` from the normal and `phi` from the tangent, radians.
pub fn view_direction(theta: f64, phi: f64) -> DVec3 {
    let (sin_theta, cos_theta) = theta.sin_cos();
    dvec3(sin_theta * phi.cos(), sin_theta * phi.sin(), cos_theta)
}
