//! The lights, by shape.

use glam::DVec3;
use ltc_core::{AnyLight, Sides};

/// A shape of light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// A rectangle, as a polygon of four vertices.
    Polygon,
    /// The same, as a quad.
    Quad,
    /// A thin tube by the line approximation.
    Line,
    /// A thin rectangle by the line approximation.
    Strip,
    /// The true silhouette of a tube without caps.
    Tube,
    /// The true silhouette of a tube with caps.
    Cylinder,
    /// A disk.
    Disk,
    /// An ellipse.
    Ellipse,
    /// A sphere.
    Sphere,
}

/// Where a light is and how it lies.
#[derive(Clone, Copy, Debug)]
pub struct Pose {
    /// Its centre.
    pub centre: DVec3,
    /// Its long axis, a unit vector.
    pub along: DVec3,
    /// Its normal, a unit vector perpendicular to it.
    pub normal: DVec3,
    /// Half its length.
    pub length: f64,
    /// Half its width.
    pub width: f64,
}

impl Form {
    /// All of them.
    pub const ALL: [Self; 9] = [
        Self::Polygon,
        Self::Quad,
        Self::Line,
        Self::Strip,
        Self::Tube,
        Self::Cylinder,
        Self::Disk,
        Self::Ellipse,
        Self::Sphere,
    ];

    /// Its name in tables and plots.
    pub fn name(self) -> &'static str {
        match self {
            Self::Polygon => "polygon",
            Self::Quad => "quad",
            Self::Line => "line",
            Self::Strip => "strip",
            Self::Tube => "tube",
            Self::Cylinder => "cylinder",
            Self::Disk => "disk",
            Self::Ellipse => "ellipse",
            Self::Sphere => "sphere",
        }
    }

    /// Whether it has a thickness in the direction of its normal: its half-width.
    pub fn is_solid(self) -> bool {
        matches!(self, Self::Line | Self::Tube | Self::Cylinder | Self::Sphere)
    }

    /// Half of its extent along the normal.
    pub fn thickness(self, pose: &Pose) -> f64 {
        match self {
            Self::Sphere => pose.length,
            _ if self.is_solid() => pose.width,
            _ => 0.0,
        }
    }

    /// A light of this shape.
    pub fn light(self, pose: &Pose) -> AnyLight {
        let Pose { centre, along, normal, length, width } = *pose;
        let (u, v) = (along * length, normal.cross(along) * width);
        let (p0, p1) = ((centre - u).to_array(), (centre + u).to_array());
        let (center, normal, sides) = (centre.to_array(), normal.to_array(), Sides::Two);
        match self {
            Self::Polygon | Self::Quad => {
                let corners = [centre - u - v, centre + u - v, centre + u + v, centre - u + v];
                AnyLight::Polygon { vertices: corners.map(|p| p.to_array()).to_vec(), sides }
            }
            Self::Line => AnyLight::Line { p0, p1, radius: width },
            Self::Strip => AnyLight::Strip { p0, p1, width: 2.0 * width, normal, sides },
            Self::Tube | Self::Cylinder => {
                AnyLight::Cylinder { p0, p1, radius: width, caps: self == Self::Cylinder }
            }
            Self::Disk => AnyLight::Disk { center, normal, radius: length, sides },
            Self::Ellipse => AnyLight::Ellipse { center, axis_u: u.to_array(), axis_v: v.to_array(), sides },
            Self::Sphere => AnyLight::Sphere { center, radius: length },
        }
    }
}
