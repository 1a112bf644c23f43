//! What GPU forms are timed over: a floor whose materials and views vary from pixel to pixel, and lights around it.

use std::f64::consts::TAU;

use glam::{DMat3, DVec3, Vec3};
use ltc_core::points::SplitMix64;
use ltc_core::{Horizon, Ltc, Sides};
use ltc_shade_gpu::{LightKind, LightShape};
use ltc_table::Query;

use super::super::StudyError;

/// The eye above the floor; no pixel looks along its normal, where published shaders have no frame.
const EYE: DVec3 = DVec3::new(0.3, -1.4, 0.7);
const RING: f64 = 2.5;
const LINE_RADIUS: f32 = 0.03;
const TUBE_RADIUS: f32 = 0.25;
const ROUND_RADIUS: f32 = 0.5;
/// Corners of the polygons.
pub const EDGES: usize = 6;
/// Directions that a lookup is judged by, beside the mirrored view itself; those of `pixel_lookup.wgsl`.
const ASIDE: [DVec3; 3] = [DVec3::ZERO, DVec3::new(0.3, 0.0, 0.1), DVec3::new(0.0, 0.3, 0.1)];

/// Materials of the pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Materials {
    /// Both widths alike.
    Isotropic,
    /// Widths of their own.
    Anisotropic,
    /// Blocks of pixels, each of one material: what has a slice of its own.
    Blocks,
    /// The same pixels as `Anisotropic` in an order without any: neighbours share nothing.
    Scattered,
}

/// A pixel, as `TimedPixel` in WGSL.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pixel {
    /// On the floor.
    pub position: Vec3,
    /// Along x.
    pub alpha_x: f32,
    /// Unit, towards the eye.
    pub wo: Vec3,
    /// Along y.
    pub alpha_y: f32,
}

/// All pixels of a picture, row by row.
pub fn pixels(width: u32, height: u32, materials: Materials) -> Vec<Pixel> {
    let mut all: Vec<Pixel> = (0..width * height)
        .map(|i| {
            let u = (f64::from(i % width) + 0.5) / f64::from(width);
            let v = (f64::from(i / width) + 0.5) / f64::from(height);
            let position = DVec3::new((2.0 * u - 1.0) * 16.0 / 9.0, 1.0 - 2.0 * v, 0.0).as_vec3();
            let [alpha_x, alpha_y] = match materials {
                Materials::Blocks => block_widths(block([u, v])),
                _ => widths([u, v], materials != Materials::Isotropic),
            };
            let wo = (EYE - position.as_dvec3()).normalize_or_zero().as_vec3();
            Pixel { position, alpha_x, wo, alpha_y }
        })
        .collect();
    if materials == Materials::Scattered {
        let mut rng = SplitMix64::new(9);
        for i in (1..all.len()).rev() {
            all.swap(i, (rng.unit() * (i + 1) as f64) as usize);
        }
    }
    all
}

/// GGX widths at a place of the picture, in [0, 1]²: smooth, as textures of materials are.
fn widths([u, v]: [f64; 2], anisotropic: bool) -> [f32; 2] {
    let wave = |f: f64, x: f64, y: f64| 0.5 + 0.5 * (TAU * f * (x + 0.3 * y)).sin();
    let alpha = (0.05 + 0.75 * wave(3.0, u, v)) as f32;
    let lambda = if anisotropic { 0.15 + 0.8 * wave(2.0, v, u) } else { 1.0 };
    let thin = (f64::from(alpha) * lambda) as f32;
    if anisotropic && wave(1.5, u, -v) > 0.5 { [thin, alpha] } else { [alpha, thin] }
}

/// Columns and rows of blocks; `timed_slice` of WGSL has the same.
const BLOCKS: [u32; 2] = [8, 9];

/// Number of the block at a place of the picture.
fn block([u, v]: [f64; 2]) -> u32 {
    let [columns, rows] = BLOCKS;
    let step = |x: f64, count: u32| ((x * f64::from(count)) as u32).min(count - 1);
    step(u, columns) + columns * step(v, rows)
}

/// Widths of a block's material.
fn block_widths(block: u32) -> [f32; 2] {
    let [columns, rows] = BLOCKS;
    let middle = |k: u32, count: u32| (f64::from(k) + 0.5) / f64::from(count);
    widths([middle(block % columns, columns), middle(block / columns, rows)], true)
}

/// The materials of all blocks, in their order.
pub fn block_materials() -> Vec<[f32; 2]> {
    (0..BLOCKS[0] * BLOCKS[1]).map(block_widths).collect()
}

