//! Lights as lines of `ltc integrate` have them.

use ltc_core::{AnyLight, Sides};
use serde::Deserialize;

/// A light, seen from the shading point at the origin in the shading frame.
#[derive(Clone, Debug, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
#[expect(missing_docs, reason = "the fields are those of `AnyLight`")]
pub enum LightLine {
    Polygon {
        vertices: Vec<[f64; 3]>,
        #[serde(default)]
        two_sided: bool,
    },
    Line {
        p0: [f64; 3],
        p1: [f64; 3],
        radius: f64,
    },
    Strip {
        p0: [f64; 3],
        p1: [f64; 3],
        width: f64,
        normal: [f64; 3],
        #[serde(default)]
        two_sided: bool,
    },
    Cylinder {
        p0: [f64; 3],
        p1: [f64; 3],
        radius: f64,
        #[serde(default)]
        caps: bool,
    },
    Disk {
        center: [f64; 3],
        normal: [f64; 3],
        radius: f64,
        #[serde(default)]
        two_sided: bool,
    },
    Ellipse {
        center: [f64; 3],
        axis_u: [f64; 3],
        axis_v: [f64; 3],
        #[serde(default)]
        two_sided: bool,
    },
    Sphere {
        center: [f64; 3],
        radius: f64,
    },
}

impl From<LightLine> for AnyLight {
    fn from(light: LightLine) -> Self {
        let sides = |two_sided| if two_sided { Sides::Two } else { Sides::One };
        match light {
            LightLine::Polygon { vertices, two_sided } => Self::Polygon { vertices, sides: sides(two_sided) },
            LightLine::Line { p0, p1, radius } => Self::Line { p0, p1, radius },
            LightLine::Strip { p0, p1, width, normal, two_sided } => {
                Self::Strip { p0, p1, width, normal, sides: sides(two_sided) }
            }
            LightLine::Cylinder { p0, p1, radius, caps } => Self::Cylinder { p0, p1, radius, caps },
            LightLine::Disk { center, normal, radius, two_sided } => {
                Self::Disk { center, normal, radius, sides: sides(two_sided) }
            }
            LightLine::Ellipse { center, axis_u, axis_v, two_sided } => {
                Self::Ellipse { center, axis_u, axis_v, sides: sides(two_sided) }
            }
            LightLine::Sphere { center, radius } => Self::Sphere { center, radius },
        }
    }
}
