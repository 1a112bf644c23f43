//! The whole mass of a lobe.

use crate::error::ReferenceError;
use crate::lobe::Lobe;
use crate::quadrature::{Estimate, Tolerance};
use crate::sphere::integrate_sphere;

/// `∫ density(w) dw` over the sphere: 1 for a normalised lobe, the magnitude for GGX. For an LTC in
/// [`crate::AboveHorizon`] it is 1 minus the leak.
///
/// # Errors
/// [`ReferenceError::NonFiniteIntegrand`], [`ReferenceError::NotConverged`].
pub fn lobe_mass(lobe: &impl Lobe, tolerance: Tolerance) -> Result<Estimate, ReferenceError> {
    integrate_sphere(|w| lobe.density(w), &lobe.kinks(), &lobe.hints(), tolerance)
}
