//! The anisotropic GGX microfacet reflection lobe.
//!
//! Shading frame: x = tangent (carries `alpha_x`), y = bitangent (`alpha_y`), z = normal. All directions are unit
//! vectors that point away from the surface.

use std::f64::consts::{PI, TAU};

use glam::{DVec3, dvec3};

use crate::error::ReferenceError;

/// GGX widths of one material. Both are at least [`Ggx::MIN_ALPHA`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ggx {
    alpha_x: f64,
    alpha_y: f64,
}

impl Ggx {
    /// The smallest width; smaller positive ones are raised to it. Below it the lobe is a mirror for every light
    /// that this workspace knows, and f32 implementations lose the lobe altogether.
    pub const MIN_ALPHA: f64 = 1e-4;

    /// GGX with widths `alpha_x` along the tangent and `alpha_y` along the bitangent.
    ///
    /// Widths in (0, [`Ggx::MIN_ALPHA`]) are raised to the floor; there is no upper limit.
    ///
    /// # Errors
    /// [`ReferenceError::NonFiniteInput`] and [`ReferenceError::InvalidAlpha`] (for a negative width; zero is
    /// raised to the floor).
    pub fn new(alpha_x: f64, alpha_y: f64) -> Result<Self, ReferenceError> {
        for alpha in [alpha_x, alpha_y] {
            if !alpha.is_finite() {
                return Err(ReferenceError::NonFiniteInput { what: "GGX width" });
            }
            if alpha < 0.0 {
                return Err(ReferenceError::InvalidAlpha { alpha });
            }
        }
        Ok(Self { alpha_x: alpha_x.max(Self::MIN_ALPHA), alpha_y: alpha_y.max(Self::MIN_ALPHA) })
    }

    /// GGX with the same width in every direction.
    ///
    /// # Errors
    /// As [`Ggx::new`].
    pub fn isotropic(alpha: f64) -> Result<Self, ReferenceError> {
        Self::new(alpha, alpha)
    }

    /// Width along the tangent, after the floor.
    pub fn alpha_x(&self) -> f64 {
        self.alpha_x
    }

    /// Width along the bitangent, after the floor.
    pub fn alpha_y(&self) -> f64 {
        self.alpha_y
    }

    /// Distribution of normals `D(wh) = 1 / (π αx αy (hx²/αx² + hy²/αy² + hz²)²)`, per steradian; 0 below the
    /// surface. `∫ D(wh) cos dwh = 1` over the hemisphere.
    pub fn ndf(&self, wh: DVec3) -> f64 {
        if wh.z <= 0.0 {
            return 0.0;
        }
        let stretched = dvec3(wh.x / self.alpha_x, wh.y / self.alpha_y, wh.z);
        let e = stretched.length_squared();
        1.0 / (PI * self.alpha_x * self.alpha_y * e * e)
    }

    /// Smith's `Λ(w) = (√(1 + (αx² wx² + αy² wy²) / wz²) - 1) / 2`; infinite at the horizon.
    pub fn lambda(&self, w: DVec3) -> f64 {
        0.5 * (self.projected(w) / w.z.abs() - 1.0)
    }

    /// Masking `G1(w) = 1 / (1 + Λ(w))`, 0 below the horizon.
    pub fn g1(&self, w: DVec3) -> f64 {
        if w.z <= 0.0 { 0.0 } else { 1.0 / (1.0 + self.lambda(w)) }
    }

    /// Height-correlated masking and shadowing `G2(wo, wi) = 1 / (1 + Λ(wo) + Λ(wi))`, 0 if either direction is
    /// below the horizon.
    pub fn g2(&self, wo: DVec3, wi: DVec3) -> f64 {
        if wo.z <= 0.0 || wi.z <= 0.0 { 0.0 } else { 1.0 / (1.0 + self.lambda(wo) + self.lambda(wi)) }
    }

