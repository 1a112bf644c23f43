//! Batches of polygons, each under a lobe of its own.

use glam::{Mat3, Vec3};
use ltc_core::{InputError, Ltc, Matrix, Polygon, Sides};

use crate::compute::{Batch, Kernel, compile};
use crate::layout::PolygonLayout;
use crate::modules::Program;
use crate::{Gpu, GpuError};

/// Jobs and vertices that go to the device at once; one larger polygon goes alone.
const CHUNK: usize = 1 << 18;

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

/// The pipelines that integrate polygons: [`ltc_core::Polygon`] on the device.
#[derive(Debug)]
pub struct Polygons {
    polygons: Kernel,
    quads: Kernel,
}

impl Polygons {
    /// Compiles the pipelines.
    ///
    /// # Errors
    /// [`GpuError::Device`].
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let module = compile(gpu, Program::Integrate)?;
        let kernel = |entry_point| Kernel::new(gpu, &module, entry_point, None, 2);
        Ok(Self { polygons: kernel("polygons")?, quads: kernel("quads")? })
    }

    /// The fraction of each lobe that sees its light, in [0, 1]. A degenerate light gives 0.
    ///
    /// # Errors
    /// [`GpuError::Input`] with the index of the first job that [`Ltc::new`] or [`Polygon::new`] refuses in `f32`; then
    /// nothing is run.
    pub fn integrate(&self, gpu: &Gpu, jobs: &[PolygonJob<'_>]) -> Result<Vec<f32>, GpuError> {
        run(gpu, &self.polygons, jobs)
    }

    /// The same for quads alone, by the shader's shorter path that shading uses.
    ///
    /// # Errors
    /// As [`Polygons::integrate`]; also [`InputError::OutOfRange`] for a job that has not four vertices.
    pub fn integrate_quads(&self, gpu: &Gpu, jobs: &[PolygonJob<'_>]) -> Result<Vec<f32>, GpuError> {
        for (index, job) in jobs.iter().enumerate() {
            let value = job.vertices.len() as f64;
            if value != 4.0 {
                let source = InputError::OutOfRange { name: "number of vertices", value, min: 4.0, max: 4.0 };
                return Err(GpuError::Input { item: "polygon", index, source });
            }
        }
        run(gpu, &self.quads, jobs)
    }
}

/// Jobs as the shader reads them.
#[derive(Default)]
struct Encoded {
    jobs: Vec<PolygonLayout>,
    vertices: Vec<[f32; 4]>,
}

fn run(gpu: &Gpu, kernel: &Kernel, jobs: &[PolygonJob<'_>]) -> Result<Vec<f32>, GpuError> {
    // All are checked before any is run.
    let lobes = jobs.iter().enumerate().map(check).collect::<Result<Vec<_>, _>>()?;
    let mut results = Vec::with_capacity(jobs.len());
    let mut encoded = Encoded::default();
    for (job, lobe) in jobs.iter().zip(&lobes) {
        let full = encoded.jobs.len() == CHUNK || encoded.vertices.len() + job.vertices.len() > CHUNK;
        if full && !encoded.jobs.is_empty() {
            results.extend(encoded.run(gpu, kernel, results.len())?);
            encoded = Encoded::default();
        }
        encoded.push(job, lobe);
    }
    results.extend(encoded.run(gpu, kernel, results.len())?);
    Ok(results)
}

fn check((index, job): (usize, &PolygonJob<'_>)) -> Result<Ltc<f32>, GpuError> {
    let lobe = Ltc::new(Mat3::from_row_array(job.m)).map_err(GpuError::input("polygon", index))?;
    let vertices: Vec<_> = job.vertices.iter().map(|v| Vec3::from_array(*v)).collect();
    Polygon::<f32>::new(&vertices, job.sides).map_err(GpuError::input("polygon", index))?;
    Ok(lobe)
}

impl Encoded {
    fn push(&mut self, job: &PolygonJob<'_>, lobe: &Ltc<f32>) {
        let m = lobe.target_from_cosine();
        self.jobs.push(PolygonLayout {
            m0: m.x_axis.to_array(),
            two_sided: u32::from(job.sides == Sides::Two),
            m1: m.y_axis.to_array(),
            first_vertex: self.vertices.len() as u32,
            m2: m.z_axis.to_array(),
            vertex_count: job.vertices.len() as u32,
        });
        self.vertices.extend(job.vertices.iter().map(|[x, y, z]| [*x, *y, *z, 0.0]));
    }

    /// `done` jobs went before these: errors count from the first of all.
    fn run(&self, gpu: &Gpu, kernel: &Kernel, done: usize) -> Result<Vec<f32>, GpuError> {
        let batch = Batch {
            item: "polygon",
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
