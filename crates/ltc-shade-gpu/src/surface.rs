//! What is shaded.

use glam::Vec3;
use ltc_core::{Alpha, InputError, Vector, check_range};

use crate::constants::{ANISOTROPIC_TABLE, FIRST_SLICE, ISOTROPIC_TABLE};
use crate::layout::SurfaceLayout;
use crate::{GpuError, Tables};

const POINT: &str = "point";

/// A visible surface point with its material: one entry of a G-buffer. World space, any length unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// Where it is.
    pub position: Vec3,
    /// Shading normal; any length but zero.
    pub normal: Vec3,
    /// Direction that carries `alpha_x`. Zero, or parallel to the normal: any direction is taken, as for isotropic
    /// materials.
    pub tangent: Vec3,
    /// Towards the eye; any length but zero. Below the surface's horizon it counts as on the horizon.
    pub wo: Vec3,
    /// GGX width along the tangent, in [0, 1]; raised to [`ltc_core::ALPHA_MIN`].
    pub alpha_x: f32,
    /// GGX width along the bitangent, likewise.
    pub alpha_y: f32,
    /// Look into the isotropic table, if there is one. Then the widths must be equal.
    pub isotropic: bool,
    /// Look into this slice of [`Tables::baked`], which must have been baked for these widths, by a pipeline that was compiled for
    /// it ([`crate::ShadingOptions`]).
    pub slice: Option<u32>,
    /// Specular reflectance (linear RGB) at normal incidence, in [0, 1].
    pub f0: Vec3,
    /// Specular reflectance at grazing incidence, in [0, 1].
    pub f90: f32,
    /// Diffuse (Lambert) albedo, linear RGB, in [0, 1].
    pub albedo: Vec3,
}

impl SurfacePoint {
    pub(crate) fn encode(&self, index: usize, tables: Tables<'_>) -> Result<SurfaceLayout, GpuError> {
        if self.isotropic && self.alpha_x != self.alpha_y {
            let (alpha_x, alpha_y) = (f64::from(self.alpha_x), f64::from(self.alpha_y));
            return Err(GpuError::NotIsotropic { item: POINT, index, alpha_x, alpha_y });
        }
        let alpha = self.check().map_err(GpuError::input(POINT, index))?;
        let table = self.table(index, tables, [alpha.x() as f32, alpha.y() as f32])?;
        Ok(SurfaceLayout {
            position: self.position.to_array(),
            alpha_x: alpha.x() as f32,
            normal: self.normal.to_array(),
            alpha_y: alpha.y() as f32,
            tangent: self.tangent.to_array(),
            table,
            wo: self.wo.to_array(),
            f90: self.f90,
            f0: self.f0.to_array(),
            unused_0: 0.0,
            albedo: self.albedo.to_array(),
            unused_1: 0.0,
        })
    }

    /// Where the shader looks its lobe up.
    fn table(&self, index: usize, tables: Tables<'_>, widths: [f32; 2]) -> Result<u32, GpuError> {
        let missing = |table| GpuError::MissingTable { item: POINT, index, table };
        if let Some(slice) = self.slice {
            let slices = tables.baked.ok_or_else(|| missing("baked"))?;
            return match slices.widths(slice) {
                Some(baked) if baked == widths => Ok(FIRST_SLICE + slice),
                _ => Err(GpuError::WrongSlice { item: POINT, index, slice }),
            };
        }
        if self.isotropic && tables.isotropic.is_some() {
            return Ok(ISOTROPIC_TABLE);
        }
        tables.anisotropic.map(|_| ANISOTROPIC_TABLE).ok_or_else(|| missing("anisotropic"))
    }

    fn check(&self) -> Result<Alpha, InputError> {
        for (name, vector) in [("position", self.position), ("tangent", self.tangent)] {
            if !vector.is_finite() {
                return Err(InputError::NotFinite { name });
            }
        }
        for (name, vector) in [("normal", self.normal), ("wo", self.wo)] {
            vector.try_unit().ok_or(InputError::Degenerate { name })?;
        }
        for (name, color) in [("f0", self.f0), ("albedo", self.albedo), ("f90", Vec3::splat(self.f90))] {
            for channel in color.to_array() {
                check_range(name, f64::from(channel), 0.0, 1.0)?;
            }
        }
        Alpha::new(f64::from(self.alpha_x), f64::from(self.alpha_y))
    }
}
