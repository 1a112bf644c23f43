//! Random lobes and lights for the tests.

#![expect(dead_code, reason = "every test file uses its own part of this module")]

use std::f64::consts::TAU;

use glam::{DMat3, DVec3, dvec3};
use ltc_reference::{Ggx, LtcLobe, SplitMix64, sphere_direction, view_direction};

/// A random number from `low` to `high`, uniform in its logarithm.
pub fn log_uniform(random: &mut SplitMix64, low: f64, high: f64) -> f64 {
    (low.ln() + (high.ln() - low.ln()) * random.next_f64()).exp()
}

/// A random rotation: its columns are right-handed and orthonormal.
pub fn rotation(random: &mut SplitMix64) -> DMat3 {
    let z = sphere_direction(random.next_2d());
    let (x, y) = z.any_orthonormal_pair();
    let (sin, cos) = (TAU * random.next_f64()).sin_cos();
    DMat3::from_cols(cos * x + sin * y, cos * y - sin * x, z)
}

/// A random LTC with a condition number up to `condition`.
pub fn ltc(random: &mut SplitMix64, condition: f64) -> LtcLobe {
    let stretch = dvec3(1.0, log_uniform(random, 1.0 / condition, 1.0), 1.0 / condition);
    let stretch = DVec3 { x: log_uniform(random, 1.0 / condition, 1.0), ..stretch };
    let matrix = rotation(random) * DMat3::from_diagonal(stretch) * rotation(random);
    LtcLobe::new(matrix).expect("rotations and positive stretches are invertible")
}

/// A random material and view of the standard draw: half of the widths small, any anisotropy, θ up to 86°.
pub fn ggx_and_view(random: &mut SplitMix64) -> (Ggx, DVec3) {
    let alpha = if random.next_f64() < 0.5 {
        0.01 + 0.99 * random.next_f64()
    } else {
        (0.1 + 0.9 * random.next_f64()).powi(2)
    };
    let lambda = 0.05 + 0.95 * random.next_f64();
    let wo = view_direction(86f64.to_radians() * random.next_f64(), TAU * random.next_f64());
    (Ggx::new(alpha, alpha * lambda).expect("widths are positive"), wo)
}

/// A star-shaped, usually non-convex polygon of 3 to 8 vertices, `distance` from the origin, as wide as `size`.
pub fn star(random: &mut SplitMix64, distance: f64, size: f64) -> Vec<DVec3> {
    let frame = rotation(random);
    let centre = distance * sphere_direction(random.next_2d());
    let count = 3 + (random.next_u64() % 6) as usize;
    (0..count)
        .map(|i| {
            let angle = TAU * (i as f64 + 0.8 * random.next_f64()) / count as f64;
            let radius = size * (0.1 + 0.9 * random.next_f64());
            centre + radius * (angle.cos() * frame.x_axis + angle.sin() * frame.y_axis)
        })
        .collect()
}

/// The polygon with its vertices in the opposite order.
pub fn reversed(polygon: &[DVec3]) -> Vec<DVec3> {
    polygon.iter().rev().copied().collect()
}
