//! Random textured lights, and the ways to integrate them that the workspace has.

use std::sync::LazyLock;

use glam::{DMat3, DVec3, Mat3, Vec3};
use ltc_core::points::SplitMix64;
use ltc_core::{
    Horizon, InputError, Ltc, Matrix as _, PrefilteredTexture, Real, Sides, TexelGrid, TextureFrame,
    TexturedPolygon, Vector,
};
use ltc_shade_gpu::{Gpu, LightKind, LightShape, LightTexture, LightTextures, TexturedJob, TexturedLights};
use ltc_table::{Query, Table};

use crate::devices::on_each_device;
use crate::light_jobs;

/// Pictures that are hard in different ways; `Texture::brightest` is what errors are measured by.
pub fn textures() -> Vec<PrefilteredTexture> {
    let mut rng = SplitMix64::new(9);
    let mut unit = move || rng.unit() as f32;
    let mut noise = |width: usize, height: usize, scale: f32| {
        let colours: Vec<[f32; 3]> = (0..width * height).map(|_| [scale * unit(), unit(), unit()]).collect();
        texture(width, height, &colours)
    };
    let noisy = [noise(64, 64, 1.0), noise(37, 5, 1.0), noise(1, 9, 1.0), noise(16, 16, 0.01)];
    let checker: Vec<[f32; 3]> = (0..64).map(|k| [((k % 8 / 2 + k / 16) % 2) as f32; 3]).collect();
    let mut sun = vec![[0.01, 0.02, 0.03]; 32 * 32];
    sun[32 * 11 + 20] = [6e4, 5e4, 4e4];
    let mut all = noisy.to_vec();
    all.push(texture(8, 8, &checker));
    all.push(texture(32, 32, &sun));
    all.push(texture(1, 1, &[[0.5, 1.0, 2.0]]));
    all.push(texture(4, 4, &[[0.0; 3]; 16]));
    all
}

/// A picture without coverage.
///
/// # Panics
/// When it is none.
pub fn texture(width: usize, height: usize, colours: &[[f32; 3]]) -> PrefilteredTexture {
    match PrefilteredTexture::new(TexelGrid { width, height, colours, coverage: None }) {
        Ok(texture) => texture,
        Err(error) => panic!("{error}"),
    }
}

/// One way to integrate textured lights under lobes.
pub trait TexturedBackEnd {
    /// Its name in messages.
    fn name(&self) -> String;

    /// The fraction of each job's lobe that sees its light, times the colour.
    ///
    /// # Errors
    /// The words of the first refusal; nothing is computed then.
    fn colours(&self, jobs: &[TexturedJob]) -> Result<Vec<[f64; 3]>, String>;
}

/// `ltc_core` in a precision, from the same `f32` numbers; in double precision the truth of the formula.
#[derive(Debug)]
pub struct TexturedOnCpu<R> {
    textures: Vec<PrefilteredTexture>,
    precision: core::marker::PhantomData<R>,
}

impl<R: Real> TexturedOnCpu<R> {
    /// With these textures.
    pub fn new(textures: &[PrefilteredTexture]) -> Self {
        Self { textures: textures.to_vec(), precision: core::marker::PhantomData }
    }

    fn one(&self, job: &TexturedJob) -> Result<[f64; 3], InputError> {
        let v = |p: &Vec3| R::Vec3::new(R::of(p.x.into()), R::of(p.y.into()), R::of(p.z.into()));
        let ltc = Ltc::<R>::new(R::Mat3::from_row_array(job.m.map(|x| R::of(x.into()))))?;
        let (vertices, sides): (Vec<R::Vec3>, Sides) = match &job.light {
            LightShape::Quad { corners, sides } => (corners.iter().map(v).collect(), *sides),
            LightShape::Polygon { vertices, sides } => (vertices.iter().map(v).collect(), *sides),
            _ => return Err(InputError::Degenerate { name: "light" }),
        };
        let TextureFrame { origin, axis_u, axis_v } = &job.texture.frame;
        let frame = TextureFrame { origin: v(origin), axis_u: v(axis_u), axis_v: v(axis_v) };
        let texture = &self.textures[job.texture.number];
        let light = TexturedPolygon::<R>::new(&vertices, sides, frame, texture)?;
        Ok(light.integrate_colour(&ltc, Horizon::BOTH).map(Real::to_f64))
    }
}

