//! What is shaded.

use glam::Vec3;
use ltc_core::{Alpha, InputError, Vector, check_range};

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
    /// Specular reflectance (linear RGB) at normal incidence, in [0, 1].
    pub f0: Vec3,
    /// Specular reflectance at grazing incidence, in [0, 1].
    pub f90: f32,
    /// Diffuse (Lambert) albedo, linear RGB, in [0, 1].
    pub albedo: Vec3,
}

impl SurfacePoint {
    pub(crate) fn encode(&self, index: usize, tables: Tables<'_>) -> Result<SurfaceLayout, GpuError> {
        let isotropic = self.isotropic && tables.isotropic.is_some();
        if self.isotropic && self.alpha_x != self.alpha_y {
            let (alpha_x, alpha_y) = (f64::from(self.alpha_x), f64::from(self.alpha_y));
            return Err(GpuError::NotIsotropic { item: POINT, index, alpha_x, alpha_y });
        }
        if !isotropic && tables.anisotropic.is_none() {
            return Err(GpuError::MissingTable { item: POINT, index, table: "anisotropic" });
        }
        let alpha = self.check().map_err(GpuError::input(POINT, index))?;
        Ok(SurfaceLayout {
            position: self.position.to_array(),
            alpha_x: alpha.x() as f32,
            normal: self.normal.to_array(),
            alpha_y: alpha.y() as f32,
            tangent: self.tangent.to_array(),
            isotropic: u32::from(isotropic),
            wo: self.wo.to_array(),
            f90: self.f90,
            f0: self.f0.to_array(),
            unused_0: 0.0,
            albedo: self.albedo.to_array(),
            unused_1: 0.0,
        })
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
