//! Lights.

use std::path::Path;

use glam::DVec3;
use ltc_core::{AnyLight, Sides};
use serde::{Deserialize, Serialize};

use crate::emitter::Emitter;
use crate::texture_map::TextureMap;
use crate::validate::{color, direction, length, problem, range, vector};
use crate::{SceneError, Texture};

/// The largest intensity, and the largest channel of a colour: products stay far within `f32`.
const BRIGHTEST: f64 = 1e9;

/// A light. Each emits the same radiance in all directions: `color` (linear RGB, each channel at least 0) times `intensity`,
/// in W/(m²·sr) or nits. It looks as bright from any distance; its power grows with its area.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
pub enum Light {
    /// A rectangle that emits the same radiance in all directions.
    Rectangle(Rectangle),
    /// A flat polygon of any simple outline.
    Polygon {
        /// Three or more, counter-clockwise seen from the emitting side.
        vertices: Vec<[f64; 3]>,
        /// See [`Light`].
        #[serde(default = "white")]
        color: [f64; 3],
        /// See [`Light`].
        intensity: f64,
        /// Whether the back emits, too.
        #[serde(default)]
        two_sided: bool,
        /// What multiplies the radiance; its `frame` says where it lies.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        texture: Option<Texture>,
    },
    /// A thin tube without caps, by the line approximation; the reference knows the true tube.
    Line {
        /// One end of its middle line.
        p0: [f64; 3],
        /// The other.
        p1: [f64; 3],
        /// Above 0.
        radius: f64,
        /// See [`Light`].
        #[serde(default = "white")]
        color: [f64; 3],
        /// See [`Light`].
        intensity: f64,
    },
    /// A thin rectangle, by the line approximation; the reference knows the true rectangle.
    Strip {
        /// One end of its middle line.
        p0: [f64; 3],
        /// The other.
        p1: [f64; 3],
        /// From edge to edge, above 0.
        width: f64,
        /// Where its front points; its part along the line is dropped.
        normal: [f64; 3],
        /// See [`Light`].
        #[serde(default = "white")]
        color: [f64; 3],
        /// See [`Light`].
        intensity: f64,
        /// Whether the back emits, too.
        #[serde(default)]
        two_sided: bool,
    },
    /// A round cylinder of any width.
    Cylinder {
        /// The middle of one end.
        p0: [f64; 3],
        /// The middle of the other.
        p1: [f64; 3],
        /// Above 0.
        radius: f64,
        /// Whether it is closed by emitting caps.
        #[serde(default)]
        caps: bool,
        /// See [`Light`].
        #[serde(default = "white")]
        color: [f64; 3],
        /// See [`Light`].
        intensity: f64,
    },
    /// A flat disk.
    Disk {
        /// Its middle.
        center: [f64; 3],
        /// Where its front points.
        normal: [f64; 3],
        /// Above 0.
        radius: f64,
        /// See [`Light`].
        #[serde(default = "white")]
        color: [f64; 3],
        /// See [`Light`].
        intensity: f64,
        /// Whether the back emits, too.
        #[serde(default)]
        two_sided: bool,
    },
    /// A flat ellipse `center + axis_u cos t + axis_v sin t`; its front is where `axis_u × axis_v` points.
    Ellipse {
        /// Its middle.
        center: [f64; 3],
        /// A half-axis.
        axis_u: [f64; 3],
        /// One conjugate to it.
        axis_v: [f64; 3],
        /// See [`Light`].
        #[serde(default = "white")]
        color: [f64; 3],
        /// See [`Light`].
        intensity: f64,
        /// Whether the back emits, too.
        #[serde(default)]
        two_sided: bool,
    },
    /// A sphere; it emits inwards, too.
    Sphere {
        /// Its middle.
        center: [f64; 3],
        /// Above 0.
        radius: f64,
        /// See [`Light`].
        #[serde(default = "white")]
        color: [f64; 3],
        /// See [`Light`].
        intensity: f64,
    },
}

