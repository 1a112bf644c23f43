//! LTC shading on the CPU, in `f64`.

use glam::DVec3;
use ltc_core::{
    AnyLight, Horizon, InputError, Ltc, PrefilteredTexture, TextureFrame, TexturedPolygon, reflectance,
};
use ltc_table::{Lookup, Query};
use rayon::prelude::*;

use crate::emitter::Emitter;
use crate::gbuffer::SurfacePoint;
use crate::shader::{Local, Shade, matrix, threads};
use crate::texture_map::{TextureMap, texture_frame};
use crate::{RenderError, RenderTables};

/// The CPU back end.
pub(crate) struct Cpu<'a> {
    pub tables: &'a RenderTables<'a>,
    pub lights: &'a [Emitter],
    /// One for each light.
    pub textures: Vec<Option<PrefilteredTexture>>,
}

impl Shade for Cpu<'_> {
    fn device(&self) -> String {
        threads()
    }

    fn batch(&self) -> usize {
        1 << 15
    }

    fn shade(&self, points: &[SurfacePoint]) -> Result<Vec<DVec3>, RenderError> {
        points.par_iter().map(|point| self.point(point)).collect()
    }
}

impl Cpu<'_> {
    fn point(&self, point: &SurfacePoint) -> Result<DVec3, RenderError> {
        let local = Local::of(point)?;
        let found = self.lookup(point, local.wo)?;
        let material = &point.material;
        let specular = material
            .f0
            .to_array()
            .map(|f0| reflectance(f0, material.f90, found.magnitude, found.fresnel).max(0.0));
        // As on the GPU, a singular interpolated matrix is no lobe and reflects nothing.
        let lobes: Vec<_> = found
            .lobes
            .iter()
            .filter_map(|lobe| Some((lobe.weight, Ltc::<f64>::new(matrix(&lobe.m)).ok()?)))
            .collect();
        let mut sum = DVec3::ZERO;
        for (light, texture) in self.lights.iter().zip(&self.textures) {
            let seen = Seen::of(&local, light, texture.as_ref());
            let mut colour = DVec3::ZERO;
            for (weight, ltc) in &lobes {
                colour += *weight * seen.by(ltc)?;
            }
            let mut reflected = DVec3::from_array(specular) * colour;
            if material.albedo != DVec3::ZERO {
                reflected += material.albedo * seen.by(&Ltc::<f64>::cosine())?;
            }
            sum += light.radiance * reflected;
        }
        Ok(sum)
    }

    fn lookup(&self, point: &SurfacePoint, wo: DVec3) -> Result<Lookup, RenderError> {
        let alpha = point.material.alpha;
        let table =
            if point.material.is_isotropic() { self.tables.isotropic } else { self.tables.anisotropic };
        let query = Query {
            theta: wo.truncate().length().atan2(wo.z),
            phi: wo.y.atan2(wo.x),
            alpha_x: alpha.x(),
            alpha_y: alpha.y(),
        };
        Ok(table.lookup(&query)?)
    }
}

/// A light as a shading point sees it.
struct Seen<'a> {
    light: AnyLight,
    texture: Option<(TextureFrame<f64>, &'a PrefilteredTexture)>,
}

impl<'a> Seen<'a> {
    fn of(local: &Local, emitter: &Emitter, texture: Option<&'a PrefilteredTexture>) -> Self {
        let frame = |map: &TextureMap| texture_frame(map.moved(|p| local.point(p), |v| local.direction(v)));
        let frame = emitter.texture.as_ref().map(frame);
        Self { light: local.light(emitter), texture: frame.zip(texture) }
    }

    /// What the lobe sees of it: the fraction that sees it, times the colour.
    fn by(&self, ltc: &Ltc<f64>) -> Result<DVec3, InputError> {
        if let (Some((frame, texture)), AnyLight::Polygon { vertices, sides }) = (&self.texture, &self.light)
        {
            let vertices: Vec<DVec3> = vertices.iter().map(|v| DVec3::from_array(*v)).collect();
            let light = TexturedPolygon::<f64>::new(&vertices, *sides, *frame, texture)?;
            return Ok(DVec3::from_array(light.integrate_colour(ltc, Horizon::BOTH)));
        }
        Ok(DVec3::splat(self.light.integrate(ltc, Horizon::BOTH)?))
    }
}
