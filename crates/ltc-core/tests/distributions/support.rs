//! Random matrices and polygons.

use std::f64::consts::TAU;

use glam::{DMat3, DVec3, dvec3};
use ltc_core::points::SplitMix64;

/// Uniform on the sphere.
pub fn direction(random: &mut SplitMix64) -> DVec3 {
    let z = random.range(-1.0, 1.0);
    let (sin, cos) = (TAU * random.unit()).sin_cos();
    let r = (1.0 - z * z).sqrt();
    dvec3(r * cos, r * sin, z)
}

/// A random rotation.
pub fn rotation(random: &mut SplitMix64) -> DMat3 {
    let z = direction(random);
    let (x, y) = z.any_orthonormal_pair();
    let (sin, cos) = (TAU * random.unit()).sin_cos();
    DMat3::from_cols(cos * x + sin * y, cos * y - sin * x, z)
}

/// A random matrix of positive determinant and of this condition number.
pub fn matrix(random: &mut SplitMix64, condition: f64) -> DMat3 {
    let middle = condition.powf(-random.unit());
    rotation(random) * DMat3::from_diagonal(dvec3(1.0, middle, 1.0 / condition)) * rotation(random)
}

/// A star-shaped, usually non-convex polygon of 3 to 8 vertices in a random plane, around `centre`, as wide as `size`.
pub fn star(random: &mut SplitMix64, centre: DVec3, size: f64) -> Vec<DVec3> {
    let frame = rotation(random);
    let count = 3 + (random.bits() % 6) as usize;
    (0..count)
        .map(|i| {
            let angle = TAU * (i as f64 + 0.8 * random.unit()) / count as f64;
            let radius = size * random.range(0.1, 1.0);
            centre + radius * (angle.cos() * frame.x_axis + angle.sin() * frame.y_axis)
        })
        .collect()
}

/// The six faces of a box around the origin, wound to emit inwards.
pub fn faces(half: DVec3) -> [[DVec3; 4]; 6] {
    let corner = |i: usize| {
        let side = |bit: usize| if i & bit == 0 { -1.0 } else { 1.0 };
        half * dvec3(side(1), side(2), side(4))
    };
    [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
        .map(|f| f.map(corner))
}
