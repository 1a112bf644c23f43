//! Lights from vectors in double precision.

use glam::{DVec3, Vec3, dvec3};
use ltc_core::Sides;
use ltc_shade_gpu::LightShape;

use crate::shapes;

fn single(v: DVec3) -> Vec3 {
    v.as_vec3()
}

/// A two-sided polygon.
pub fn polygon(vertices: &[DVec3]) -> LightShape {
    LightShape::Polygon { vertices: vertices.iter().map(|v| single(*v)).collect(), sides: Sides::Two }
}

/// A two-sided quad.
pub fn quad(corners: [DVec3; 4]) -> LightShape {
    LightShape::Quad { corners: corners.map(single), sides: Sides::Two }
}

/// A two-sided disk.
pub fn disk(center: DVec3, normal: DVec3, radius: f64) -> LightShape {
    let (center, normal) = (single(center), single(normal));
    LightShape::Disk { center, normal, radius: radius as f32, sides: Sides::Two }
}

/// A two-sided ellipse.
pub fn ellipse(center: DVec3, u: DVec3, v: DVec3) -> LightShape {
    let [center, axis_u, axis_v] = [center, u, v].map(single);
    LightShape::Ellipse { center, axis_u, axis_v, sides: Sides::Two }
}

/// A sphere.
pub fn sphere(center: DVec3, radius: f64) -> LightShape {
    LightShape::Sphere { center: single(center), radius: radius as f32 }
}

/// A thin tube.
pub fn line(p0: DVec3, p1: DVec3, radius: f64, caps: bool) -> LightShape {
    LightShape::Line { p0: single(p0), p1: single(p1), radius: radius as f32, caps }
}

/// A two-sided strip.
pub fn strip(p0: DVec3, p1: DVec3, normal: DVec3, width: f64) -> LightShape {
    let [p0, p1, normal] = [p0, p1, normal].map(single);
    LightShape::Strip { p0, p1, width: width as f32, normal, sides: Sides::Two }
}

/// A cylinder.
pub fn cylinder(p0: DVec3, p1: DVec3, radius: f64, caps: bool) -> LightShape {
    LightShape::Cylinder { p0: single(p0), p1: single(p1), radius: radius as f32, caps }
}

/// One flat light of each shape around `centre`, `u` and `v` being half-axes at right angles.
pub fn flat(centre: DVec3, u: DVec3, v: DVec3) -> Vec<LightShape> {
    let normal = u.cross(v);
    let corners = shapes::parallelogram(centre, u, v);
    vec![
        quad(corners),
        polygon(&corners),
        disk(centre, normal, u.length()),
        ellipse(centre, u, v),
        strip(centre - u, centre + u, normal, v.length()),
    ]
}

/// One light of each shape, the thin ones thin.
pub fn all(centre: DVec3, size: f64) -> Vec<LightShape> {
    let (u, v) = (dvec3(1.0, 0.0, 0.0) * size, dvec3(0.0, 0.6, 0.8) * size);
    let mut lights = flat(centre, u, v);
    let ends = [centre - u, centre + u];
    lights.extend([
        line(ends[0], ends[1], 0.02 * size, false),
        line(ends[0], ends[1], 0.02 * size, true),
        cylinder(ends[0], ends[1], 0.5 * size, false),
        cylinder(ends[0], ends[1], 0.5 * size, true),
        sphere(centre, size),
    ]);
    lights
}
