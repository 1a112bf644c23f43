//! Batches of table lookups.

use ltc_table::{Kind, Query};
use wgpu::BindGroupLayout;

use crate::compute::{Batch, Kernel, compile};
use crate::layout::LookupLayout;
use crate::modules::Program;
use crate::table_textures::{bind_group, bind_group_layout};
use crate::{Gpu, GpuError, TableTextures, Tables};

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
    tables: BindGroupLayout,
}

impl Lookups {
    /// Compiles the pipeline.
    ///
    /// # Errors
    /// [`GpuError::Device`].
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let module = compile(gpu, Program::Lookup(gpu.filtering()))?;
        let tables = bind_group_layout(gpu)?;
        Ok(Self { kernel: Kernel::new(gpu, &module, "main", Some(&tables), 1)?, tables })
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
            Kind::Isotropic => Tables { isotropic: Some(table), anisotropic: None },
            Kind::Anisotropic => Tables { isotropic: None, anisotropic: Some(table) },
        };
        let bound = bind_group(gpu, &self.tables, tables)?;
        let mut results = Vec::with_capacity(queries.len());
        for chunk in jobs.chunks(CHUNK) {
            let batch = Batch {
                item: "query",
                first: results.len(),
                items: chunk.len(),
                counts: [chunk.len() as u32, 0, 0, 0],
                inputs: &[bytemuck::cast_slice(chunk)],
                floats_each: FLOATS,
                tables: Some(&bound),
            };
            let floats = self.kernel.run(gpu, &batch)?;
            results.extend(floats.as_chunks::<FLOATS>().0.iter().map(decode));
        }
        Ok(results)
    }
}

fn encode(kind: Kind, index: usize, query: &Query) -> Result<LookupLayout, GpuError> {
    let alpha = query.validate().map_err(GpuError::input("query", index))?;
    if kind == Kind::Isotropic && alpha.x() != alpha.y() {
        let Query { alpha_x, alpha_y, .. } = *query;
        return Err(GpuError::NotIsotropic { item: "query", index, alpha_x, alpha_y });
    }
    let sin = query.theta.sin().max(SMALLEST_SINE);
    let (sin_phi, cos_phi) = query.phi.sin_cos();
    Ok(LookupLayout {
        wo: [sin * cos_phi, sin * sin_phi, query.theta.cos().max(0.0)].map(|x| x as f32),
        alpha_x: alpha.x() as f32,
        alpha_y: alpha.y() as f32,
        isotropic: u32::from(kind == Kind::Isotropic),
        unused: [0; 2],
    })
}

fn decode(floats: &[f32; FLOATS]) -> LookupResult {
    let [m @ .., magnitude, fresnel, _] = *floats;
    LookupResult { m, magnitude, fresnel }
}
