//! Lobes and lights for the tests of polygons, near everything that makes them hard.

#![expect(dead_code, reason = "each test file uses its own part")]

use glam::{DMat3, DVec3};
use ltc_core::points::SplitMix64;

/// A lobe, and the condition number of its matrix.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    pub m: DMat3,
    pub condition: f64,
    pub quad: [DVec3; 4],
}

impl Case {
    /// The bound on an `f32` result: 2e-5 up to a condition of 100, in proportion beyond.
    pub fn tolerance(&self) -> f64 {
        2e-5 * (self.condition / 100.0).max(1.0)
    }
}

/// One axis of a sweep: everything else is drawn mildly.
#[derive(Clone, Copy, Debug)]
pub enum Sweep {
    /// Coordinates times 1e-6 … 1e6.
    Scale,
    /// Widths of the lobe 1e-4 … 1.
    Roughness,
    /// Lobes and lights down to 89.99° off the normal.
    Grazing,
    /// Sides in the ratio 1 … 1e5.
    Aspect,
    /// 1 … 1e-7 of the light's size off its plane, over its inside, edges, corners and beyond.
    Plane,
    /// 1e-3 … 1e3 of the light's size away.
    Distance,
}

pub const SWEEPS: [Sweep; 6] =
    [Sweep::Scale, Sweep::Roughness, Sweep::Grazing, Sweep::Aspect, Sweep::Plane, Sweep::Distance];

/// From 10^a to 10^b, evenly in the exponent.
pub fn decades(rng: &mut SplitMix64, a: f64, b: f64) -> f64 {
    10_f64.powf(rng.range(a, b))
}

pub fn unit(rng: &mut SplitMix64) -> DVec3 {
    let z = rng.range(-1.0, 1.0);
    let (sin, cos) = rng.range(0.0, core::f64::consts::TAU).sin_cos();
    let r = (1.0 - z * z).sqrt();
    DVec3::new(r * cos, r * sin, z)
}

/// Two unit vectors across `n`.
pub fn across(rng: &mut SplitMix64, n: DVec3) -> [DVec3; 2] {
    let u = n.any_orthonormal_vector();
    let (sin, cos) = rng.range(0.0, core::f64::consts::TAU).sin_cos();
    let u = u * cos + n.cross(u) * sin;
    [u, n.cross(u)]
}

/// A lobe like the fitted ones, `R · diag(α, λα, 1) · (a small shear)`, its axis `theta` off the normal.
pub fn lobe(rng: &mut SplitMix64, alpha: f64, theta: f64) -> (DMat3, f64) {
    let lambda = rng.range(0.3, 1.0);
    let turn = DMat3::from_rotation_z(rng.range(0.0, 6.3)) * DMat3::from_rotation_y(theta);
    (turn * DMat3::from_diagonal(DVec3::new(alpha, alpha * lambda, 1.0)), 1.0 / (alpha * lambda))
}

pub fn case(rng: &mut SplitMix64, sweep: Sweep) -> Case {
    let mut alpha = decades(rng, -1.5, 0.0);
    let mut theta = rng.range(0.0, 1.3);
    let mut half = [0; 2].map(|_| decades(rng, -1.0, 1.0));
    let mut scale = 1.0;
    let mut tilt = rng.range(0.0, 1.2);
    let mut spread = 1.0;
    match sweep {
        Sweep::Scale => scale = decades(rng, -6.0, 6.0),
        Sweep::Roughness => {
            alpha = decades(rng, -4.0, 0.0);
            half = [0; 2].map(|_| alpha.sqrt() * decades(rng, -2.0, 1.0));
            spread = alpha;
        }
        Sweep::Grazing => {
            let grazing = |rng: &mut SplitMix64| core::f64::consts::FRAC_PI_2 - decades(rng, -3.757, 0.0);
            theta = grazing(rng);
            tilt = grazing(rng);
        }
        Sweep::Aspect => half[1] = half[0] / decades(rng, 0.0, 5.0),
        Sweep::Plane => return near_plane(rng),
        Sweep::Distance => {
            let size = decades(rng, -3.0, 3.0);
            half = [0; 2].map(|_| size * decades(rng, -0.3, 0.3));
        }
    }
    let (m, condition) = lobe(rng, alpha, theta);
    let axis = m * DVec3::Z / (m * DVec3::Z).length();
    let [u, v] = across(rng, axis);
    let direction = axis + (u * rng.range(-1.0, 1.0) + v * rng.range(-1.0, 1.0)) * spread;
    let [u, v] = across(rng, direction / direction.length());
    let (sin, cos) = tilt.sin_cos();
    let u = u * cos + direction / direction.length() * sin;
    Case { m, condition, quad: parallelogram(direction * scale, u * half[0] * scale, v * half[1] * scale) }
}

/// Half a decade to seven decades nearer to the light's plane than the light is wide.
fn near_plane(rng: &mut SplitMix64) -> Case {
    let alpha = decades(rng, -1.5, 0.0);
    let theta = rng.range(0.0, 1.3);
    let (m, condition) = lobe(rng, alpha, theta);
    let normal = unit(rng);
    let [u, v] = across(rng, normal);
    // The foot of the shading point: inside, near an edge, near a corner, beyond.
    let near =
        |rng: &mut SplitMix64| 1.0 + decades(rng, -7.0, -1.0) * [-1.0, 1.0][(rng.unit() * 2.0) as usize];
    let inside = |rng: &mut SplitMix64| rng.range(-0.9, 0.9);
    let [a, b] = match (rng.unit() * 4.0) as usize {
        0 => [inside(rng), inside(rng)],
        1 => [near(rng), inside(rng)],
        2 => [near(rng), near(rng)],
        _ => [rng.range(-2.0, 2.0), rng.range(-2.0, 2.0)],
    };
    let height = decades(rng, -7.0, 0.0);
    let v = v * decades(rng, -1.0, 1.0);
    Case { m, condition, quad: parallelogram(u * a + v * b + normal * height, u, v) }
}

pub fn parallelogram(centre: DVec3, u: DVec3, v: DVec3) -> [DVec3; 4] {
    [centre - u - v, centre + u - v, centre + u + v, centre - u + v]
}

/// Largest and root mean square of many numbers.
#[derive(Clone, Copy, Debug, Default)]
pub struct Statistics {
    pub max: f64,
    sum: f64,
    count: usize,
}

impl Statistics {
    pub fn add(&mut self, x: f64) {
        assert!(x.is_finite(), "an error that is no number");
        self.max = self.max.max(x.abs());
        self.sum += x * x;
        self.count += 1;
    }

    pub fn rms(&self) -> f64 {
        (self.sum / self.count as f64).sqrt()
    }
}