/// As a storage buffer holds them.
pub fn pixel_bytes(pixels: &[Pixel]) -> Vec<u8> {
    let numbers = pixels.iter().flat_map(|p| {
        let ([x, y, z], [u, v, w]) = (p.position.to_array(), p.wo.to_array());
        [x, y, z, p.alpha_x, u, v, w, p.alpha_y]
    });
    numbers.flat_map(f32::to_le_bytes).collect()
}

impl Pixel {
    /// What a table is asked.
    pub fn query(&self) -> Query {
        let wo = self.wo.as_dvec3();
        Query {
            theta: wo.truncate().length().atan2(wo.z.max(0.0)),
            phi: wo.y.atan2(wo.x),
            alpha_x: f64::from(self.alpha_x),
            alpha_y: f64::from(self.alpha_y),
        }
    }

    /// `timed_matrix` of WGSL, from the same numbers.
    pub fn matrix(&self) -> DMat3 {
        let wo = self.wo.as_dvec3();
        let across = wo.truncate();
        let lean = (across * -0.9).extend((1.0 - 0.81 * across.length_squared()).max(0.0).sqrt());
        let a = -1.0 / (1.0 + lean.z);
        let t = DVec3::new(1.0 + lean.x * lean.x * a, lean.x * lean.y * a, -lean.x);
        DMat3::from_cols(t * f64::from(self.alpha_x), lean.cross(t) * f64::from(self.alpha_y), lean)
    }

    /// What `pixel_lookup.wgsl` writes of a lobe's matrix.
    pub fn cosines(&self, m: DMat3) -> [f64; 3] {
        let (wo, inverse) = (self.wo.as_dvec3(), m.inverse());
        let mirror = DVec3::new(-wo.x, -wo.y, wo.z);
        ASIDE.map(|aside| (inverse * (mirror + aside)).normalize_or_zero().z)
    }
}

/// `timed_reflectance` of WGSL.
pub fn reflectance(magnitude: f64, fresnel: f64) -> f64 {
    0.04 * magnitude + 0.96 * fresnel
}

/// The lights of one kind, in their order around the floor; `sunk` ones stand half below it.
pub fn lights(kind: LightKind, count: u32, sunk: bool) -> Vec<LightShape> {
    (0..count).map(|i| light(kind, i, sunk)).collect()
}

fn light(kind: LightKind, i: u32, sunk: bool) -> LightShape {
    // By the golden angle: all around, never twice at one place.
    let (sin, cos) = (TAU * 0.618_033_988_75 * f64::from(i)).sin_cos();
    let height = if sunk { 0.1 } else { 0.8 };
    let centre = DVec3::new(RING * cos, RING * sin, height);
    // Facing the middle of the floor, a little downwards.
    let (side, up) =
        (DVec3::new(-sin, cos, 0.0), DVec3::new(-0.2 * cos, -0.2 * sin, 1.0).normalize_or_zero());
    let (u, v) = ((side * 0.8).as_vec3(), (up * 0.5).as_vec3());
    let (center, normal, sides) = (centre.as_vec3(), up.cross(side).as_vec3(), Sides::One);
    let normal = if normal.dot(center) > 0.0 { -normal } else { normal };
    let (p0, p1) = (center - u, center + u);
    match kind {
        LightKind::Quad => {
            // Counter-clockwise seen from the floor.
            LightShape::Quad {
                corners: [center + u - v, center - u - v, center - u + v, center + u + v],
                sides,
            }
        }
        LightKind::Polygon => {
            let corner = |k: usize| {
                let (sin, cos) = (TAU * k as f64 / EDGES as f64).sin_cos();
                center - u * cos as f32 + v * sin as f32
            };
            LightShape::Polygon { vertices: (0..EDGES).map(corner).collect(), sides }
        }
        LightKind::Line => LightShape::Line { p0, p1, radius: LINE_RADIUS, caps: false },
        LightKind::LineWithCaps => LightShape::Line { p0, p1, radius: LINE_RADIUS, caps: true },
        LightKind::Strip => LightShape::Strip { p0, p1, width: 2.0 * LINE_RADIUS, normal, sides },
        LightKind::Cylinder => LightShape::Cylinder { p0, p1, radius: TUBE_RADIUS, caps: true },
        LightKind::Disk => LightShape::Disk { center, normal, radius: ROUND_RADIUS, sides },
        LightKind::Ellipse => LightShape::Ellipse { center, axis_u: v, axis_v: u, sides },
        LightKind::Sphere => LightShape::Sphere { center, radius: ROUND_RADIUS },
    }
}