/// A rectangular light, given either by `center`, `half_u` and `half_v`, or by `corners`.
///
/// It emits on the side of `half_u × half_v`, from which the corners run counter-clockwise. From behind, a one-sided light
/// is not seen: it neither emits nor hides what is behind it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rectangle {
    /// The middle.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub center: Option<[f64; 3]>,
    /// From the middle to the middle of one side.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub half_u: Option<[f64; 3]>,
    /// From the middle to the middle of the next side.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub half_v: Option<[f64; 3]>,
    /// The four corners of a rectangle or parallelogram, counter-clockwise seen from the emitting side.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub corners: Option<[[f64; 3]; 4]>,
    /// Linear RGB, each channel at least 0.
    #[serde(default = "white")]
    pub color: [f64; 3],
    /// Times `color`, the emitted radiance: W/(m²·sr) or nits. The light looks as bright from any distance; its power
    /// grows with its area.
    pub intensity: f64,
    /// Whether the back emits, too.
    #[serde(default)]
    pub two_sided: bool,
    /// What multiplies the radiance; it fills the rectangle.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub texture: Option<Texture>,
}

impl Light {
    /// `field` is the path of the light in the scene, for errors; files of textures are relative to `folder`.
    pub(crate) fn resolve(&self, field: &str, folder: &Path) -> Result<Emitter, SceneError> {
        let shape = self.shape(field)?;
        let texture = self.texture(&shape, &format!("{field}.texture"), folder)?;
        let (colour, intensity) = self.strength();
        let colour = color(&format!("{field}.color"), colour, BRIGHTEST)?;
        let intensity = range(&format!("{field}.intensity"), intensity, 0.0, BRIGHTEST)?;
        Emitter::new(shape, colour * intensity, texture).map_err(|reason| problem(field, reason))
    }

    fn texture(
        &self,
        shape: &AnyLight,
        field: &str,
        folder: &Path,
    ) -> Result<Option<TextureMap>, SceneError> {
        let AnyLight::Polygon { vertices, .. } = shape else { return Ok(None) };
        let vertices: Vec<DVec3> = vertices.iter().map(|v| DVec3::from_array(*v)).collect();
        match (self, vertices.as_slice()) {
            (Self::Rectangle(Rectangle { texture: Some(texture), .. }), &[a, b, c, d]) => {
                texture.on_rectangle(&[a, b, c, d], field, folder).map(Some)
            }
            (Self::Polygon { texture: Some(texture), .. }, vertices) => {
                texture.on_polygon(vertices, field, folder).map(Some)
            }
            _ => Ok(None),
        }
    }

    fn strength(&self) -> ([f64; 3], f64) {
        match self {
            Self::Rectangle(Rectangle { color, intensity, .. })
            | Self::Polygon { color, intensity, .. }
            | Self::Line { color, intensity, .. }
            | Self::Strip { color, intensity, .. }
            | Self::Cylinder { color, intensity, .. }
            | Self::Disk { color, intensity, .. }
            | Self::Ellipse { color, intensity, .. }
            | Self::Sphere { color, intensity, .. } => (*color, *intensity),
        }
    }

