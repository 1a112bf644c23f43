//! LTC shading on the CPU, in `f64`.

use glam::DVec3;
use ltc_core::{Horizon, Ltc, reflectance};
use ltc_table::{Lookup, Query};
use rayon::prelude::*;

use crate::emitter::Emitter;
use crate::gbuffer::SurfacePoint;
use crate::shader::{Local, Shade, matrix, threads};
use crate::{RenderError, RenderTables};

/// The CPU back end.
pub(crate) struct Cpu<'a> {
    pub tables: &'a RenderTables<'a>,
    pub lights: &'a [Emitter],
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
        for light in self.lights {
            let seen = local.light(light);
            let mut fraction = 0.0;
            for (weight, ltc) in &lobes {
                fraction += weight * seen.integrate(ltc, Horizon::BOTH)?;
            }
            let mut reflected = DVec3::from_array(specular) * fraction;
            if material.albedo != DVec3::ZERO {
                reflected += material.albedo * seen.integrate(&Ltc::<f64>::cosine(), Horizon::BOTH)?;
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
