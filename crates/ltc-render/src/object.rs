//! Objects: spheres and planes, and where rays meet them.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::camera::Ray;
use crate::validate::{direction, length, vector};
use crate::{Material, SceneError};

/// An object.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Object {
    /// A sphere.
    Sphere(Sphere),
    /// A plane, or a disk of one.
    Plane(Plane),
}

/// A sphere. Its tangent runs along the circles of latitude about the y axis, eastwards; at the poles it is arbitrary.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sphere {
    /// Its middle.
    pub center: [f64; 3],
    /// Above 0.
    pub radius: f64,
    /// What it is made of.
    pub material: Material,
}

/// A plane. It is seen, and shaded, from both sides.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Plane {
    /// A point on it: of a disk, the middle.
    pub point: [f64; 3],
    /// Across it; any length but zero.
    #[serde(default = "y_axis")]
    pub normal: [f64; 3],
    /// Carries `alpha_x`; made perpendicular to the normal, arbitrary where it is parallel to it.
    #[serde(default = "x_axis")]
    pub tangent: [f64; 3],
    /// Makes a disk of it. Without, it is endless.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub radius: Option<f64>,
    /// What it is made of.
    pub material: Material,
}

fn x_axis() -> [f64; 3] {
    [1.0, 0.0, 0.0]
}

fn y_axis() -> [f64; 3] {
    [0.0, 1.0, 0.0]
}

/// A checked object.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Shape {
    Sphere { center: DVec3, radius: f64 },
    Plane { point: DVec3, normal: DVec3, tangent: DVec3, radius: f64 },
}

/// A point of a surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hit {
    pub distance: f64,
    /// Outwards; not yet turned to the viewer.
    pub normal: DVec3,
    /// In the surface or near it, or zero.
    pub tangent: DVec3,
}

impl Object {
    pub(crate) fn material(&self) -> &Material {
        match self {
            Self::Sphere(sphere) => &sphere.material,
            Self::Plane(plane) => &plane.material,
        }
    }

    /// `field` is the path of the object in the scene, for errors.
    pub(crate) fn shape(&self, field: &str) -> Result<Shape, SceneError> {
        let at = |name: &str| format!("{field}.{name}");
        Ok(match self {
            Self::Sphere(sphere) => Shape::Sphere {
                center: vector(&at("center"), sphere.center)?,
                radius: length(&at("radius"), sphere.radius)?,
            },
            Self::Plane(plane) => Shape::Plane {
                point: vector(&at("point"), plane.point)?,
                normal: direction(&at("normal"), plane.normal)?,
                tangent: direction(&at("tangent"), plane.tangent)?,
                radius: plane.radius.map_or(Ok(f64::INFINITY), |r| length(&at("radius"), r))?,
            },
        })
    }
}

impl Shape {
    /// The first point of the surface in front of the ray's origin.
    pub fn hit(&self, ray: &Ray) -> Option<Hit> {
        match *self {
            Self::Sphere { center, radius } => {
                let distance = sphere_distance(ray, center, radius)?;
                let normal = (ray.origin + ray.direction * distance - center) / radius;
                Some(Hit { distance, normal, tangent: DVec3::Y.cross(normal) })
            }
            Self::Plane { point, normal, tangent, radius } => {
                let distance = normal.dot(point - ray.origin) / normal.dot(ray.direction);
                let inside = (ray.origin + ray.direction * distance - point).length() <= radius;
                (distance > 0.0 && distance.is_finite() && inside).then_some(Hit {
                    distance,
                    normal,
                    tangent,
                })
            }
        }
    }
}

/// Distance to the nearer crossing in front of the origin, by the form of the quadratic that does not cancel.
fn sphere_distance(ray: &Ray, center: DVec3, radius: f64) -> Option<f64> {
    let to_center = center - ray.origin;
    let along = to_center.dot(ray.direction);
    let nearest = to_center - ray.direction * along;
    let under_root = radius * radius - nearest.length_squared();
    if under_root < 0.0 {
        return None;
    }
    let half = under_root.sqrt();
    let far = along + half;
    let near = along - half;
    if near > 0.0 { Some(near) } else { (far > 0.0).then_some(far) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sphere_is_met_from_outside_and_inside() {
        let sphere = Shape::Sphere { center: DVec3::new(0.0, 0.0, -5.0), radius: 2.0 };
        let ray = Ray { origin: DVec3::ZERO, direction: DVec3::NEG_Z };
        let hit = sphere.hit(&ray).unwrap();
        assert_eq!((hit.distance, hit.normal), (3.0, DVec3::Z));
        assert_eq!(hit.tangent, DVec3::X, "eastwards");
        let inside = Ray { origin: DVec3::new(0.0, 0.0, -5.0), ..ray };
        assert_eq!(sphere.hit(&inside).unwrap().distance, 2.0);
        assert!(sphere.hit(&Ray { direction: DVec3::Z, ..ray }).is_none());
        assert!(sphere.hit(&Ray { origin: DVec3::new(2.1, 0.0, 0.0), ..ray }).is_none());
    }

    #[test]
    fn a_plane_may_end() {
        let plane =
            Shape::Plane { point: DVec3::ZERO, normal: DVec3::Y, tangent: DVec3::X, radius: f64::INFINITY };
        let ray = Ray { origin: DVec3::new(9.0, 3.0, 0.0), direction: DVec3::NEG_Y };
        assert_eq!(plane.hit(&ray).unwrap().distance, 3.0);
        let disk = Shape::Plane { point: DVec3::ZERO, normal: DVec3::Y, tangent: DVec3::X, radius: 8.0 };
        assert!(disk.hit(&ray).is_none());
        assert!(plane.hit(&Ray { direction: DVec3::X, ..ray }).is_none(), "parallel");
        assert!(plane.hit(&Ray { direction: DVec3::Y, ..ray }).is_none(), "behind");
    }
}
