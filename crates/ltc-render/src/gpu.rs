//! LTC shading on the GPU.

use glam::{DVec3, Vec3};
use ltc_core::{PrefilteredTexture, TextureFrame};
use ltc_shade_gpu::{
    AreaLight, Gpu, GpuOptions, LightShape, LightTexture, LightTextures, Shader, TableTextures, Tables,
};

use crate::emitter::Emitter;
use crate::gbuffer::SurfacePoint;
use crate::render::prefiltered;
use crate::shader::Shade;
use crate::texture_map::TextureMap;
use crate::{RenderError, RenderTables};

/// The GPU back end: a device with the tables on it.
pub(crate) struct GpuBackend {
    gpu: Gpu,
    shader: Shader,
    isotropic: TableTextures,
    anisotropic: TableTextures,
    lights: Vec<AreaLight>,
}

impl GpuBackend {
    pub fn open(tables: &RenderTables<'_>, lights: &[Emitter]) -> Result<Self, RenderError> {
        let gpu = Gpu::new(GpuOptions::default())?;
        let textures: Vec<PrefilteredTexture> = prefiltered(lights)?.into_iter().flatten().collect();
        // What only textured lights need is compiled for them alone.
        let shader = match textures.as_slice() {
            [] => Shader::new(&gpu)?,
            some => Shader::with_textures(&gpu, LightTextures::upload(&gpu, some)?)?,
        };
        let mut numbers = 0..;
        Ok(Self {
            shader,
            isotropic: TableTextures::upload(&gpu, tables.isotropic)?,
            anisotropic: TableTextures::upload(&gpu, tables.anisotropic)?,
            lights: lights.iter().map(|emitter| light(emitter, &mut numbers)).collect(),
            gpu,
        })
    }
}

impl Shade for GpuBackend {
    fn device(&self) -> String {
        self.gpu.info().to_string()
    }

    fn batch(&self) -> usize {
        1 << 17
    }

    fn shade(&self, points: &[SurfacePoint]) -> Result<Vec<DVec3>, RenderError> {
        let tables = Tables { isotropic: Some(&self.isotropic), anisotropic: Some(&self.anisotropic) };
        let points: Vec<_> = points.iter().map(surface_point).collect();
        let radiance = self.shader.shade(&self.gpu, tables, &points, &self.lights)?;
        Ok(radiance.into_iter().map(|r| Vec3::from_array(r).as_dvec3()).collect())
    }
}

/// `numbers` are those of textures that are free.
fn light(emitter: &Emitter, numbers: &mut impl Iterator<Item = usize>) -> AreaLight {
    let shape = LightShape::from(&emitter.light);
    let texture = emitter.texture.as_ref().and_then(|map| Some(on_light(map, numbers.next()?, &shape)));
    AreaLight { radiance: emitter.radiance.as_vec3(), texture, shape }
}

/// Where a quad is filled, to the last bit: the shader has a shorter way for that.
fn on_light(map: &TextureMap, number: usize, shape: &LightShape) -> LightTexture {
    match shape {
        LightShape::Quad { corners, .. } if map.fills() => LightTexture::filling(number, corners),
        _ => {
            let [origin, axis_u, axis_v] = map.frame.map(DVec3::as_vec3);
            LightTexture { number, frame: TextureFrame { origin, axis_u, axis_v } }
        }
    }
}

fn surface_point(point: &SurfacePoint) -> ltc_shade_gpu::SurfacePoint {
    let material = &point.material;
    ltc_shade_gpu::SurfacePoint {
        position: point.position.as_vec3(),
        normal: point.normal.as_vec3(),
        tangent: point.tangent.as_vec3(),
        wo: point.wo.as_vec3(),
        alpha_x: material.alpha.x() as f32,
        alpha_y: material.alpha.y() as f32,
        isotropic: material.is_isotropic(),
        f0: material.f0.as_vec3(),
        f90: material.f90 as f32,
        albedo: material.albedo.as_vec3(),
    }
}
