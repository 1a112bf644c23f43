//! Random lights of every kind, and the ways to integrate them that the workspace has.

use std::sync::LazyLock;

use glam::{DMat3, DVec3, Mat3, Vec3};
use ltc_core::points::SplitMix64;
use ltc_core::{Horizon, Ltc, Matrix as _, Sides};
use ltc_shade_gpu::{Gpu, LightJob, LightKind, LightShape, Lights};
use ltc_table::{Query, Table};

use crate::devices::on_each_device;
use crate::shapes;

/// One way to integrate lights of every kind under lobes.
pub trait LightBackEnd {
    /// Its name in messages.
    fn name(&self) -> String;

    /// The fraction of each job's lobe that sees its light.
    ///
    /// # Errors
    /// The words of the first refusal; nothing is computed then.
    fn fractions(&self, jobs: &[LightJob]) -> Result<Vec<f64>, String>;
}

/// `ltc_core` in double precision, from the same `f32` numbers: the truth of the closed form.
#[derive(Clone, Copy, Debug)]
pub struct LightsF64;

/// `ltc_core` in single precision.
#[derive(Clone, Copy, Debug)]
pub struct LightsF32;

/// `ltc_shade_gpu` on a device.
#[derive(Debug)]
pub struct LightsOnGpu {
    gpu: Gpu,
    lights: Lights,
}

/// Those that can run here, opened once for all tests of a process.
static DEVICES: LazyLock<Vec<LightsOnGpu>> = LazyLock::new(LightsOnGpu::all);

impl LightBackEnd for LightsF64 {
    fn name(&self) -> String {
        "CPU f64".to_owned()
    }

    fn fractions(&self, jobs: &[LightJob]) -> Result<Vec<f64>, String> {
        let one = |job: &LightJob| {
            let ltc = Ltc::<f64>::new(matrix(job)).map_err(|e| e.to_string())?;
            job.light.integrate(&ltc, Horizon::BOTH).map_err(|e| e.to_string())
        };
        jobs.iter().map(one).collect()
    }
}

impl LightBackEnd for LightsF32 {
    fn name(&self) -> String {
        "CPU f32".to_owned()
    }

    fn fractions(&self, jobs: &[LightJob]) -> Result<Vec<f64>, String> {
        let one = |job: &LightJob| {
            let ltc = Ltc::<f32>::new(Mat3::from_row_array(job.m)).map_err(|e| e.to_string())?;
            job.light.integrate(&ltc, Horizon::BOTH).map(f64::from).map_err(|e| e.to_string())
        };
        jobs.iter().map(one).collect()
    }
}

impl LightsOnGpu {
    fn all() -> Vec<Self> {
        on_each_device(Lights::new).into_iter().map(|(gpu, lights)| Self { gpu, lights }).collect()
    }
}

impl LightBackEnd for &'static LightsOnGpu {
    fn name(&self) -> String {
        self.gpu.info().to_string()
    }

    fn fractions(&self, jobs: &[LightJob]) -> Result<Vec<f64>, String> {
        let results = self.lights.integrate(&self.gpu, jobs).map_err(|e| e.to_string())?;
        Ok(results.into_iter().map(f64::from).collect())
    }
}

/// Every back end that can run here but the truth.
pub fn light_back_ends() -> Vec<Box<dyn LightBackEnd>> {
    let mut list: Vec<Box<dyn LightBackEnd>> = vec![Box::new(LightsF32)];
    list.extend(DEVICES.iter().map(|gpu| Box::new(gpu) as _));
    list
}

/// The lobe's `M`.
pub fn matrix(job: &LightJob) -> DMat3 {
    DMat3::from_row_array(job.m.map(f64::from))
}

/// The ratio of the largest to the smallest singular value.
pub fn condition(m: DMat3) -> f64 {
    let largest = |m: DMat3| {
        let gram = m.transpose() * m;
        let mut v = DVec3::new(0.6, 0.5, 0.7);
        for _ in 0..60 {
            v = (gram * v).normalize_or(DVec3::X);
        }
        (gram * v).length().sqrt()
    };
    largest(m) * largest(m.inverse())
}

/// The lobes of these queries, with a light of this kind each: most of them around the mirror direction, 0.1 to 10 away, their
/// half-sizes 0.03 to 1.5 of that (thin ones 0.002 to 0.1 thick), tilted anywhere, above and below the horizon.
///
/// # Panics
/// When the table refuses a query.
pub fn light_jobs(kind: LightKind, table: &Table, queries: &[Query], seed: u64) -> Vec<LightJob> {
    let mut rng = SplitMix64::new(seed);
    let job = |query: &Query| {
        let lookup = match table.lookup(query) {
            Ok(lookup) => lookup,
            Err(error) => panic!("{query:?}: {error}"),
        };
        let m = lookup.lobes[0].m.map(|x| x as f32);
        LightJob { m, light: light(kind, query, &mut rng) }
    };
    queries.iter().map(job).collect()
}

fn light(kind: LightKind, query: &Query, rng: &mut SplitMix64) -> LightShape {
    let wo = ltc_fit::direction(query.theta, query.phi);
    let mirror = DVec3::new(-wo.x, -wo.y, wo.z);
    let distance = 0.1 * 100.0_f64.powf(rng.unit());
    let spread = if rng.unit() < 0.8 { 0.4 } else { 2.0 };
    let centre = (mirror + shapes::in_cube(rng) * spread) * distance;
    let size = |rng: &mut SplitMix64| distance * 0.03 * 50.0_f64.powf(rng.unit());
    let (u, v) = shapes::tangents(shapes::in_cube(rng));
    let (u, v) = (u * size(rng), v * size(rng));
    let single = |v: DVec3| v.as_vec3();
    let (p0, p1) = (single(centre - u), single(centre + u));
    let center = single(centre);
    let sides = if rng.unit() < 0.5 { Sides::One } else { Sides::Two };
    let caps = rng.unit() < 0.5;
    let thin = (distance * 0.002 * 50.0_f64.powf(rng.unit())) as f32;
    // No wider than the nearest point is far.
    let thin = thin.min(nearest(p0, p1));
    match kind {
        LightKind::Quad => {
            LightShape::Quad { corners: shapes::parallelogram(centre, u, v).map(single), sides }
        }
        LightKind::Polygon => {
            let corners = 3 + (rng.unit() * 10.0) as usize;
            let vertices = shapes::star(rng, centre, u.length(), corners);
            LightShape::Polygon { vertices: vertices.into_iter().map(single).collect(), sides }
        }
        LightKind::Line => LightShape::Line { p0, p1, radius: thin, caps: false },
        LightKind::LineWithCaps => LightShape::Line { p0, p1, radius: thin, caps: true },
        LightKind::Strip => LightShape::Strip { p0, p1, width: thin, normal: single(v), sides },
        LightKind::Cylinder => LightShape::Cylinder { p0, p1, radius: v.length() as f32, caps },
        LightKind::Disk => {
            LightShape::Disk { center, normal: single(u.cross(v)), radius: u.length() as f32, sides }
        }
        LightKind::Ellipse => {
            // Conjugate half-axes, not at right angles.
            LightShape::Ellipse { center, axis_u: single(u + v * 0.5), axis_v: single(v), sides }
        }
        LightKind::Sphere => LightShape::Sphere { center, radius: u.length() as f32 },
    }
}

/// The distance of the segment's nearest point.
fn nearest(p0: Vec3, p1: Vec3) -> f32 {
    let along = p1 - p0;
    let t = (-p0.dot(along) / along.length_squared()).clamp(0.0, 1.0);
    (p0 + along * t).length()
}