    /// In world space.
    fn shape(&self, field: &str) -> Result<AnyLight, SceneError> {
        let at = |name: &str| format!("{field}.{name}");
        let point = |name: &str, v: &[f64; 3]| vector(&at(name), *v).map(|v| v.to_array());
        let sides = |two_sided: bool| if two_sided { Sides::Two } else { Sides::One };
        Ok(match self {
            Self::Rectangle(rectangle) => {
                let vertices = rectangle.corners(field)?.map(|c| c.to_array()).to_vec();
                AnyLight::Polygon { vertices, sides: sides(rectangle.two_sided) }
            }
            Self::Polygon { vertices, two_sided, .. } => {
                let corner = |(i, v): (usize, &[f64; 3])| point(&format!("vertices[{i}]"), v);
                let vertices = vertices.iter().enumerate().map(corner).collect::<Result<Vec<_>, _>>()?;
                AnyLight::Polygon { vertices, sides: sides(*two_sided) }
            }
            Self::Line { p0, p1, radius, .. } => AnyLight::Line {
                p0: point("p0", p0)?,
                p1: point("p1", p1)?,
                radius: length(&at("radius"), *radius)?,
            },
            Self::Strip { p0, p1, width, normal, two_sided, .. } => AnyLight::Strip {
                p0: point("p0", p0)?,
                p1: point("p1", p1)?,
                width: length(&at("width"), *width)?,
                normal: direction(&at("normal"), *normal)?.to_array(),
                sides: sides(*two_sided),
            },
            Self::Cylinder { p0, p1, radius, caps, .. } => AnyLight::Cylinder {
                p0: point("p0", p0)?,
                p1: point("p1", p1)?,
                radius: length(&at("radius"), *radius)?,
                caps: *caps,
            },
            Self::Disk { center, normal, radius, two_sided, .. } => AnyLight::Disk {
                center: point("center", center)?,
                normal: direction(&at("normal"), *normal)?.to_array(),
                radius: length(&at("radius"), *radius)?,
                sides: sides(*two_sided),
            },
            Self::Ellipse { center, axis_u, axis_v, two_sided, .. } => AnyLight::Ellipse {
                center: point("center", center)?,
                axis_u: point("axis_u", axis_u)?,
                axis_v: point("axis_v", axis_v)?,
                sides: sides(*two_sided),
            },
            Self::Sphere { center, radius, .. } => {
                AnyLight::Sphere { center: point("center", center)?, radius: length(&at("radius"), *radius)? }
            }
        })
    }
}

fn white() -> [f64; 3] {
    [1.0; 3]
}

impl Rectangle {
    fn corners(&self, field: &str) -> Result<[DVec3; 4], SceneError> {
        let at = |name: &str| format!("{field}.{name}");
        let corners = match (self.center, self.half_u, self.half_v, self.corners) {
            (Some(c), Some(u), Some(v), None) => {
                let c = vector(&at("center"), c)?;
                let (u, v) = (vector(&at("half_u"), u)?, vector(&at("half_v"), v)?);
                [c - u - v, c + u - v, c + u + v, c - u + v]
            }
            (None, None, None, Some(corners)) => {
                let mut points = [DVec3::ZERO; 4];
                for (i, corner) in corners.into_iter().enumerate() {
                    points[i] = vector(&at(&format!("corners[{i}]")), corner)?;
                }
                points
            }
            _ => return Err(problem(field, "needs either center, half_u and half_v, or corners")),
        };
        check_shape(field, &corners)?;
        Ok(corners)
    }
}

