//! On which side of a flat light the shading point is.

use glam::DVec3;

use super::Sides;
use super::wide::{shrink, widened};
use crate::Real;

/// Three vectors in f64 over a common power of two.
#[inline]
fn scaled<R: Real>(vectors: [R::Vec3; 3]) -> Option<[DVec3; 3]> {
    let wide = vectors.map(widened::<R>);
    let largest = wide.iter().fold(0.0_f64, |m, v| m.max(v.abs().max_element()));
    let factor = shrink(largest)?;
    Some(wide.map(|v| v * factor))
}

/// Which side of a flat light is seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Seen {
    /// The one that its normal points to.
    Front,
    /// The other one, of a light that emits there, too.
    Back,
}

/// How a flat light is seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Facing {
    pub side: Seen,
    /// So nearly edge-on that the input's precision would not do for what follows.
    pub is_grazing: bool,
}

/// From which side the origin sees a light through `point` that faces along `u × v`, if at all.
///
/// Never from its own plane: where the rounding of f64 decides the side, the light is edge-on. That is judged component by
/// component: a light that lies along the axes may be as close to the shading point as it likes.
#[inline]
pub(super) fn side_of_span<R: Real>(point: R::Vec3, u: R::Vec3, v: R::Vec3, sides: Sides) -> Option<Facing> {
    let [p, u, v] = scaled::<R>([point, u, v])?;
    let (a, b) = (u.abs(), v.abs());
    let magnitude =
        DVec3::new(a.y * b.z + a.z * b.y, a.z * b.x + a.x * b.z, a.x * b.y + a.y * b.x).dot(p.abs());
    side::<R>(u.cross(v).dot(p), magnitude, sides)
}

/// The same for a light that faces along `normal`.
#[inline]
pub(super) fn side_of_normal<R: Real>(point: R::Vec3, normal: R::Vec3, sides: Sides) -> Option<Facing> {
    let [p, n, _] = scaled::<R>([point, normal, normal])?;
    side::<R>(n.dot(p), n.abs().dot(p.abs()), sides)
}

/// From a product that is positive behind the light, and the sum of the magnitudes of its terms.
#[inline]
fn side<R: Real>(behind: f64, magnitude: f64, sides: Sides) -> Option<Facing> {
    let rounding = magnitude * (8.0 * f64::EPSILON);
    let side = if behind < -rounding {
        Seen::Front
    } else if behind > rounding && sides == Sides::Two {
        Seen::Back
    } else {
        return None;
    };
    let is_narrow = R::EPSILON.to_f64() > f64::EPSILON;
    let is_grazing = is_narrow && behind.abs() < GRAZING * R::EPSILON.to_f64() * magnitude;
    Some(Facing { side, is_grazing })
}

/// Axes rounded to the input's precision turn the light by an ε; that is to be a small part of how far it is from edge-on.
const GRAZING: f64 = 4096.0;
