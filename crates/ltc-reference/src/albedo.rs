//! Directional albedo of GGX: how much of the light from all directions reaches the eye.

use glam::DVec3;

use crate::error::ReferenceError;
use crate::ggx::Ggx;
use crate::lobe::{GgxLobe, Lobe};
use crate::mass::lobe_mass;
use crate::quadrature::{Estimate, Tolerance};
use crate::sphere::integrate_sphere;

/// How far the length of a unit vector may be from 1.
const UNIT_SLACK: f64 = 1e-6;
/// Magnitude and Fresnel integral of a lobe; shaded reflectance is `F0 · n + (F90 - F0) · f`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Albedo {
    /// `n = ∫ ρ cos θi dwi` at F = 1.
    pub magnitude: Estimate,
    /// `f = ∫ (1 - wo·wh)^5 ρ cos θi dwi`.
    pub fresnel: Estimate,
}

/// Directional albedo of GGX seen from the unit direction `wo`.
///
/// Adaptive cubature over the hemisphere, its boxes placed by samples of visible normals and cut at the horizon, keeps
/// the tolerance for each of the two. 1e-6 absolute takes some ten milliseconds; within 1e-4 of grazing, narrow lobes
/// (α < 0.01) take up to half a second, and 1e-10 is out of reach there. Zero for `wo` below the horizon.
///
/// # Errors
/// [`ReferenceError::NonFiniteInput`], [`ReferenceError::NotUnit`], [`ReferenceError::NotConverged`].
pub fn directional_albedo(ggx: &Ggx, wo: DVec3, tolerance: Tolerance) -> Result<Albedo, ReferenceError> {
    check_unit("wo", wo)?;
    let lobe = GgxLobe { ggx: *ggx, wo };
    let fresnel = |w: DVec3| lobe.density(w) * ggx.fresnel_weight(wo, w);
    Ok(Albedo {
        magnitude: lobe_mass(&lobe, tolerance)?,
        fresnel: integrate_sphere(fresnel, &lobe.kinks(), &lobe.hints(), tolerance)?,
    })
}

/// Is `w` a unit vector?
pub(crate) fn check_unit(what: &'static str, w: DVec3) -> Result<(), ReferenceError> {
    if !w.is_finite() {
        return Err(ReferenceError::NonFiniteInput { what });
    }
    let length = w.length();
    if (length - 1.0).abs() > UNIT_SLACK { Err(ReferenceError::NotUnit { what, length }) } else { Ok(()) }
}
