//! How a cylinder is seen from the origin.

use super::super::cone_light::ConeLight;
use crate::frame::tangent_to;
use crate::{Real, Vector};

/// From where a cylinder is seen. Lengths are over the largest of its coordinates and its radius.
pub(super) enum View<R: Real> {
    /// It has no extent.
    Nothing,
    /// From inside or from the surface.
    Inside(Axis<R>),
    /// From within the mantle's infinite continuation: only one end is seen.
    InLine(End<R>),
    /// From beside it.
    Beside(Beside<R>),
}

/// The axis of a cylinder.
#[derive(Clone, Copy)]
pub(super) struct Axis<R: Real> {
    /// Unit vector from the first end to the second.
    pub along: R::Vec3,
    /// From the shading point to the nearest point of the axis' line.
    pub offset: R::Vec3,
    /// Where the ends are along the axis; ascending.
    pub ends: [R; 2],
    pub radius: R,
    /// What the scaled unit of length is.
    pub unit: R,
}

/// One end circle.
#[derive(Clone, Copy)]
pub(super) struct End<R: Real> {
    pub centre: R::Vec3,
    /// Half-axes at right angles.
    pub axes: [R::Vec3; 2],
}

impl<R: Real> End<R> {
    pub fn disk(&self) -> ConeLight<R> {
        ConeLight::new(self.centre, self.axes[0], self.axes[1])
    }
}

/// A cylinder seen from beside it, at a distance from its axis above its radius.
pub(super) struct Beside<R: Real> {
    pub axis: Axis<R>,
    /// Distance of the axis' line.
    pub distance: R,
    /// Unit vector towards it, and the one at right angles to it and the axis: along × towards.
    pub towards: R::Vec3,
    pub aside: R::Vec3,
    /// √(distance² − radius²): how far the generators are that are seen edge-on.
    pub tangent: R,
    /// For each end its place along the axis and whether its outside faces the shading point.
    pub heights: [(R, bool); 2],
}

impl<R: Real> View<R> {
    pub fn of(ends: [R::Vec3; 2], radius: R) -> Self {
        let unit = ends[0].max_abs().max(ends[1].max_abs()).max(radius);
        let shrink = R::ONE / unit;
        let (p, radius) = (ends.map(|p| p * shrink), radius * shrink);
        let along = if shrink.is_finite() { (p[1] - p[0]).try_unit() } else { None };
        let (Some(along), true) = (along, radius > R::ZERO) else { return Self::Nothing };
        // The nearer end loses less to cancellation.
        let nearer = if p[0].dot(p[0]) <= p[1].dot(p[1]) { p[0] } else { p[1] };
        let offset = nearer - along * nearer.dot(along);
        let ends = p.map(|p| p.dot(along));
        let distance = offset.length();
        let axis = Axis { along, offset, ends, radius, unit };
        if distance <= radius {
            return match (ends[0] > R::ZERO, ends[1] < R::ZERO) {
                (true, _) => Self::InLine(axis.end(ends[0], tangent_to::<R>(along))),
                (_, true) => Self::InLine(axis.end(ends[1], tangent_to::<R>(along))),
                _ => Self::Inside(axis),
            };
        }
        let towards = offset * (R::ONE / distance);
        let tangent = ((distance - radius) * (distance + radius)).sqrt();
        let heights = [(ends[0], ends[0] > R::ZERO), (ends[1], ends[1] < R::ZERO)];
        Self::Beside(Beside { axis, distance, towards, aside: along.cross(towards), tangent, heights })
    }
}

impl<R: Real> Axis<R> {
    fn end(&self, height: R, across: R::Vec3) -> End<R> {
        let centre = self.offset + self.along * height;
        End { centre, axes: [across, self.along.cross(across)].map(|axis| axis * self.radius) }
    }
}

impl<R: Real> Beside<R> {
    pub fn end(&self, height: R) -> End<R> {
        self.axis.end(height, self.towards)
    }

    /// How far the plane of both generators is.
    fn plane_distance(&self) -> R {
        self.tangent * (self.tangent / self.distance)
    }

    /// The corners of the rectangle between the generators, counter-clockwise about the direction towards it.
    pub fn rectangle(&self) -> [R::Vec3; 4] {
        let half_width = self.axis.radius * (self.tangent / self.distance);
        let [low, high] = self.axis.ends.map(|z| self.towards * self.plane_distance() + self.axis.along * z);
        let half = self.aside * half_width;
        [low - half, low + half, high + half, high - half]
    }

    /// The normal of the plane through the shading point that parts the end circle at this height where the generators meet
    /// it, towards its part beyond or the one on the near side.
    pub fn end_plane(&self, height: R, beyond: bool) -> R::Vec3 {
        let normal = self.towards * height - self.axis.along * self.plane_distance();
        if (height > R::ZERO) == beyond { normal } else { -normal }
    }
}
