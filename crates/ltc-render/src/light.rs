//! Lights.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::SceneError;
use crate::camera::Ray;
use crate::validate::{color, problem, range, vector};

/// The largest intensity, and the largest channel of a colour: products stay far within `f32`.
const BRIGHTEST: f64 = 1e9;

/// A light.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Light {
    /// A rectangle that emits the same radiance in all directions.
    Rectangle(Rectangle),
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
}

fn white() -> [f64; 3] {
    [1.0; 3]
}

/// A checked light, ready for shading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Emitter {
    /// Counter-clockwise seen from the emitting side.
    pub corners: [DVec3; 4],
    pub radiance: DVec3,
    pub two_sided: bool,
}

impl Light {
    /// `field` is the path of the light in the scene, for errors.
    pub(crate) fn resolve(&self, field: &str) -> Result<Emitter, SceneError> {
        let Self::Rectangle(rectangle) = self;
        let corners = rectangle.corners(field)?;
        let color = color(&format!("{field}.color"), rectangle.color, BRIGHTEST)?;
        let intensity = range(&format!("{field}.intensity"), rectangle.intensity, 0.0, BRIGHTEST)?;
        Ok(Emitter { corners, radiance: color * intensity, two_sided: rectangle.two_sided })
    }
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

impl Emitter {
    /// Distance along the ray to the light's emitting side, if it is met.
    pub fn hit(&self, ray: &Ray) -> Option<f64> {
        let [a, b, _, d] = self.corners;
        let (u, v) = (b - a, d - a);
        let normal = u.cross(v);
        let towards = normal.dot(ray.direction);
        let seen = towards < 0.0 || (self.two_sided && towards > 0.0);
        if !seen {
            return None;
        }
        let t = normal.dot(a - ray.origin) / towards;
        let offset = ray.origin + ray.direction * t - a;
        let area = normal.length_squared();
        let s = [offset.cross(v).dot(normal) / area, u.cross(offset).dot(normal) / area];
        (t > 0.0 && s.iter().all(|x| (0.0..=1.0).contains(x))).then_some(t)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn resolve(json: &str) -> Result<Emitter, String> {
        let light: Light = serde_json::from_str(json).map_err(|e| e.to_string())?;
        light.resolve("lights[0]").map_err(|e| e.to_string())
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
        assert_eq!(Emitter { two_sided: true, ..light }.hit(&from_above), Some(1.0));
        let away = Ray { direction: DVec3::NEG_Y, ..up };
        assert_eq!(light.hit(&away), None);
    }

    #[test]
    fn corners_are_the_same_light() {
        let corners = r#"{"type": "rectangle", "corners": [[-1,2,-3],[1,2,-3],[1,2,3],[-1,2,3]],
            "color": [1, 0.5, 0], "intensity": 4}"#;
        assert_eq!(resolve(corners).unwrap(), resolve(CEILING).unwrap());
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
}