    /// Cosine-weighted BRDF at F = 1, `D(wh) G2(wo, wi) / (4 cos θo)`, per steradian.
    ///
    /// Zero when either direction is below the horizon. With `s(w) = √(αx² wx² + αy² wy² + wz²)` the masking term
    /// is evaluated as `zi / (2 (s(wo) zi + s(wi) zo))`, which stays finite for a grazing `wo`.
    pub fn eval_cos(&self, wo: DVec3, wi: DVec3) -> f64 {
        if wo.z < 0.0 || wi.z <= 0.0 {
            return 0.0;
        }
        let Some(wh) = (wo + wi).try_normalize() else { return 0.0 };
        let masking = wi.z / (2.0 * (self.projected(wo) * wi.z + self.projected(wi) * wo.z));
        if masking.is_finite() { self.ndf(wh) * masking } else { 0.0 }
    }

    /// Schlick's weight `(1 - wo·wh)^5`: Fresnel is `F0 + (F90 - F0) · weight`.
    ///
    /// For unit vectors `wo·wh = |wo + wi| / 2`.
    pub fn fresnel_weight(&self, wo: DVec3, wi: DVec3) -> f64 {
        (1.0 - 0.5 * (wo + wi).length()).clamp(0.0, 1.0).powi(5)
    }

    /// Density of visible normals `G1(wo) max(0, wo·wh) D(wh) / cos θo`, per steradian of `wh`.
    /// Its integral over the hemisphere is 1 (the weak white furnace).
    pub fn vndf(&self, wo: DVec3, wh: DVec3) -> f64 {
        if wo.z < 0.0 {
            return 0.0;
        }
        2.0 / (wo.z + self.projected(wo)) * wo.dot(wh).max(0.0) * self.ndf(wh)
    }

    /// Draws a light direction by reflecting `wo` at a visible normal; returns it with its density per steradian.
    ///
    /// `u` is a point of [0, 1)². `None` when the reflection goes below the surface: such a sample counts as zero.
    /// Method: spherical caps, Dupuy and Benyoub 2023, "Sampling Visible GGX Normals with Spherical Caps".
    pub fn sample(&self, wo: DVec3, u: [f64; 2]) -> Option<(DVec3, f64)> {
        if wo.z < 0.0 {
            return None;
        }
        let stretched = dvec3(self.alpha_x * wo.x, self.alpha_y * wo.y, wo.z).try_normalize()?;
        // Where the microsurface is a hemisphere, its reflections of wo fill the cap z > -stretched.z uniformly.
        let height = (1.0 - u[1]) * (1.0 + stretched.z) - stretched.z;
        let radius = ((1.0 - height) * (1.0 + height)).max(0.0).sqrt();
        let (sin, cos) = (TAU * u[0]).sin_cos();
        let normal = dvec3(radius * cos, radius * sin, height) + stretched;
        let wh =
            dvec3(self.alpha_x * normal.x, self.alpha_y * normal.y, normal.z.max(0.0)).try_normalize()?;
        let wi = (2.0 * wo.dot(wh) * wh - wo).try_normalize()?;
        if wi.z <= 0.0 {
            return None;
        }
        Some((wi, self.pdf(wo, wi)))
    }

    /// Density per steradian of [`Ggx::sample`], `D(wh) G1(wo) / (4 cos θo)`; 0 for `wi` below the surface, so its
    /// integral is at most 1 (1 minus the probability of `None`).
    pub fn pdf(&self, wo: DVec3, wi: DVec3) -> f64 {
        if wo.z < 0.0 || wi.z <= 0.0 {
            return 0.0;
        }
        let Some(wh) = (wo + wi).try_normalize() else { return 0.0 };
        self.ndf(wh) / (2.0 * (wo.z + self.projected(wo)))
    }

    /// `√(αx² wx² + αy² wy² + wz²)`.
    fn projected(&self, w: DVec3) -> f64 {
        dvec3(self.alpha_x * w.x, self.alpha_y * w.y, w.z).length()
    }
}