/// As `timed_fraction` of each shape reads them: points and directions, a radius or width beside the first.
pub fn light_points(lights: &[LightShape]) -> Vec<[f32; 4]> {
    let four = |v: Vec3, w: f32| [v.x, v.y, v.z, w];
    let one = |light: &LightShape| match light {
        LightShape::Quad { corners, .. } => corners.map(|c| four(c, 0.0)).to_vec(),
        LightShape::Polygon { vertices, .. } => vertices.iter().map(|v| four(*v, 0.0)).collect(),
        LightShape::Line { p0, p1, radius, .. } | LightShape::Cylinder { p0, p1, radius, .. } => {
            vec![four(*p0, *radius), four(*p1, 0.0)]
        }
        LightShape::Strip { p0, p1, width, normal, .. } => {
            vec![four(*p0, *width), four(*p1, 0.0), four(*normal, 0.0)]
        }
        LightShape::Disk { center, normal, radius, .. } => vec![four(*center, *radius), four(*normal, 0.0)],
        LightShape::Ellipse { center, axis_u, axis_v, .. } => {
            vec![four(*center, 0.0), four(*axis_u, 0.0), four(*axis_v, 0.0)]
        }
        LightShape::Sphere { center, radius } => vec![four(*center, *radius)],
    };
    lights.iter().flat_map(one).collect()
}

/// As a storage buffer holds them.
pub fn point_bytes(points: &[[f32; 4]]) -> Vec<u8> {
    points.iter().flatten().flat_map(|x| x.to_le_bytes()).collect()
}

/// The fraction of the lobe that sees a light from a pixel, in `f64`.
///
/// # Errors
/// Those of the lobe and the light.
pub fn fraction(light: &LightShape, pixel: &Pixel, m: DMat3, horizon: Horizon) -> Result<f64, StudyError> {
    let ltc = Ltc::<f64>::new(m)?;
    Ok(seen_from(light, pixel.position.as_dvec3()).integrate(&ltc, horizon)?)
}

/// The light relative to a place. The floor's numbers are such that the differences round to 2^-24 of a unit.
fn seen_from(light: &LightShape, place: DVec3) -> LightShape {
    let to = |p: &mut Vec3| *p = (p.as_dvec3() - place).as_vec3();
    let mut light = light.clone();
    match &mut light {
        LightShape::Quad { corners, .. } => corners.iter_mut().for_each(to),
        LightShape::Polygon { vertices, .. } => vertices.iter_mut().for_each(to),
        LightShape::Line { p0, p1, .. }
        | LightShape::Cylinder { p0, p1, .. }
        | LightShape::Strip { p0, p1, .. } => {
            to(p0);
            to(p1);
        }
        LightShape::Disk { center, .. }
        | LightShape::Ellipse { center, .. }
        | LightShape::Sphere { center, .. } => to(center),
    }
    light
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_light_faces_the_floor_and_is_seen_somewhere() -> Result<(), StudyError> {
        let pixels = pixels(16, 9, Materials::Anisotropic);
        for kind in LightKind::ALL {
            let mut leaning = 0;
            for light in lights(kind, 8, false) {
                let seen = |m: fn(&Pixel) -> DMat3| {
                    let all = pixels.iter().map(|p| fraction(&light, p, m(p), Horizon::BOTH));
                    let all: Vec<f64> = all.collect::<Result<_, _>>()?;
                    assert!(all.iter().all(|f| (0.0..=1.0).contains(f)), "{kind}");
                    Ok::<usize, StudyError>(all.iter().filter(|f| **f > 0.0).count())
                };
                assert_eq!(seen(|_| DMat3::IDENTITY)?, 144, "{kind}: Lambert's lobe sees it from everywhere");
                leaning += seen(Pixel::matrix)?;
            }
            // Lobes that lean away see nothing, others all or a part: forms meet all three.
            assert!((8 * 144 / 4..8 * 144 * 9 / 10).contains(&leaning), "{kind}: {leaning}");
        }
        Ok(())
    }

    #[test]
    fn scattered_pixels_are_the_same_pixels() {
        let sorted = |materials| {
            let mut all: Vec<[u32; 2]> =
                pixels(32, 18, materials).iter().map(|p| [p.wo.x.to_bits(), p.wo.y.to_bits()]).collect();
            all.sort_unstable();
            all
        };
        assert_eq!(sorted(Materials::Scattered), sorted(Materials::Anisotropic));
        let scattered = pixels(32, 18, Materials::Scattered);
        assert_ne!(scattered, pixels(32, 18, Materials::Anisotropic));
    }
}
