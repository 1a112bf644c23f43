//! Batches of textured lights, each under a lobe of its own.

use glam::{Mat3, Vec3};
use ltc_core::{Ltc, Matrix};
use wgpu::{BindGroup, BindGroupLayout};

use crate::compute::{Batch, Kernel, compile};
use crate::layout::IntegrateLayout;
use crate::modules::Program;
use crate::{Gpu, GpuError, LightShape, LightTexture, LightTextures};

/// Jobs that go to the device at once.
const CHUNK: usize = 1 << 17;

/// A textured light seen from the shading point, in the shading frame, and the lobe that it lights.
#[derive(Clone, Debug)]
pub struct TexturedJob {
    /// `M` (`target_from_cosine`), row-major, det > 0, any scale.
    pub m: [f32; 9],
    /// A quad or a polygon.
    pub light: LightShape,
    /// Its texture.
    pub texture: LightTexture,
}

/// The pipeline that integrates textured lights: [`ltc_core::TexturedPolygon::integrate_colour`] on the device.
#[derive(Debug)]
pub struct TexturedLights {
    kernel: Kernel,
    bound: BindGroup,
    textures: LightTextures,
}

impl TexturedLights {
    /// Compiles the pipeline for these textures.
    ///
    /// # Errors
    /// [`GpuError::Device`].
    pub fn new(gpu: &Gpu, textures: LightTextures) -> Result<Self, GpuError> {
        Self::of_module(gpu, &compile(gpu, Program::IntegrateTextured)?, textures)
    }

    pub(crate) fn of_module(
        gpu: &Gpu,
        module: &wgpu::ShaderModule,
        textures: LightTextures,
    ) -> Result<Self, GpuError> {
        let (layout, bound) = gpu.checked(|| Ok(bind(gpu, &textures)))?;
        Ok(Self { kernel: Kernel::new(gpu, module, "main", Some(&layout), 2)?, bound, textures })
    }

    /// What each lobe sees of its light, per channel: the fraction of the lobe times the filtered colour. A degenerate light
    /// gives 0.
    ///
    /// # Errors
    /// [`GpuError::Input`] with the index of the first job that [`Ltc::new`] or the light's constructor refuses in `f32`,
    /// [`GpuError::MissingTexture`], [`GpuError::NotTexturable`]; then nothing is run.
    pub fn integrate(&self, gpu: &Gpu, jobs: &[TexturedJob]) -> Result<Vec<[f32; 3]>, GpuError> {
        let mut vertices = Vec::new();
        let encoded = jobs.iter().enumerate().map(|(index, job)| self.encode(index, job, &mut vertices));
        let encoded = encoded.collect::<Result<Vec<_>, _>>()?;
        if vertices.is_empty() {
            // A buffer cannot be empty; no light looks into it.
            vertices.push([0.0; 4]);
        }
        let mut results = Vec::with_capacity(jobs.len());
        for chunk in encoded.chunks(CHUNK) {
            let batch = Batch {
                item: "light",
                first: results.len(),
                items: chunk.len(),
                counts: [chunk.len() as u32, 0, 0, 0],
                inputs: &[bytemuck::cast_slice(chunk), bytemuck::cast_slice(&vertices)],
                floats_each: 4,
                tables: Some(&self.bound),
            };
            let floats = self.kernel.run(gpu, &batch)?;
            results.extend(floats.as_chunks::<4>().0.iter().map(|[r, g, b, _]| [*r, *g, *b]));
        }
        Ok(results)
    }

    fn encode(
        &self,
        index: usize,
        job: &TexturedJob,
        vertices: &mut Vec<[f32; 4]>,
    ) -> Result<IntegrateLayout, GpuError> {
        let input = || GpuError::input("light", index);
        let lobe: Ltc<f32> = Ltc::new(Mat3::from_row_array(job.m)).map_err(input())?;
        job.light.check().map_err(input())?;
        self.textures.check(&job.texture, Vec3::ONE, index)?;
        let light = job.light.encode_textured(Vec3::ZERO, &job.texture, vertices);
        let light = light.ok_or(GpuError::NotTexturable { light: index, kind: job.light.kind() })?;
        Ok(IntegrateLayout::new(&lobe, light))
    }
}

/// The textures alone, where pipelines have their tables.
fn bind(gpu: &Gpu, textures: &LightTextures) -> (BindGroupLayout, BindGroup) {
    let label = Some("ltc light textures");
    let layout = gpu.device().create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label,
        entries: &[LightTextures::layout_entry()],
    });
    let view = textures.view();
    let entries = [LightTextures::entry(&view)];
    let descriptor = wgpu::BindGroupDescriptor { label, layout: &layout, entries: &entries };
    let bound = gpu.device().create_bind_group(&descriptor);
    (layout, bound)
}
