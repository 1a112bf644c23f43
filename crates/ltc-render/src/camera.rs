//! The camera.

use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};

use crate::SceneError;
use crate::validate::{direction, problem, range, vector};

/// Pixels along either side of a picture.
const MAX_SIDE: u32 = 16_384;

/// A pinhole camera.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Camera {
    /// Where it is.
    pub position: [f64; 3],
    /// The point in the middle of the picture.
    pub look_at: [f64; 3],
    /// What points up in the picture; not parallel to the view.
    #[serde(default = "y_axis")]
    pub up: [f64; 3],
    /// Vertical angle of view, degrees, in [1, 170].
    pub fov_y_degrees: f64,
    /// Width of the picture, pixels, 1 to 16,384.
    pub width: u32,
    /// Height of the picture, pixels, 1 to 16,384.
    pub height: u32,
}

fn y_axis() -> [f64; 3] {
    [0.0, 1.0, 0.0]
}

/// A half-line; `direction` has unit length.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ray {
    pub origin: DVec3,
    pub direction: DVec3,
}

/// A camera ready to cast rays.
#[derive(Clone, Copy, Debug)]
pub(crate) struct View {
    origin: DVec3,
    /// To the middle of the picture.
    forward: DVec3,
    /// Half the picture's width and height, at distance 1.
    right: DVec3,
    down: DVec3,
    size: DVec2,
}

impl Camera {
    pub(crate) fn view(&self) -> Result<View, SceneError> {
        let origin = vector("camera.position", self.position)?;
        let target = vector("camera.look_at", self.look_at)?;
        let up = direction("camera.up", self.up)?;
        range("camera.fov_y_degrees", self.fov_y_degrees, 1.0, 170.0)?;
        for (field, side) in [("camera.width", self.width), ("camera.height", self.height)] {
            range(field, f64::from(side), 1.0, f64::from(MAX_SIDE))?;
        }
        let forward = (target - origin)
            .try_normalize()
            .ok_or_else(|| problem("camera.look_at", "is where the camera is, must be elsewhere"))?;
        let right = forward.cross(up);
        if right.length() < 1e-9 {
            return Err(problem("camera.up", "is parallel to the view, must not be"));
        }
        let right = right / right.length();
        let half_height = (0.5 * self.fov_y_degrees.to_radians()).tan();
        let size = DVec2::new(f64::from(self.width), f64::from(self.height));
        Ok(View {
            origin,
            forward,
            right: right * (half_height * size.x / size.y),
            down: forward.cross(right) * half_height,
            size,
        })
    }
}

impl View {
    /// Width of the picture, pixels.
    pub fn width(&self) -> u32 {
        self.size.x as u32
    }

    /// Height of the picture, pixels.
    pub fn height(&self) -> u32 {
        self.size.y as u32
    }

    /// The ray through a point of the picture, in pixels from its upper left corner.
    pub fn ray(&self, pixel: DVec2) -> Ray {
        let at = pixel / self.size * 2.0 - 1.0;
        let direction = self.forward + self.right * at.x + self.down * at.y;
        // `forward` is perpendicular to the other two: the sum is at least as long.
        Ray { origin: self.origin, direction: direction / direction.length() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Camera {
        Camera {
            position: [0.0, 0.0, 5.0],
            look_at: [0.0; 3],
            up: y_axis(),
            fov_y_degrees: 90.0,
            width: 200,
            height: 100,
        }
    }

    #[test]
    fn rays_go_through_the_picture() {
        let view = camera().view().unwrap();
        let middle = view.ray(DVec2::new(100.0, 50.0)).direction;
        assert!((middle - DVec3::NEG_Z).length() < 1e-15);
        let top = view.ray(DVec2::new(100.0, 0.0)).direction;
        assert!((top - DVec3::new(0.0, 1.0, -1.0) / 2.0_f64.sqrt()).length() < 1e-15);
        let right = view.ray(DVec2::new(200.0, 50.0)).direction;
        assert!((right - DVec3::new(2.0, 0.0, -1.0) / 5.0_f64.sqrt()).length() < 1e-15);
    }

    #[test]
    fn impossible_cameras_are_named() {
        let message = |camera: Camera| camera.view().unwrap_err().to_string();
        let look_at = camera().position;
        assert_eq!(
            message(Camera { look_at, ..camera() }),
            "camera.look_at is where the camera is, must be elsewhere"
        );
        let up = [0.0, 0.0, -3.0];
        assert_eq!(message(Camera { up, ..camera() }), "camera.up is parallel to the view, must not be");
        assert!(
            message(Camera { fov_y_degrees: f64::NAN, ..camera() })
                .starts_with("camera.fov_y_degrees is NaN")
        );
        assert!(message(Camera { width: 0, ..camera() }).starts_with("camera.width is 0"));
    }
}
