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
/// Never from its own plane: where rounding decides the side the light is edge-on. Rounding to f32 is judged component by
/// component: for a light that lies along the axes it decides nothing, however close the light is.
#[inline]
pub(super) fn side_of_span<R: Real>(point: R::Vec3, u: R::Vec3, v: R::Vec3, sides: Sides) -> Option<Seen> {
    let [p, u, v] = scaled::<R>([point, u, v])?;
    let (a, b) = (u.abs(), v.abs());
    let terms = DVec3::new(a.y * b.z + a.z * b.y, a.z * b.x + a.x * b.z, a.x * b.y + a.y * b.x);
    side::<R>(p, u.cross(v), terms, sides)
}

/// The same for a light that faces along `normal`.
#[inline]
pub(super) fn side_of_normal<R: Real>(point: R::Vec3, normal: R::Vec3, sides: Sides) -> Option<Seen> {
    let [p, n, _] = scaled::<R>([point, normal, normal])?;
    side::<R>(p, n, n.abs(), sides)
}

/// How many ε of its own precision the input's rounding moves a product of its components: 1.5 at worst, hardly ever above
/// this.
const INPUT_ROUNDING: f64 = 0.75;
/// How many ε of f64, times the product of the lengths, whatever computed the input has left of a right angle.
const COMPUTED_ROUNDING: f64 = 8.0;

/// From a point of the light, its normal, and the sum of magnitudes behind each component of that.
#[inline]
fn side<R: Real>(point: DVec3, normal: DVec3, terms: DVec3, sides: Sides) -> Option<Seen> {
    let behind = normal.dot(point);
    let rounding = INPUT_ROUNDING * R::EPSILON.to_f64() * terms.dot(point.abs())
        + COMPUTED_ROUNDING * f64::EPSILON * (terms.length_squared() * point.length_squared()).sqrt();
    if behind < -rounding {
        Some(Seen::Front)
    } else if behind > rounding && sides == Sides::Two {
        Some(Seen::Back)
    } else {
        None
    }
}
