//! How a cylinder is seen from the origin.

use glam::DVec3;

use crate::Vector as _;
use crate::frame::tangent_to;
use crate::light::cone_light::ConeLight;
use crate::light::wide::shrink;

/// From where a cylinder is seen. Lengths are over the largest of its coordinates and its radius.
pub(super) enum View {
    /// It has no extent.
    Nothing,
    /// From inside or from the surface.
    Inside(Axis),
    /// From within the mantle's infinite continuation: only one end is seen. With the unit of length.
    InLine(End, f64),
    /// From beside it.
    Beside(Beside),
}

/// The axis of a cylinder.
#[derive(Clone, Copy)]
pub(super) struct Axis {
    /// Unit vector from the first end to the second.
    pub along: DVec3,
    /// From the shading point to the nearest point of the axis' line.
    pub offset: DVec3,
    /// Where the ends are along the axis; ascending.
    pub ends: [f64; 2],
    pub radius: f64,
    /// What the scaled unit of length is.
    pub unit: f64,
}

/// One end circle.
#[derive(Clone, Copy)]
pub(super) struct End {
    pub centre: DVec3,
    /// Half-axes at right angles; their product points away from the shading point.
    pub axes: [DVec3; 2],
}

impl End {
    pub fn disk(&self) -> ConeLight<f64> {
        ConeLight::new(self.centre, self.axes[0], self.axes[1])
    }
}

/// A cylinder seen from beside it, at a distance from its axis above its radius.
pub(super) struct Beside {
    pub axis: Axis,
    /// Distance of the axis' line.
    pub distance: f64,
    /// Unit vector towards it, and the one at right angles to it and the axis: along × towards.
    pub towards: DVec3,
    pub aside: DVec3,
    /// √(distance² − radius²): how far the generators are that are seen edge-on.
    pub tangent: f64,
    /// For each end its place along the axis and whether its outside faces the shading point.
    pub heights: [(f64, bool); 2],
}

impl View {
    /// In f64 whatever the precision of the light: from near the surface the difference of distance and radius decides, for a
    /// long cylinder that of its ends.
    pub fn of(ends: [DVec3; 2], radius: f64) -> Self {
        Self::of_scaled(ends, radius).unwrap_or(Self::Nothing)
    }

    fn of_scaled(ends: [DVec3; 2], radius: f64) -> Option<Self> {
        let factor = shrink(ends[0].abs().max(ends[1].abs()).max_element().max(radius))?;
        let (p, radius) = (ends.map(|p| p * factor), radius * factor);
        let along = (p[1] - p[0]).try_unit().filter(|_| radius > 0.0)?;
        // The nearer end loses less to cancellation.
        let nearer = if p[0].length_squared() <= p[1].length_squared() { p[0] } else { p[1] };
        let offset = nearer - along * nearer.dot(along);
        let ends = p.map(|p| p.dot(along));
        let distance = offset.length();
        let axis = Axis { along, offset, ends, radius, unit: 1.0 / factor };
        let facing = [ends[0] > 0.0, ends[1] < 0.0];
        if distance <= radius {
            let across = tangent_to::<f64>(along);
            return Some(match facing {
                [true, _] => Self::InLine(axis.end(ends[0], across), axis.unit),
                [_, true] => Self::InLine(axis.end(ends[1], across), axis.unit),
                _ => Self::Inside(axis),
            });
        }
        let towards = offset / distance;
        Some(Self::Beside(Beside {
            axis,
            distance,
            towards,
            aside: along.cross(towards),
            tangent: ((distance - radius) * (distance + radius)).sqrt(),
            heights: [(ends[0], facing[0]), (ends[1], facing[1])],
        }))
    }
}

impl Axis {
    fn end(&self, height: f64, across: DVec3) -> End {
        let (u, v) = (across * self.radius, self.along.cross(across) * self.radius);
        let axes = if height > 0.0 { [u, v] } else { [v, u] };
        End { centre: self.offset + self.along * height, axes }
    }
}

impl Beside {
    pub fn end(&self, height: f64) -> End {
        self.axis.end(height, self.towards)
    }

    /// How far the plane of both generators is.
    fn plane_distance(&self) -> f64 {
        self.tangent * (self.tangent / self.distance)
    }

    /// The corners of the rectangle between the generators, counter-clockwise about the direction towards it.
    pub fn rectangle(&self) -> [DVec3; 4] {
        let half_width = self.axis.radius * (self.tangent / self.distance);
        let [low, high] = self.axis.ends.map(|z| self.towards * self.plane_distance() + self.axis.along * z);
        let half = self.aside * half_width;
        [low - half, low + half, high + half, high - half]
    }

    /// The normal of the plane through the shading point that parts the end circle at this height where the generators meet
    /// it, towards its part beyond or the one on the near side.
    pub fn end_plane(&self, height: f64, beyond: bool) -> DVec3 {
        let normal = self.towards * height - self.axis.along * self.plane_distance();
        if (height > 0.0) == beyond { normal } else { -normal }
    }
}
