//! LTC shading on the GPU.

use std::sync::{Arc, Mutex, PoisonError};

use glam::{DVec3, Vec3};
use ltc_core::{Alpha, PrefilteredTexture, TextureFrame};
use ltc_shade_gpu::{
    AreaLight, BakedSlices, Gpu, GpuOptions, LightShape, LightTexture, LightTextures, Shader, ShadingOptions,
    TableTextures, Tables,
};
use ltc_table::Table;

use crate::emitter::Emitter;
use crate::gbuffer::SurfacePoint;
use crate::material::ResolvedMaterial;
use crate::render::prefiltered;
use crate::shader::Shade;
use crate::texture_map::TextureMap;
use crate::{RenderError, RenderTables};

/// What scenes share: a device with the tables on it, and the programs that were compiled for it.
pub(crate) struct Device {
    gpu: Gpu,
    isotropic: TableTextures,
    anisotropic: TableTextures,
    /// Without textures, by whether slices are baked.
    shaders: Mutex<[Option<Arc<Shader>>; 2]>,
}

impl Device {
    pub fn open(tables: &RenderTables<'_>) -> Result<Self, RenderError> {
        let gpu = Gpu::new(GpuOptions::default())?;
        let isotropic = TableTextures::upload(&gpu, tables.isotropic)?;
        let anisotropic = TableTextures::upload(&gpu, tables.anisotropic)?;
        Ok(Self { gpu, isotropic, anisotropic, shaders: Mutex::default() })
    }

    pub fn is_software(&self) -> bool {
        self.gpu.info().software
    }

    fn shader(&self, textures: &[PrefilteredTexture], baked: bool) -> Result<Arc<Shader>, RenderError> {
        // What only textured lights or baked slices need is compiled for them alone.
        if !textures.is_empty() {
            let textures = Some(LightTextures::upload(&self.gpu, textures)?);
            return Ok(Arc::new(Shader::with(&self.gpu, ShadingOptions { textures, baked })?));
        }
        // Whoever panicked with it left it whole: a shader is put in when it is complete.
        let mut shaders = self.shaders.lock().unwrap_or_else(PoisonError::into_inner);
        let place = &mut shaders[usize::from(baked)];
        if let Some(shader) = place {
            return Ok(Arc::clone(shader));
        }
        let shader = Arc::new(Shader::with(&self.gpu, ShadingOptions { textures: None, baked })?);
        Ok(Arc::clone(place.insert(shader)))
    }
}

/// A scene on the device.
pub(crate) struct GpuBackend<'a> {
    device: &'a Device,
    shader: Arc<Shader>,
    baked: Option<Baked>,
    lights: Vec<AreaLight>,
}

/// Slices of the anisotropic table for the scene's materials, and the widths that they are for, in their order.
struct Baked {
    slices: BakedSlices,
    widths: Vec<Alpha>,
}

impl Baked {
    /// Nothing where no material is anisotropic, or more are than the device can hold slices.
    fn of(gpu: &Gpu, table: &Table, materials: &[ResolvedMaterial]) -> Result<Option<Self>, RenderError> {
        let mut widths: Vec<Alpha> = Vec::new();
        for material in materials.iter().filter(|m| !m.is_isotropic()) {
            if !widths.contains(&material.alpha) {
                widths.push(material.alpha);
            }
        }
        if widths.is_empty() || widths.len() > BakedSlices::most(gpu) {
            return Ok(None);
        }
        Ok(Some(Self { slices: BakedSlices::bake(gpu, table, &widths)?, widths }))
    }

    /// None for an isotropic material: it has a table of its own.
    fn slice(&self, alpha: Alpha) -> Option<u32> {
        self.widths.iter().position(|other| *other == alpha).map(|k| k as u32)
    }
}

impl<'a> GpuBackend<'a> {
    pub fn new(
        device: &'a Device,
        tables: &RenderTables<'_>,
        lights: &[Emitter],
        materials: &[ResolvedMaterial],
    ) -> Result<Self, RenderError> {
        let textures: Vec<PrefilteredTexture> = prefiltered(lights)?.into_iter().flatten().collect();
        let baked = Baked::of(&device.gpu, tables.anisotropic, materials)?;
        let shader = device.shader(&textures, baked.is_some())?;
        let mut numbers = 0..;
        let lights = lights.iter().map(|emitter| light(emitter, &mut numbers)).collect();
        Ok(Self { device, shader, baked, lights })
    }
}

impl Shade for GpuBackend<'_> {
    fn device(&self) -> String {
        self.device.gpu.info().to_string()
    }

    fn batch(&self) -> usize {
        1 << 17
    }

    fn shade(&self, points: &[SurfacePoint]) -> Result<Vec<DVec3>, RenderError> {
        let tables = Tables {
            isotropic: Some(&self.device.isotropic),
            anisotropic: Some(&self.device.anisotropic),
            baked: self.baked.as_ref().map(|baked| &baked.slices),
        };
        let points: Vec<_> = points.iter().map(|point| surface_point(point, self.baked.as_ref())).collect();
        let radiance = self.shader.shade(&self.device.gpu, tables, &points, &self.lights)?;
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

fn surface_point(point: &SurfacePoint, baked: Option<&Baked>) -> ltc_shade_gpu::SurfacePoint {
    let material = &point.material;
    ltc_shade_gpu::SurfacePoint {
        position: point.position.as_vec3(),
        normal: point.normal.as_vec3(),
        tangent: point.tangent.as_vec3(),
        wo: point.wo.as_vec3(),
        alpha_x: material.alpha.x() as f32,
        alpha_y: material.alpha.y() as f32,
        isotropic: material.is_isotropic(),
        slice: baked.and_then(|baked| baked.slice(material.alpha)),
        f0: material.f0.as_vec3(),
        f90: material.f90 as f32,
        albedo: material.albedo.as_vec3(),
    }
}
