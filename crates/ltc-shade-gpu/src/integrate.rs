//! Batches of lights, each under a lobe of its own.

use glam::{Mat3, Vec3};
use ltc_core::{InputError, Ltc, Matrix, Sides};

use crate::compute::{Batch, Kernel, compile};
use crate::layout::IntegrateLayout;
use crate::modules::Program;
use crate::{Gpu, GpuError, LightShape};

/// Jobs and vertices that go to the device at once; one larger polygon goes alone.
const CHUNK: usize = 1 << 18;

/// A light seen from the shading point, in the shading frame, and the lobe that it lights.
#[derive(Clone, Debug)]
pub struct LightJob {
    /// `M` (`target_from_cosine`), row-major, det > 0, any scale.
    pub m: [f32; 9],
    /// The light.
    pub light: LightShape,
}

/// The pipeline that integrates lights: [`ltc_core::Light::integrate`] on the device.
#[derive(Debug)]
pub struct Lights {
    kernel: Kernel,
}

impl Lights {
    /// Compiles the pipeline.
    ///
    /// # Errors
    /// [`GpuError::Device`].
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        Self::of_module(gpu, &compile(gpu, Program::Integrate)?)
    }

    pub(crate) fn of_module(gpu: &Gpu, module: &wgpu::ShaderModule) -> Result<Self, GpuError> {
        Ok(Self { kernel: Kernel::new(gpu, module, "main", None, 2)? })
    }

    /// The fraction of each lobe that sees its light, in [0, 1]. A degenerate light gives 0.
    ///
    /// # Errors
    /// [`GpuError::Input`] with the index of the first job that [`Ltc::new`] or the light's constructor refuses in `f32`;
    /// then nothing is run.
    pub fn integrate(&self, gpu: &Gpu, jobs: &[LightJob]) -> Result<Vec<f32>, GpuError> {
        // All are checked before any is run.
        let lobes = jobs.iter().enumerate().map(check).collect::<Result<Vec<_>, _>>()?;
        let mut results = Vec::with_capacity(jobs.len());
        let mut encoded = Encoded::default();
        for (job, lobe) in jobs.iter().zip(&lobes) {
            let further =
                if let LightShape::Polygon { vertices, .. } = &job.light { vertices.len() } else { 0 };
            let full = encoded.jobs.len() == CHUNK || encoded.vertices.len() + further > CHUNK;
            if full && !encoded.jobs.is_empty() {
                results.extend(encoded.run(gpu, &self.kernel, results.len())?);
                encoded = Encoded::default();
            }
            encoded.push(job, lobe);
        }
        results.extend(encoded.run(gpu, &self.kernel, results.len())?);
        Ok(results)
    }
}

fn check((index, job): (usize, &LightJob)) -> Result<Ltc<f32>, GpuError> {
    let lobe = Ltc::new(Mat3::from_row_array(job.m)).map_err(GpuError::input("light", index))?;
    job.light.check().map_err(GpuError::input("light", index))?;
    Ok(lobe)
}

/// Jobs as the shader reads them.
#[derive(Default)]
struct Encoded {
    jobs: Vec<IntegrateLayout>,
    vertices: Vec<[f32; 4]>,
}

impl Encoded {
    fn push(&mut self, job: &LightJob, lobe: &Ltc<f32>) {
        let light = job.light.encode(Vec3::ZERO, &mut self.vertices);
        self.jobs.push(IntegrateLayout::new(lobe, light));
    }

    /// `done` jobs went before these: errors count from the first of all.
    fn run(&mut self, gpu: &Gpu, kernel: &Kernel, done: usize) -> Result<Vec<f32>, GpuError> {
        if self.vertices.is_empty() {
            // A buffer cannot be empty; no light looks into it.
            self.vertices.push([0.0; 4]);
        }
        let batch = Batch {
            item: "light",
            first: done,
            items: self.jobs.len(),
            counts: [self.jobs.len() as u32, 0, 0, 0],
            inputs: &[bytemuck::cast_slice(&self.jobs), bytemuck::cast_slice(&self.vertices)],
            floats_each: 1,
            tables: None,
        };
        kernel.run(gpu, &batch)
    }
}

/// A polygonal light seen from the shading point, and the lobe that it lights.
#[derive(Clone, Copy, Debug)]
pub struct PolygonJob<'a> {
    /// `M` (`target_from_cosine`), row-major, det > 0, any scale.
    pub m: [f32; 9],
    /// In the shading frame, relative to the shading point, counter-clockwise seen from the emitting side; three or
    /// more.
    pub vertices: &'a [[f32; 3]],
    /// Which sides emit.
    pub sides: Sides,
}

/// [`Lights`] for polygons alone, with a choice of the shader's path.
#[derive(Debug)]
pub struct Polygons {
    lights: Lights,
}

impl Polygons {
    /// Compiles the pipeline.
    ///
    /// # Errors
    /// [`GpuError::Device`].
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        Ok(Self { lights: Lights::new(gpu)? })
    }

    /// The fraction of each lobe that sees its light, in [0, 1]. A degenerate light gives 0.
    ///
    /// # Errors
    /// As [`Lights::integrate`].
    pub fn integrate(&self, gpu: &Gpu, jobs: &[PolygonJob<'_>]) -> Result<Vec<f32>, GpuError> {
        let shape = |job: &PolygonJob<'_>| LightShape::Polygon {
            vertices: job.vertices.iter().map(|v| Vec3::from_array(*v)).collect(),
            sides: job.sides,
        };
        let jobs: Vec<_> = jobs.iter().map(|job| LightJob { m: job.m, light: shape(job) }).collect();
        self.lights.integrate(gpu, &jobs)
    }

    /// The same for quads alone, by the shader's shorter path that shading uses.
    ///
    /// # Errors
    /// As [`Polygons::integrate`]; also [`InputError::OutOfRange`] for a job that has not four vertices.
    pub fn integrate_quads(&self, gpu: &Gpu, jobs: &[PolygonJob<'_>]) -> Result<Vec<f32>, GpuError> {
        let quad = |(index, job): (usize, &PolygonJob<'_>)| {
            let corners = <[[f32; 3]; 4]>::try_from(job.vertices).map_err(|_| {
                let value = job.vertices.len() as f64;
                let source = InputError::OutOfRange { name: "number of vertices", value, min: 4.0, max: 4.0 };
                GpuError::Input { item: "polygon", index, source }
            })?;
            let light = LightShape::Quad { corners: corners.map(Vec3::from_array), sides: job.sides };
            Ok(LightJob { m: job.m, light })
        };
        let jobs = jobs.iter().enumerate().map(quad).collect::<Result<Vec<_>, GpuError>>()?;
        self.lights.integrate(gpu, &jobs)
    }
}
