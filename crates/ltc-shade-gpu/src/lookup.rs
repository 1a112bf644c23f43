//! Batches of table lookups.

use crate::compute::{Batch, Kernel, compile};
use crate::constants::{ANISOTROPIC_TABLE, FIRST_SLICE, ISOTROPIC_TABLE};
use crate::layout::LookupLayout;
use crate::modules::{Extras, Program};
use crate::table_bindings::TableBindings;
use crate::{BakedSlices, Gpu, GpuError, TableTextures, Tables};
use ltc_table::{Kind, Query};

/// Queries that go to the device at once.
const CHUNK: usize = 1 << 18;
/// Floats that the shader writes for each query.
const FLOATS: usize = 12;
/// The sine of the polar angle that a view along the normal is given: it has no other effect than to keep the azimuth.
const SMALLEST_SINE: f64 = 1e-18;

/// What a table says about a query: [`ltc_table::Lookup`] in `f32`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LookupResult {
    /// `M`, row-major, cosine space → lobe.
    pub m: [f32; 9],
    /// `∫ ρ cos` at F = 1.
    pub magnitude: f32,
    /// `∫ (1 − ωo·ωh)^5 ρ cos`.
    pub fresnel: f32,
}

/// The pipeline that looks into a table: [`ltc_table::Table::lookup`] on the device, by the functions that shading
/// uses.
#[derive(Debug)]
pub struct Lookups {
    kernel: Kernel,
    tables: TableBindings,
}

impl Lookups {
    /// Compiles the pipeline.
    ///
    /// # Errors
    /// [`GpuError::Device`].
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let module = compile(gpu, Program::Lookup(gpu.filtering(), Extras::default()))?;
        let tables = TableBindings::new(gpu, Extras::default())?;
        Ok(Self { kernel: Kernel::new(gpu, &module, "main", Some(tables.layout()), 1)?, tables })
    }

    /// One result for each query.
    ///
    /// # Errors
    /// [`GpuError::Input`] with the index of the first invalid query, [`GpuError::NotIsotropic`] where an isotropic table
    /// is asked for α_x ≠ α_y; then nothing is run.
    pub fn lookup(
        &self,
        gpu: &Gpu,
        table: &TableTextures,
        queries: &[Query],
    ) -> Result<Vec<LookupResult>, GpuError> {
        let kind = table.kind();
        let jobs = queries
            .iter()
            .enumerate()
            .map(|(index, query)| encode(kind, index, query))
            .collect::<Result<Vec<_>, _>>()?;
        let tables = match kind {
            Kind::Isotropic => Tables { isotropic: Some(table), ..Tables::default() },
            Kind::Anisotropic => Tables { anisotropic: Some(table), ..Tables::default() },
        };
        let bound = self.tables.bind(gpu, tables, None)?;
        in_chunks(gpu, &self.kernel, &jobs, &bound)
    }
}

/// A query of a slice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BakedQuery {
    /// The slice.
    pub slice: u32,
    /// Polar angle of the view, [0, π/2].
    pub theta: f64,
    /// Azimuth of the view, any finite angle.
    pub phi: f64,
}

/// The pipeline that looks into baked slices, by the functions that shading uses.
#[derive(Debug)]
pub struct BakedLookups {
    kernel: Kernel,
    tables: TableBindings,
}

impl BakedLookups {
    /// Compiles the pipeline.
    ///
    /// # Errors
    /// [`GpuError::Device`].
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let extras = Extras { baked: true, ..Extras::default() };
        let module = compile(gpu, Program::Lookup(gpu.filtering(), extras))?;
        let tables = TableBindings::new(gpu, extras)?;
        Ok(Self { kernel: Kernel::new(gpu, &module, "main", Some(tables.layout()), 1)?, tables })
    }

    /// One result for each query.
    ///
    /// # Errors
    /// [`GpuError::Input`] with the index of the first invalid query, [`GpuError::WrongSlice`] where a slice is not there; then
    /// nothing is run.
    pub fn lookup(
        &self,
        gpu: &Gpu,
        slices: &BakedSlices,
        queries: &[BakedQuery],
    ) -> Result<Vec<LookupResult>, GpuError> {
        let job = |(index, query): (usize, &BakedQuery)| {
            let BakedQuery { slice, theta, phi } = *query;
            let wrong = GpuError::WrongSlice { item: "query", index, slice };
            let [alpha_x, alpha_y] = slices.widths(slice).ok_or(wrong)?;
            let query = Query { theta, phi, alpha_x: f64::from(alpha_x), alpha_y: f64::from(alpha_y) };
            query.validate().map_err(GpuError::input("query", index))?;
            Ok(layout(&query, [alpha_x, alpha_y], FIRST_SLICE + slice))
        };
        let jobs = queries.iter().enumerate().map(job).collect::<Result<Vec<LookupLayout>, GpuError>>()?;
        let bound = self.tables.bind(gpu, Tables { baked: Some(slices), ..Tables::default() }, None)?;
        in_chunks(gpu, &self.kernel, &jobs, &bound)
    }
}

/// Runs the jobs, a chunk of them at a time.
fn in_chunks<Job: bytemuck::Pod>(
    gpu: &Gpu,
    kernel: &Kernel,
    jobs: &[Job],
    tables: &wgpu::BindGroup,
) -> Result<Vec<LookupResult>, GpuError> {
    let mut results = Vec::with_capacity(jobs.len());
    for chunk in jobs.chunks(CHUNK) {
        let batch = Batch {
            item: "query",
            first: results.len(),
            items: chunk.len(),
            counts: [chunk.len() as u32, 0, 0, 0],
            inputs: &[bytemuck::cast_slice(chunk)],
            floats_each: FLOATS,
            tables: Some(tables),
        };
        let floats = kernel.run(gpu, &batch)?;
        results.extend(floats.as_chunks::<FLOATS>().0.iter().map(decode));
    }
    Ok(results)
}

fn encode(kind: Kind, index: usize, query: &Query) -> Result<LookupLayout, GpuError> {
    let alpha = query.validate().map_err(GpuError::input("query", index))?;
    if kind == Kind::Isotropic && alpha.x() != alpha.y() {
        let Query { alpha_x, alpha_y, .. } = *query;
        return Err(GpuError::NotIsotropic { item: "query", index, alpha_x, alpha_y });
    }
    let table = match kind {
        Kind::Isotropic => ISOTROPIC_TABLE,
        Kind::Anisotropic => ANISOTROPIC_TABLE,
    };
    Ok(layout(query, [alpha.x() as f32, alpha.y() as f32], table))
}

fn layout(query: &Query, [alpha_x, alpha_y]: [f32; 2], table: u32) -> LookupLayout {
    let sin = query.theta.sin().max(SMALLEST_SINE);
    let (sin_phi, cos_phi) = query.phi.sin_cos();
    let wo = [sin * cos_phi, sin * sin_phi, query.theta.cos().max(0.0)].map(|x| x as f32);
    LookupLayout { wo, alpha_x, alpha_y, table, unused: [0; 2] }
}

fn decode(floats: &[f32; FLOATS]) -> LookupResult {
    let [m @ .., magnitude, fresnel, _] = *floats;
    LookupResult { m, magnitude, fresnel }
}
