//! The plane of a flat light.

use super::{Polygon, Sides};
use crate::{Real, Vector};

/// The plane of a polygon that the shading point sees, in coordinates scaled by `shrink` to an extent of 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Plane<R: Real> {
    /// What scales the polygon's largest coordinate to 1.
    pub shrink: R,
    /// Unit normal; the polygon winds counter-clockwise about it.
    pub normal: R::Vec3,
    /// Of the plane above the shading point, along the normal. Below 0 where the shading point is in front of it.
    pub height: R,
}

impl<R: Real> Plane<R> {
    /// `None` for a polygon without area, for one that is seen edge-on or from behind.
    ///
    /// Newell's vector area, taken about the first vertex so that distant lights keep their digits. A height within 8 ε
    /// of the extent is rounding: the light is then seen edge-on.
    pub fn seen(polygon: &Polygon<'_, R>) -> Option<Self> {
        let vertices = polygon.vertices();
        let scale = vertices.iter().fold(R::ZERO, |m, v| m.max(v.max_abs()));
        let shrink = R::ONE / scale;
        if scale <= R::ZERO || !shrink.is_finite() {
            return None;
        }
        let first = vertices[0] * shrink;
        let mut area = R::Vec3::new(R::ZERO, R::ZERO, R::ZERO);
        for pair in vertices[1..].windows(2) {
            area += (pair[0] * shrink - first).cross(pair[1] * shrink - first);
        }
        let normal = area.try_unit()?;
        let height = normal.dot(first);
        let visible = match polygon.sides() {
            Sides::One => height < R::ZERO,
            Sides::Two => true,
        };
        (visible && height.abs() > R::of(8.0) * R::EPSILON).then_some(Self { shrink, normal, height })
    }
}
