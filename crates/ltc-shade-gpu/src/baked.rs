//! Slices of an anisotropic table, one for each material.

use core::f64::consts::FRAC_PI_2;

use ltc_core::Alpha;
use ltc_table::{ClosedForm, Kind, Query, Table, TableError, ktx2};

use crate::layout::AxesUniform;
use crate::table_textures::{Storage, View, check_extent, create, entry_bytes, precision};
use crate::{Gpu, GpuError};

/// What is left of an anisotropic table for materials whose widths do not change from point to point: for each pair of widths the
/// lobes of all views.
///
/// The table's interpolation along α and λ is done here, once, by [`Table::lookup`] in `f64`; what is left, along θ and φ, is the
/// same, so that a lookup in a slice is the table's own with 12 fetches instead of 48. (Where a matrix between entries is singular,
/// the nearest node of the slice answers instead of the nearest entry of the table.) A slice of an 8⁴ table takes 3 KiB.
#[derive(Debug)]
pub struct BakedSlices {
    axes: AxesUniform,
    texels: Storage,
    widths: Vec<[f32; 2]>,
}

impl BakedSlices {
    /// Bakes and uploads one slice for each pair (α_x, α_y), in their order, rounded to the device's [`crate::Texels`].
    ///
    /// # Errors
    /// [`GpuError::NotAnisotropic`] for a table of the other kind; [`GpuError::TableTooLarge`] when the device's textures have
    /// too few layers, three for each slice ([`Self::most`]); [`GpuError::UnsupportedAxis`]; [`GpuError::TableTexels`] where 16
    /// bits cannot hold a slice; [`GpuError::Device`].
    pub fn bake(gpu: &Gpu, table: &Table, widths: &[Alpha]) -> Result<Self, GpuError> {
        let (Kind::Anisotropic, [theta, phi, ..]) = (table.kind(), table.axes()) else {
            return Err(GpuError::NotAnisotropic);
        };
        let axes = AxesUniform::of(table)?;
        if widths.is_empty() {
            let texels = gpu.checked(|| Ok(Storage::placeholder(gpu, Kind::Isotropic)))?;
            return Ok(Self { axes, texels, widths: Vec::new() });
        }
        let size = wgpu::Extent3d {
            width: phi.len as u32,
            height: theta.len as u32,
            depth_or_array_layers: (widths.len() * ktx2::GROUPS) as u32,
        };
        check_extent(gpu, Kind::Isotropic, size)?;
        let slices: Vec<Vec<[f64; 12]>> =
            widths.iter().map(|alpha| slice(table, *alpha)).collect::<Result<_, _>>()?;
        let bytes = entry_bytes(precision(gpu), &slices)?;
        let texels = gpu.checked(|| Ok(create(gpu, Kind::Isotropic, size, &bytes)))?;
        let widths = widths.iter().map(|alpha| [alpha.x() as f32, alpha.y() as f32]).collect();
        Ok(Self { axes, texels, widths })
    }

    /// How many slices a device's textures can hold.
    pub fn most(gpu: &Gpu) -> usize {
        gpu.device().limits().max_texture_array_layers as usize / ktx2::GROUPS
    }

    /// Number of slices.
    pub fn len(&self) -> usize {
        self.widths.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.widths.is_empty()
    }

    /// Bytes of memory on the device.
    pub fn bytes(&self) -> u64 {
        self.texels.bytes()
    }

    pub(crate) fn bound(&self) -> (AxesUniform, View<'_>) {
        (self.axes, self.texels.view(Kind::Isotropic))
    }

    /// What a slice was baked for, as the shader compares it.
    pub(crate) fn widths(&self, slice: u32) -> Option<[f32; 2]> {
        self.widths.get(slice as usize).copied()
    }
}

/// The table's answers at all nodes of θ and φ, θ the slower, for views in the quadrant that the table holds; numbers as in a
/// table's texels.
fn slice(table: &Table, alpha: Alpha) -> Result<Vec<[f64; 12]>, TableError> {
    let [theta, phi, ..] = table.axes() else { return Ok(Vec::new()) };
    // Folded: the shader takes x and y apart again.
    let (alpha_x, alpha_y) = (alpha.x().max(alpha.y()), alpha.x().min(alpha.y()));
    let in_domain = |nodes: Vec<f64>| nodes.into_iter().map(|x| x.min(FRAC_PI_2));
    let views =
        in_domain(theta.nodes()).flat_map(|theta| in_domain(phi.nodes()).map(move |phi| (theta, phi)));
    let entry = |(theta, phi)| {
        let query = Query { theta, phi, alpha_x, alpha_y };
        let found = table.lookup(&query)?;
        let [a, b, c, d, e, f, g, h, i] = found.lobes[0].m;
        let [n, f_term] = table.lookup_remainders(&query)?.unwrap_or([found.magnitude, found.fresnel]);
        Ok([a, b, c, d, e, f, g, h, i, n, f_term, table.closed_form().map_or(0.0, ClosedForm::code)])
    };
    views.map(entry).collect()
}
