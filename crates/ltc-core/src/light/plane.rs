//! The plane of a flat light.

use glam::DVec3;

use super::boundary::{power_of_two_near_reciprocal, widen};
use super::{Polygon, Sides};
use crate::{Real, Vector};

/// The plane of a polygon, in coordinates scaled by `shrink` to an extent between ½ and 1.
///
/// In f64 for lights in f32, too: the products of their coordinates are then exact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Plane {
    /// A power of two, so that scaling by it rounds nothing.
    pub shrink: f64,
    /// Unit normal; the polygon winds counter-clockwise about it.
    pub normal: DVec3,
    /// Of the plane above the shading point, along the normal. Below 0 where the shading point is in front of it.
    pub height: f64,
}

impl Plane {
    /// The plane of a polygon that is to be seen: not of one without area, edge-on or from behind.
    pub fn seen<R: Real>(polygon: &Polygon<'_, R>) -> Option<Self> {
        Self::of(polygon).filter(|plane| plane.shows(polygon.sides()))
    }

    /// Whether the shading point sees an emitting side. A height within 16 ε of the extent is rounding, the light then seen
    /// edge-on.
    pub fn shows(&self, sides: Sides) -> bool {
        self.height.abs() > 16.0 * f64::EPSILON && (sides == Sides::Two || self.height < 0.0)
    }

    /// `None` for a polygon without area, or with one of 2 ε of the products of sides that it is the sum of: its plane is
    /// then anyone's guess.
    pub fn of<R: Real>(polygon: &Polygon<'_, R>) -> Option<Self> {
        let vertices = polygon.vertices();
        let extent = vertices.iter().fold(0.0, |m: f64, v| m.max(v.max_abs().to_f64()));
        let shrink = power_of_two_near_reciprocal(extent);
        // Newell's vector area, taken about the first vertex so that distant lights keep their digits.
        let first = widen::<R>(vertices[0]) * shrink;
        let (mut area, mut products, mut longest) = (DVec3::ZERO, 0.0, DVec3::ZERO);
        for pair in vertices[1..].windows(2) {
            let [a, b] = [pair[0], pair[1]].map(|v| widen::<R>(v) * shrink - first);
            area += a.cross(b);
            products += a.length() * b.length();
            for side in [a, b] {
                if side.length_squared() > longest.length_squared() {
                    longest = side;
                }
            }
        }
        if area.length() <= 2.0 * f64::EPSILON * products {
            return None;
        }
        // Of a thin polygon the cross products lose the digits along its length: the normal is made orthogonal to that.
        let rough = area.try_unit()?;
        let normal = (rough - longest * (rough.dot(longest) / longest.length_squared())).try_unit()?;
        Some(Self { shrink, normal, height: normal.dot(first) })
    }
}
