//! What lights, lookups and numbers of lights cost on the device at hand, in one run:
//! `cargo run --release -p ltc-shade-gpu --example light_cost`.
//!
//! Each figure is the least of several runs, and a difference of two: what reading and writing cost is in neither.

use std::time::Instant;

use glam::Vec3;
use ltc_core::Sides;
use ltc_shade_gpu::{
    AreaLight, Filtering, Gpu, GpuError, GpuOptions, LightShape, Shader, SurfacePoint, TableTextures, Tables,
};
use ltc_table::{Axis, CellStats, Mapping, Quantity, Table};

const POINTS: usize = 1 << 15;
const RUNS: usize = 5;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for filtering in [Filtering::Exact, Filtering::Hardware] {
        let gpu = match Gpu::new(GpuOptions { filtering, ..GpuOptions::default() }) {
            Ok(gpu) => gpu,
            Err(error @ GpuError::NotFilterable { .. }) => {
                println!("{filtering:?} skipped, because {error}");
                continue;
            }
            Err(error) => return Err(error.into()),
        };
        println!("{filtering:?} interpolation, {}", gpu.info());
        let bench = Bench::new(&gpu)?;
        bench.lookups()?;
        if filtering == Filtering::Exact {
            bench.kinds()?;
            bench.counts()?;
        }
    }
    Ok(())
}

struct Bench<'a> {
    gpu: &'a Gpu,
    shader: Shader,
    isotropic: TableTextures,
    anisotropic: TableTextures,
}

impl<'a> Bench<'a> {
    fn new(gpu: &'a Gpu) -> Result<Self, Box<dyn std::error::Error>> {
        Ok(Self {
            gpu,
            shader: Shader::new(gpu)?,
            isotropic: TableTextures::upload(gpu, &table(&[64, 64])?)?,
            anisotropic: TableTextures::upload(gpu, &table(&[8, 8, 8, 8])?)?,
        })
    }

    /// Nanoseconds for each point, the least of several runs.
    fn time(&self, isotropic: bool, lights: &[AreaLight]) -> Result<f64, GpuError> {
        let points: Vec<_> = (0..POINTS).map(|i| point(i, isotropic)).collect();
        let tables = Tables {
            isotropic: Some(&self.isotropic),
            anisotropic: Some(&self.anisotropic),
            ..Tables::default()
        };
        let mut least = f64::INFINITY;
        for _ in 0..RUNS {
            let start = Instant::now();
            self.shader.shade(self.gpu, tables, &points, lights)?;
            least = least.min(start.elapsed().as_secs_f64());
        }
        Ok(least * 1e9 / POINTS as f64)
    }

    fn lookups(&self) -> Result<(), GpuError> {
        let [isotropic, anisotropic] = [self.time(true, &[])?, self.time(false, &[])?];
        println!("  a point without lights: isotropic {isotropic:.0} ns, anisotropic {anisotropic:.0} ns");
        Ok(())
    }

    fn kinds(&self) -> Result<(), GpuError> {
        for shape in shapes() {
            let name = shape.kind();
            let [one, many] = [2, 18].map(|count| self.time(true, &vec![light(shape.clone()); count]));
            println!("  {name}: {:.0} ns a light under one lobe", (many? - one?) / 16.0);
        }
        Ok(())
    }

    fn counts(&self) -> Result<(), GpuError> {
        let Some(quad) = shapes().into_iter().next() else { return Ok(()) };
        for count in [2, 4, 8, 16, 64] {
            let time = self.time(true, &vec![light(quad.clone()); count])?;
            println!("  {count} quads: {time:.0} ns a point, {:.0} ns a light", time / count as f64);
        }
        Ok(())
    }
}

fn light(shape: LightShape) -> AreaLight {
    AreaLight::new(shape, Vec3::ONE)
}

fn shapes() -> Vec<LightShape> {
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, y]| Vec3::new(x, y, 2.0));
    let (p0, p1) = (Vec3::new(-1.0, 0.2, 2.0), Vec3::new(1.0, 0.0, 2.0));
    let (center, normal, sides) = (Vec3::Z * 2.0, -Vec3::Z, Sides::Two);
    vec![
        LightShape::Quad { corners, sides },
        LightShape::Polygon { vertices: corners.to_vec(), sides },
        LightShape::Line { p0, p1, radius: 0.05, caps: false },
        LightShape::Line { p0, p1, radius: 0.05, caps: true },
        LightShape::Strip { p0, p1, width: 0.1, normal, sides },
        LightShape::Cylinder { p0, p1, radius: 0.3, caps: true },
        LightShape::Disk { center, normal, radius: 1.0, sides },
        LightShape::Ellipse { center, axis_u: Vec3::X, axis_v: Vec3::Y * 0.5, sides },
        LightShape::Sphere { center, radius: 0.5 },
    ]
}

/// A black point, so that one lobe alone is integrated.
fn point(i: usize, isotropic: bool) -> SurfacePoint {
    let (x, y) = ((i % 256) as f32 / 128.0 - 1.0, (i / 256) as f32 / 64.0 - 1.0);
    SurfacePoint {
        position: Vec3::new(x, y, 0.0),
        normal: Vec3::Z,
        tangent: Vec3::X,
        wo: Vec3::new(0.5 + 0.3 * x, 0.2 * y, 1.0),
        alpha_x: 0.3 + 0.2 * x,
        alpha_y: if isotropic { 0.3 + 0.2 * x } else { 0.1 },
        slice: None,
        isotropic,
        f0: Vec3::ONE,
        f90: 1.0,
        albedo: Vec3::ZERO,
    }
}

/// A table of this shape: what it says does not matter here.
fn table(lengths: &[usize]) -> Result<Table, Box<dyn std::error::Error>> {
    let theta = |len| Axis::full(Quantity::Theta, Mapping::SqrtOneMinusCos, len);
    let alpha = |len| Axis::full(Quantity::Alpha, Mapping::Sqrt, len);
    let axes = match lengths {
        [t, a] => vec![theta(*t), alpha(*a)],
        [t, p, a, l, ..] => vec![
            theta(*t),
            Axis::full(Quantity::Phi, Mapping::Linear, *p),
            alpha(*a),
            Axis::full(Quantity::Lambda, Mapping::Linear, *l),
        ],
        _ => Vec::new(),
    };
    let count = lengths.iter().product();
    let m = glam::DMat3::from_diagonal(glam::DVec3::new(0.3, 0.2, 1.0));
    Ok(Table::new(axes, vec![m; count], vec![1.0; count], vec![0.1; count], CellStats::default())?)
}
