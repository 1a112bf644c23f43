//! Geometry in f64 whatever the precision of the input: where the side on which the shading point lies is decided.

use glam::DVec3;

use crate::{Real, Vector};

/// The vector in f64.
#[inline]
pub(super) fn widened<R: Real>(v: R::Vec3) -> DVec3 {
    DVec3::new(v.x().to_f64(), v.y().to_f64(), v.z().to_f64())
}

/// The vector rounded to the working precision.
#[inline]
pub(super) fn narrowed<R: Real>(v: DVec3) -> R::Vec3 {
    R::Vec3::new(R::of(v.x), R::of(v.y), R::of(v.z))
}

/// A factor, a power of two where there is one, that brings lengths up to `largest` to between 1 and 2; `None` for 0 and
/// where the factor is out of range.
#[inline]
pub(super) fn shrink(largest: f64) -> Option<f64> {
    // The bits of infinity are those of the exponent.
    let power = f64::from_bits(largest.to_bits() & f64::INFINITY.to_bits());
    let factor = if power > 0.0 { 1.0 / power } else { 1.0 / largest };
    factor.is_finite().then_some(factor)
}
