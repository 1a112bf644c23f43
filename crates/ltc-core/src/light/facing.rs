//! On which side of a flat light the shading point is.

use super::Sides;
use crate::{Real, Vector};

/// A vector and, for each component, the sum of the magnitudes that went into it.
pub(super) struct Normal<R: Real> {
    pub vector: R::Vec3,
    pub magnitude: R::Vec3,
}

impl<R: Real> Normal<R> {
    /// A normal that was given, not computed.
    #[inline]
    pub fn given(vector: R::Vec3) -> Self {
        let magnitude = R::Vec3::new(vector.x().abs(), vector.y().abs(), vector.z().abs());
        Self { vector, magnitude }
    }

    /// `u × v`
    #[inline]
    pub fn of_span(u: R::Vec3, v: R::Vec3) -> Self {
        let sum = |a: R, b: R, c: R, d: R| (a * b).abs() + (c * d).abs();
        let magnitude = R::Vec3::new(
            sum(u.y(), v.z(), u.z(), v.y()),
            sum(u.z(), v.x(), u.x(), v.z()),
            sum(u.x(), v.y(), u.y(), v.x()),
        );
        Self { vector: u.cross(v), magnitude }
    }

    /// Whether a light through `point` that faces along the normal is seen from the origin.
    ///
    /// Never from its own plane: where rounding, of the input or in here, decides the side, the light is seen edge-on. That
    /// is judged component by component, so that a light that lies along the axes may be as close as it likes.
    #[inline]
    pub fn is_seen(&self, point: R::Vec3, sides: Sides) -> bool {
        let p = R::Vec3::new(point.x().abs(), point.y().abs(), point.z().abs());
        let rounding = R::of(4.0) * R::EPSILON * self.magnitude.dot(p);
        let behind = self.vector.dot(point);
        match sides {
            Sides::One => behind < -rounding,
            Sides::Two => behind.abs() > rounding,
        }
    }
}
