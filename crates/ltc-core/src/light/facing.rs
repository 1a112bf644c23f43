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

/// From which side the origin sees a light through `point` that faces along `u × v`, if at all.
///
/// Never from its own plane: where the rounding of the input to its precision decides the side, the light is edge-on. That is
/// judged component by component: a light that lies along the axes may be as close to the shading point as it likes.
#[inline]
pub(super) fn side_of_span<R: Real>(point: R::Vec3, u: R::Vec3, v: R::Vec3, sides: Sides) -> Option<Seen> {
    let [p, u, v] = scaled::<R>([point, u, v])?;
    let (a, b) = (u.abs(), v.abs());
    let magnitude =
        DVec3::new(a.y * b.z + a.z * b.y, a.z * b.x + a.x * b.z, a.x * b.y + a.y * b.x).dot(p.abs());
    side::<R>(u.cross(v).dot(p), magnitude, sides)
}

/// The same for a light that faces along `normal`.
#[inline]
pub(super) fn side_of_normal<R: Real>(point: R::Vec3, normal: R::Vec3, sides: Sides) -> Option<Seen> {
    let [p, n, _] = scaled::<R>([point, normal, normal])?;
    side::<R>(n.dot(p), n.abs().dot(p.abs()), sides)
}

/// From a product that is positive behind the light, and the sum of the magnitudes of its terms.
#[inline]
fn side<R: Real>(behind: f64, magnitude: f64, sides: Sides) -> Option<Seen> {
    // Three factors rounded to half an ε at random; and what evaluating the product in f64 adds.
    let rounding = magnitude * (R::EPSILON.to_f64() * ROUNDING + 3.0 * f64::EPSILON);
    if behind < -rounding {
        Some(Seen::Front)
    } else if behind > rounding && sides == Sides::Two {
        Some(Seen::Back)
    } else {
        None
    }
}

/// How many ε of the input's precision rounding can move the product: 1.5 at worst, rarely above this.
const ROUNDING: f64 = 0.75;
