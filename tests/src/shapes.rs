//! Lights that tests put together.

use glam::DVec3;
use ltc_core::points::SplitMix64;

/// Uniform in [−1, 1)³.
pub fn in_cube(rng: &mut SplitMix64) -> DVec3 {
    DVec3::new(rng.range(-1.0, 1.0), rng.range(-1.0, 1.0), rng.range(-1.0, 1.0))
}

/// Two unit vectors perpendicular to each other and to `axis`; any two for an axis of length 0.
pub fn tangents(axis: DVec3) -> (DVec3, DVec3) {
    axis.normalize_or(DVec3::Z).any_orthonormal_pair()
}

/// The parallelogram around `centre` with half-sides `u`, `v`; it emits to where `u × v` points.
pub fn parallelogram(centre: DVec3, u: DVec3, v: DVec3) -> [DVec3; 4] {
    [centre - u - v, centre + u - v, centre + u + v, centre - u + v]
}

/// The rectangle `x` × `y` at height `z`, emitting downwards.
pub fn ceiling(x: [f64; 2], y: [f64; 2], z: f64) -> [DVec3; 4] {
    [(x[0], y[0]), (x[0], y[1]), (x[1], y[1]), (x[1], y[0])].map(|(x, y)| DVec3::new(x, y, z))
}

/// The upright rectangle `y` × `z` at distance `x`, emitting towards −x.
pub fn wall(x: f64, y: [f64; 2], z: [f64; 2]) -> [DVec3; 4] {
    [(y[0], z[0]), (y[0], z[1]), (y[1], z[1]), (y[1], z[0])].map(|(y, z)| DVec3::new(x, y, z))
}

/// A flat star around `centre` with this many corners, tilted anywhere; its radius varies from `radius`/4 to `radius`.
pub fn star(rng: &mut SplitMix64, centre: DVec3, radius: f64, corners: usize) -> Vec<DVec3> {
    let (u, v) = tangents(in_cube(rng));
    (0..corners)
        .map(|i| {
            let (sin, cos) = (core::f64::consts::TAU * i as f64 / corners as f64).sin_cos();
            centre + (u * cos + v * sin) * (radius * rng.range(0.25, 1.0))
        })
        .collect()
}

/// The other way round: what emitted to one side emits to the other.
pub fn reversed<const N: usize>(mut vertices: [DVec3; N]) -> [DVec3; N] {
    vertices.reverse();
    vertices
}

/// Whether the shading point lies in front of the emitting side.
pub fn faces_origin(vertices: &[DVec3]) -> bool {
    let first = vertices[0];
    let area: DVec3 = vertices.windows(2).map(|e| (e[0] - first).cross(e[1] - first)).sum();
    area.dot(first) < 0.0
}

/// Configuration factor of a surface element to a parallel rectangle a × b, a corner of it straight above the element at
/// distance 1 (Howell's catalogue of configuration factors, B-4).
pub fn corner_above(a: f64, b: f64) -> f64 {
    let (x, y) = ((1.0 + a * a).sqrt(), (1.0 + b * b).sqrt());
    (a / x * (b / x).atan() + b / y * (a / y).atan()) / core::f64::consts::TAU
}

/// Configuration factor to a rectangle that stands on the element's plane at distance 1, from y = 0 to b, a high (B-5).
pub fn standing(a: f64, b: f64) -> f64 {
    let r = (1.0 + a * a).sqrt();
    (b.atan() - (b / r).atan() / r) / core::f64::consts::TAU
}