fn check_shape(field: &str, corners: &[DVec3; 4]) -> Result<(), SceneError> {
    let [a, b, c, d] = corners;
    let perimeter = 2.0 * ((*b - *a).length() + (*d - *a).length());
    if (*b - *a).cross(*d - *a).length() <= 1e-12 * perimeter * perimeter {
        return Err(problem(field, "has no area"));
    }
    if (*a + *c - *b - *d).length() > 1e-6 * perimeter {
        return Err(problem(format!("{field}.corners"), "are not those of a parallelogram"));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Ray;

    fn resolve(json: &str) -> Result<Emitter, String> {
        let light: Light = serde_json::from_str(json).map_err(|e| e.to_string())?;
        light.resolve("lights[0]", Path::new("")).map_err(|e| e.to_string())
    }

    const CEILING: &str = r#"{"type": "rectangle", "center": [0, 2, 0], "half_u": [1, 0, 0], "half_v": [0, 0, 3],
        "color": [1, 0.5, 0], "intensity": 4}"#;

    #[test]
    fn a_rectangle_emits_along_u_cross_v_and_is_seen_from_there() {
        let light = resolve(CEILING).unwrap();
        assert_eq!(light.radiance, DVec3::new(4.0, 2.0, 0.0));
        // x × z points down.
        let up = Ray { origin: DVec3::new(0.9, 0.0, -2.9), direction: DVec3::Y };
        assert_eq!(light.hit(&up), Some(2.0));
        let beside = Ray { origin: DVec3::new(1.1, 0.0, 0.0), ..up };
        assert_eq!(light.hit(&beside), None);
        let from_above = Ray { origin: DVec3::new(0.0, 3.0, 0.0), direction: DVec3::NEG_Y };
        assert_eq!(light.hit(&from_above), None);
        let two_sided = CEILING.replace("\"intensity\"", "\"two_sided\": true, \"intensity\"");
        assert_eq!(resolve(&two_sided).unwrap().hit(&from_above), Some(1.0));
        let away = Ray { direction: DVec3::NEG_Y, ..up };
        assert_eq!(light.hit(&away), None);
    }

    #[test]
    fn corners_are_the_same_light() {
        let corners = r#"{"type": "rectangle", "corners": [[-1,2,-3],[1,2,-3],[1,2,3],[-1,2,3]],
            "color": [1, 0.5, 0], "intensity": 4}"#;
        assert_eq!(resolve(corners).unwrap().light, resolve(CEILING).unwrap().light);
    }

    #[test]
    fn nonsense_is_named() {
        let cut = |from: &str, to: &str| resolve(&CEILING.replace(from, to)).unwrap_err();
        assert_eq!(cut("[0, 0, 3]", "[2, 0, 0]"), "lights[0] has no area");
        assert_eq!(
            cut("\"intensity\": 4", "\"intensity\": -4"),
            "lights[0].intensity is -4, must be in [0, 1000000000]"
        );
        assert_eq!(
            cut("\"center\": [0, 2, 0],", ""),
            "lights[0] needs either center, half_u and half_v, or corners"
        );
        assert!(cut("\"intensity\": 4", "\"power\": 4").contains("unknown field `power`"));
        let skewed =
            r#"{"type": "rectangle", "corners": [[-1,2,-3],[1,2,-3],[1,2,4],[-1,2,3]], "intensity": 4}"#;
        assert_eq!(resolve(skewed).unwrap_err(), "lights[0].corners are not those of a parallelogram");
    }

    #[test]
    fn lights_of_every_shape_are_seen_where_they_are() {
        let strength = r#""color": [1, 1, 1], "intensity": 2"#;
        for (shape, distance) in [
            (r#""type": "polygon", "vertices": [[-1,2,-1],[1,2,-1],[0,2,1]]"#, 2.0),
            (r#""type": "line", "p0": [-1,2,0], "p1": [1,2,0], "radius": 0.1"#, 1.9),
            (r#""type": "strip", "p0": [-1,2,0], "p1": [1,2,0], "width": 0.2, "normal": [0,-1,0]"#, 2.0),
            (r#""type": "cylinder", "p0": [-1,2,0], "p1": [1,2,0], "radius": 0.5, "caps": true"#, 1.5),
            (r#""type": "disk", "center": [0,2,0], "normal": [0,-1,0], "radius": 0.5"#, 2.0),
            (r#""type": "ellipse", "center": [0,2,0], "axis_u": [1,0,0], "axis_v": [0,0,0.5]"#, 2.0),
            (r#""type": "sphere", "center": [0,2,0], "radius": 0.5"#, 1.5),
        ] {
            let light = resolve(&format!("{{{shape}, {strength}}}")).unwrap();
            let up = Ray { origin: DVec3::new(0.01, 0.0, 0.0), direction: DVec3::Y };
            let hit = light.hit(&up).unwrap_or_else(|| panic!("{shape}"));
            assert!((hit - distance).abs() < 1e-3, "{shape}: {hit}");
            assert_eq!(light.hit(&Ray { direction: DVec3::X, ..up }), None, "{shape}");
            let negative = resolve(&format!("{{{shape}, {}}}", strength.replace('2', "-2"))).unwrap_err();
            assert!(negative.contains("lights[0].intensity is -2"), "{negative}");
        }
        let flat = r#"{"type": "disk", "center": [0,2,0], "normal": [0,0,0], "radius": 0.5, "intensity": 1}"#;
        assert_eq!(resolve(flat).unwrap_err(), "lights[0].normal is zero, must have a direction");
        let thin = r#"{"type": "line", "p0": [0,2,0], "p1": [0,2,0], "radius": 0, "intensity": 1}"#;
        assert_eq!(resolve(thin).unwrap_err(), "lights[0].radius is 0, must be above 0");
        let none = r#"{"type": "polygon", "vertices": [[0,2,0],[1,2,0],[2,2,0]], "intensity": 1}"#;
        assert_eq!(resolve(none).unwrap_err(), "lights[0] has no area");
    }
}
