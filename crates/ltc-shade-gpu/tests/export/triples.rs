//! Random lights under random lobes, as all hosts read them, and what they come to on the CPU in f64.

use glam::{DMat3, DVec3, Mat3, Vec3};
use ltc_core::{Horizon, Ltc, Matrix as _, Sides};
use ltc_shade_gpu::{LightKind, LightShape};

/// The bound that the workspace promises for exact forms, absolute, for a condition number up to 100.
const TOLERANCE: f64 = 2e-4;

/// A light and the lobe that it lights.
pub struct Triple {
    /// Row-major.
    m: [f32; 9],
    light: LightShape,
}

impl Triple {
    /// Eight vec4: columns of M, a, b, c, d, and the bits in the last word. A polygon has its corners in a, b, c, d.
    pub fn words(&self) -> [u32; 32] {
        let mut words = [0_u32; 32];
        let mut put = |slot: usize, p: Vec3, w: f32| {
            words[4 * slot..4 * slot + 4].copy_from_slice(&[p.x, p.y, p.z, w].map(f32::to_bits));
        };
        let m = Mat3::from_row_array(self.m);
        for (column, v) in [m.x_axis, m.y_axis, m.z_axis].into_iter().enumerate() {
            put(column, v, 0.0);
        }
        let two = |sides: &Sides| 256 * u32::from(*sides == Sides::Two);
        let flags = match &self.light {
            LightShape::Quad { corners, sides } => {
                (0..4).for_each(|i| put(3 + i, corners[i], 0.0));
                two(sides)
            }
            LightShape::Polygon { vertices, sides } => {
                (0..4).for_each(|i| put(3 + i, vertices[i], 0.0));
                two(sides)
            }
            LightShape::Line { p0, p1, radius, .. } => {
                put(3, *p0, *radius);
                put(4, *p1, 0.0);
                0
            }
            LightShape::Strip { p0, p1, width, normal, sides } => {
                put(3, *p0, *width);
                put(4, *p1, 0.0);
                put(5, *normal, 0.0);
                two(sides)
            }
            LightShape::Cylinder { p0, p1, radius, caps } => {
                put(3, *p0, *radius);
                put(4, *p1, 0.0);
                512 * u32::from(*caps)
            }
            LightShape::Disk { center, normal, radius, sides } => {
                put(3, *center, *radius);
                put(4, *normal, 0.0);
                two(sides)
            }
            LightShape::Ellipse { center, axis_u, axis_v, sides } => {
                put(3, *center, 0.0);
                put(4, *axis_u, 0.0);
                put(5, *axis_v, 0.0);
                two(sides)
            }
            LightShape::Sphere { center, radius } => {
                put(3, *center, *radius);
                0
            }
        };
        words[31] = self.light.kind() as u32 | flags;
        words
    }

    /// The fraction of the lobe that sees the light, and how far a device may be off.
    pub fn expected(&self) -> (f64, f64) {
        let m = DMat3::from_row_array(self.m.map(f64::from));
        let norm = |m: DMat3| m.to_cols_array().iter().map(|x| x * x).sum::<f64>().sqrt();
        let condition = norm(m) * norm(m.inverse());
        let value = self.light.integrate(&Ltc::<f64>::new(m).unwrap(), Horizon::BOTH).unwrap();
        (value, TOLERANCE * (condition / 100.0).max(1.0))
    }
}

/// `count` of each of these kinds of light.
pub fn triples(kinds: &[LightKind], count: usize, mut rng: impl FnMut() -> f64) -> Vec<Triple> {
    let kinds = kinds.iter().flat_map(|kind| std::iter::repeat_n(*kind, count));
    kinds.map(|kind| Triple { m: lobe(&mut rng), light: light(kind, &mut rng) }).collect()
}

/// A lobe as tables have them: narrow or wide, tilted, turned.
fn lobe(rng: &mut impl FnMut() -> f64) -> [f32; 9] {
    let widths = DVec3::new(0.05 + 0.95 * rng(), 0.05 + 0.95 * rng(), 1.0);
    let shear = DMat3::from_cols(DVec3::X, DVec3::Y, DVec3::new(0.6 * (rng() - 0.5), 0.0, 1.0));
    let tilt = DMat3::from_rotation_y(-1.2 * rng());
    let turn = DMat3::from_rotation_z(std::f64::consts::TAU * rng());
    let m = turn * tilt * DMat3::from_diagonal(widths) * shear * turn.transpose();
    m.transpose().to_cols_array().map(|x| x as f32)
}

fn light(kind: LightKind, rng: &mut impl FnMut() -> f64) -> LightShape {
    let sides = if rng() < 0.5 { Sides::One } else { Sides::Two };
    let caps = rng() < 0.5;
    let size = 0.05 + 0.6 * rng() as f32;
    let mut vector = |scale: f64| {
        let v = DVec3::new(rng() - 0.5, rng() - 0.5, rng() - 0.5) * scale;
        v.as_vec3()
    };
    let center = vector(3.0) + Vec3::new(0.0, 0.0, 0.9);
    let (u, v) = (vector(2.0), vector(2.0));
    let corners = [center - u - v, center + u - v, center + u + v, center - u + v];
    match kind {
        LightKind::Quad => LightShape::Quad { corners, sides },
        LightKind::Polygon => LightShape::Polygon { vertices: corners.to_vec(), sides },
        LightKind::Line => {
            LightShape::Line { p0: center - u, p1: center + u, radius: 0.3 * size, caps: false }
        }
        LightKind::LineWithCaps => {
            LightShape::Line { p0: center - u, p1: center + u, radius: 0.3 * size, caps: true }
        }
        LightKind::Strip => {
            LightShape::Strip { p0: center - u, p1: center + u, width: size, normal: v, sides }
        }
        LightKind::Cylinder => LightShape::Cylinder { p0: center - u, p1: center + u, radius: size, caps },
        LightKind::Disk => LightShape::Disk { center, normal: u, radius: 2.0 * size, sides },
        LightKind::Ellipse => LightShape::Ellipse { center, axis_u: u, axis_v: v, sides },
        LightKind::Sphere => LightShape::Sphere { center, radius: size },
    }
}

/// Results of a device against the CPU: `Err` says how many are off, and the first; `Ok` the largest error in tolerances.
pub fn compare(triples: &[Triple], results: &[f32]) -> Result<f64, String> {
    assert_eq!(triples.len(), results.len());
    let (mut largest, mut lit, mut wrong) = (0.0_f64, 0, Vec::new());
    for (triple, result) in triples.iter().zip(results) {
        let (expected, tolerance) = triple.expected();
        let off = (f64::from(*result) - expected).abs() / tolerance;
        lit += usize::from(expected > 1e-3);
        largest = largest.max(off);
        // Not `off > 1`: NaN is wrong, too.
        if !(off <= 1.0 && (0.0..=1.0).contains(result)) {
            wrong.push(format!("{result} for {expected}: {:?} under {:?}", triple.light, triple.m));
        }
    }
    assert!(8 * lit > triples.len(), "too few lights light anything: {lit} of {}", triples.len());
    match wrong.first() {
        None => Ok(largest),
        Some(first) => Err(format!("{} of {} are off: {first}", wrong.len(), triples.len())),
    }
}
