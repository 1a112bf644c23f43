//! Ground truth: GGX and Lambert themselves, by multiple importance sampling.

use glam::DVec3;
use ltc_reference::Ggx;
use rayon::prelude::*;

use crate::RenderError;
use crate::emitter::Emitter;
use crate::gbuffer::SurfacePoint;
use crate::shader::{Local, Shade, threads};

/// The reference back end. It uses no table and none of the closed forms.
pub(crate) struct Reference<'a> {
    pub lights: &'a [Emitter],
    /// For each of three techniques, point and light.
    pub samples: u32,
    pub seed: u64,
}

impl Shade for Reference<'_> {
    fn device(&self) -> String {
        format!("{}, 3 × {} samples a light", threads(), self.samples)
    }

    fn batch(&self) -> usize {
        1 << 13
    }

    fn shade(&self, points: &[SurfacePoint]) -> Result<Vec<DVec3>, RenderError> {
        points.par_iter().map(|point| self.point(point)).collect()
    }
}

impl Reference<'_> {
    fn point(&self, point: &SurfacePoint) -> Result<DVec3, RenderError> {
        let local = Local::of(point)?;
        let material = &point.material;
        let ggx = Ggx::new(material.alpha.x(), material.alpha.y())?;
        let mut sum = DVec3::ZERO;
        for (i, light) in (0_u64..).zip(self.lights) {
            // Distinct for each sample and light, whatever the seed; the integrator scrambles it.
            let seed = self.seed ^ (point.sample * self.lights.len() as u64 + i);
            let direct = light.direct(
                |p| local.point(p),
                |v| local.direction(v),
                local.wo,
                &ggx,
                self.samples,
                seed,
            )?;
            let reflected = [0, 1, 2].map(|channel| {
                let seen = direct[channel];
                seen.specular(material.f0[channel], material.f90) + seen.diffuse(material.albedo[channel])
            });
            sum += light.radiance * DVec3::from_array(reflected);
        }
        Ok(sum)
    }
}
