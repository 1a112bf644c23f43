//! Tables as the published shaders fetch them.

use glam::DMat3;
use ltc_core::Matrix;
use ltc_shade_gpu::timing::Resource;
use ltc_shade_gpu::{Gpu, GpuError};
use ltc_table::{Axis, Catalogue, CellStats, DropIn, Kind, Mapping, Precision, Quantity, Query, Table};

use super::super::StudyError;

/// Nodes of each axis of the 2022 paper's table.
const NODES: usize = 8;

/// What published shaders read: contents are those of shipped tables, laid out as the papers have them.
pub struct Published {
    /// The drop-in layout, in half floats.
    pub drop_in: DropIn,
    /// Uniform axes over the whole domain, in half floats.
    pub anisotropic: Table,
}

impl Published {
    /// From the shipped tables.
    ///
    /// # Errors
    /// For a table that is missing or does not survive as half floats.
    pub fn of(catalogue: &Catalogue) -> Result<Self, StudyError> {
        let drop_in = DropIn::of(catalogue.find("ggx-isotropic-dropin")?.table())?.rounded(Precision::F16)?;
        let anisotropic = uniform(catalogue.find("ggx-anisotropic")?.table())?;
        Ok(Self { drop_in, anisotropic })
    }

    /// Inverse matrices, norms with the sphere's share, and a sampler.
    ///
    /// # Errors
    /// Those of the device.
    pub fn isotropic_textures(&self, gpu: &Gpu) -> Result<[Resource; 3], GpuError> {
        let n = self.drop_in.size() as u32;
        let texture = |texels: &[[f64; 4]]| Resource::half_texture(gpu, [n, n, 0], &halves(texels));
        Ok([texture(self.drop_in.matrices())?, texture(self.drop_in.albedos())?, Resource::sampler(gpu)?])
    }

    /// Eleven channels in three textures, x = φ, y = θ, z = λ + 8 α, and a sampler.
    ///
    /// # Errors
    /// Those of the device.
    pub fn anisotropic_textures(&self, gpu: &Gpu) -> Result<[Resource; 4], GpuError> {
        let table = &self.anisotropic;
        let groups = |group: usize| {
            let mut texels = Vec::with_capacity(NODES.pow(4));
            for alpha in 0..NODES {
                for lambda in 0..NODES {
                    for theta in 0..NODES {
                        for phi in 0..NODES {
                            let at = ((theta * NODES + phi) * NODES + alpha) * NODES + lambda;
                            let m = table.m()[at].to_row_array();
                            texels.push(match group {
                                0 => [m[0], m[1], m[2], m[3]],
                                1 => [m[4], m[5], m[6], m[7]],
                                _ => [m[8], table.magnitude()[at], table.fresnel()[at], 0.0],
                            });
                        }
                    }
                }
            }
            let n = NODES as u32;
            Resource::half_texture(gpu, [n, n, n * n], &halves(&texels))
        };
        Ok([groups(0)?, groups(1)?, groups(2)?, Resource::sampler(gpu)?])
    }
}

fn halves(texels: &[[f64; 4]]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(8 * texels.len());
    texels.iter().flatten().for_each(|x| Precision::F16.put(*x, &mut bytes));
    bytes
}

/// A table with the 2022 paper's axes, its entries looked up in another: what it says is close to that, and its size and
/// fetches are the paper's.
fn uniform(from: &Table) -> Result<Table, StudyError> {
    debug_assert_eq!(from.kind(), Kind::Anisotropic);
    let axes: Vec<Axis> = [Quantity::Theta, Quantity::Phi, Quantity::Alpha, Quantity::Lambda]
        .map(|quantity| Axis::full(quantity, Mapping::Linear, NODES))
        .into();
    let (mut m, mut magnitude, mut fresnel) = (Vec::new(), Vec::new(), Vec::new());
    for index in 0..NODES.pow(4) {
        let node = |axis: usize| axes[axis].node(index / NODES.pow(3 - axis as u32) % NODES);
        let alpha = node(2);
        let query = Query { theta: node(0), phi: node(1), alpha_x: alpha, alpha_y: alpha * node(3) };
        let found = from.lookup(&query)?;
        m.push(DMat3::from_row_array(found.lobes[0].m));
        magnitude.push(found.magnitude);
        fresnel.push(found.fresnel);
    }
    Ok(Table::new(axes, m, magnitude, fresnel, CellStats::default())?.rounded(Precision::F16)?)
}
