//! Total variation distance between lobes: the largest error, as a fraction of the energy, that any light can suffer.

use glam::DVec3;

use crate::albedo::{check_unit, directional_albedo};
use crate::error::ReferenceError;
use crate::ggx::Ggx;
use crate::lobe::{GgxLobe, Lobe, Scaled};
use crate::quadrature::{Estimate, Tolerance};
use crate::sphere::integrate_sphere;

/// `TV(p, q) = ½ ∫ |p - q| dw` over the whole sphere, for two normalised lobes.
///
/// Adaptive cubature on the eight octants of the sphere, its boxes placed around the mass of both lobes. No sample of
/// either lobe is weighted, so this is independent of the estimator `E_p[max(0, 1 - q/p)]`. The ridge where p = q costs
/// most: 1e-4 takes some twenty milliseconds.
///
/// # Errors
/// [`ReferenceError::NonFiniteIntegrand`], [`ReferenceError::NotConverged`].
pub fn total_variation(
    p: &impl Lobe,
    q: &impl Lobe,
    tolerance: Tolerance,
) -> Result<Estimate, ReferenceError> {
    let hints: Vec<DVec3> = p.hints().into_iter().chain(q.hints()).collect();
    let kinks: Vec<DVec3> = p.kinks().into_iter().chain(q.kinks()).collect();
    integrate_sphere(|w| 0.5 * (p.density(w) - q.density(w)).abs(), &kinks, &hints, tolerance)
}

/// Total variation between the GGX lobe seen from `wo`, normalised by its magnitude, and a normalised lobe `q`.
///
/// # Errors
/// As [`total_variation`], and [`ReferenceError::NonFiniteInput`] or [`ReferenceError::NotUnit`] for a bad `wo`.
pub fn ggx_total_variation(
    ggx: &Ggx,
    wo: DVec3,
    q: &impl Lobe,
    tolerance: Tolerance,
) -> Result<Estimate, ReferenceError> {
    check_unit("wo", wo)?;
    let tenth = Tolerance { absolute: 0.1 * tolerance.absolute, ..tolerance };
    let magnitude = directional_albedo(ggx, wo, tenth)?.magnitude.value;
    // Below the horizon there is no lobe; every light then suffers the whole error.
    if magnitude <= 0.0 {
        return Ok(Estimate { value: 1.0, ..Estimate::default() });
    }
    let p = Scaled { lobe: GgxLobe { ggx: *ggx, wo }, factor: 1.0 / magnitude };
    total_variation(&p, q, tolerance)
}