impl<R: Real> TexturedBackEnd for TexturedOnCpu<R> {
    fn name(&self) -> String {
        format!("CPU f{}", 8 * size_of::<R>())
    }

    fn colours(&self, jobs: &[TexturedJob]) -> Result<Vec<[f64; 3]>, String> {
        jobs.iter().map(|job| self.one(job).map_err(|e| e.to_string())).collect()
    }
}

/// `ltc_shade_gpu` on a device, with [`textures`].
#[derive(Debug)]
pub struct TexturedOnGpu {
    gpu: Gpu,
    lights: TexturedLights,
}

/// Those that can run here, opened once for all tests of a process.
static DEVICES: LazyLock<Vec<TexturedOnGpu>> = LazyLock::new(TexturedOnGpu::all);

impl TexturedOnGpu {
    fn all() -> Vec<Self> {
        let lights = |gpu: &Gpu| TexturedLights::new(gpu, LightTextures::upload(gpu, &textures())?);
        on_each_device(lights).into_iter().map(|(gpu, lights)| Self { gpu, lights }).collect()
    }
}

impl TexturedBackEnd for &'static TexturedOnGpu {
    fn name(&self) -> String {
        self.gpu.info().to_string()
    }

    fn colours(&self, jobs: &[TexturedJob]) -> Result<Vec<[f64; 3]>, String> {
        let results = self.lights.integrate(&self.gpu, jobs).map_err(|e| e.to_string())?;
        Ok(results.into_iter().map(|colour| colour.map(f64::from)).collect())
    }
}

/// Every back end that can run here but the truth.
pub fn textured_back_ends() -> Vec<Box<dyn TexturedBackEnd>> {
    let mut list: Vec<Box<dyn TexturedBackEnd>> = vec![Box::new(TexturedOnCpu::<f32>::new(&textures()))];
    list.extend(DEVICES.iter().map(|gpu| Box::new(gpu) as _));
    list
}

/// The jobs of [`light_jobs`] with one of `count` textures each: quads are filled, polygons lie anyhow in their texture's plane.
///
/// # Panics
/// When the table refuses a query.
pub fn textured_jobs(
    kind: LightKind,
    table: &Table,
    queries: &[Query],
    seed: u64,
    count: usize,
) -> Vec<TexturedJob> {
    let mut rng = SplitMix64::new(seed ^ 0xFACE);
    let jobs = light_jobs(kind, table, queries, seed);
    let textured = jobs.into_iter().enumerate().map(|(i, job)| {
        let number = i % count;
        let texture = match &job.light {
            LightShape::Quad { corners, .. } => LightTexture::filling(number, corners),
            LightShape::Polygon { vertices, .. } => {
                LightTexture { number, frame: frame_around(vertices, &mut rng) }
            }
            other => panic!("no texture on {other:?}"),
        };
        TexturedJob { m: job.m, light: job.light, texture }
    });
    textured.collect()
}

/// A parallelogram in the polygon's plane, turned and sheared, with the polygon about its middle and in parts beyond it.
fn frame_around(vertices: &[Vec3], rng: &mut SplitMix64) -> TextureFrame<f32> {
    let points: Vec<DVec3> = vertices.iter().map(|v| v.as_dvec3()).collect();
    let middle = points.iter().sum::<DVec3>() / points.len() as f64;
    let area: DVec3 =
        (0..points.len()).map(|i| (points[i] - middle).cross(points[(i + 1) % points.len()] - middle)).sum();
    let reach = points.iter().map(|p| (*p - middle).length()).fold(0.0, f64::max);
    let normal = area.normalize_or(DVec3::Z);
    let x = DMat3::from_axis_angle(normal, rng.range(0.0, 6.3)) * normal.any_orthonormal_vector();
    let (u, v) = (
        x * (reach * rng.range(0.7, 2.5)),
        (normal.cross(x) + x * rng.range(-0.5, 0.5)) * (reach * rng.range(0.7, 2.5)),
    );
    let origin = middle - (u + v) * 0.5;
    TextureFrame { origin: origin.as_vec3(), axis_u: u.as_vec3(), axis_v: v.as_vec3() }
}

/// The lobe's `M`.
pub fn textured_matrix(job: &TexturedJob) -> DMat3 {
    Mat3::from_row_array(job.m).as_dmat3()
}
