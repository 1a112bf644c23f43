//! Lean quads on a device: the functions as an engine composes them.

use std::sync::LazyLock;

use ltc_core::Sides;
use ltc_shade_gpu::modules::compose;
use ltc_shade_gpu::timing::{PixelGrid, PixelProgram, PixelSource, Resource, Stage};
use ltc_shade_gpu::{Gpu, LightJob, LightShape};

use crate::LightBackEnd;
use crate::devices::on_each_device;

/// Seven vectors a job: the columns of M, the corners, and in the last component of the first whether it has two sides.
const MAIN: &str = "
@group(1) @binding(0) var<storage, read> jobs: array<vec4f>;

fn pixel(at: vec2u, index: u32) -> vec4f {
    let first = 7u * index;
    let m = mat3x3f(jobs[first].xyz, jobs[first + 1u].xyz, jobs[first + 2u].xyz);
    let a = jobs[first + 3u];
    let seen = ltc_quad(ltc_lobe(m), a.xyz, jobs[first + 4u].xyz, jobs[first + 5u].xyz, jobs[first + 6u].xyz, a.w != 0.0);
    return vec4f(seen, 0.0, 0.0, 0.0);
}
";
const SYMBOLS: [&str; 4] = ["surface_horizon", "cosine_horizon", "two_sided", "lean_quads"];
/// Pixels in a row.
const WIDTH: u32 = 256;

/// `ltc_quad` of the feature `lean-quads`; jobs are quads.
#[derive(Debug)]
pub struct LeanQuads {
    gpu: Gpu,
}

static DEVICES: LazyLock<Vec<LeanQuads>> =
    LazyLock::new(|| on_each_device(|_| Ok(())).into_iter().map(|(gpu, ())| LeanQuads { gpu }).collect());

/// On every device that can run here.
pub fn lean_quads() -> &'static [LeanQuads] {
    &DEVICES
}

impl LightBackEnd for LeanQuads {
    fn name(&self) -> String {
        format!("lean quads, {}", self.gpu.info())
    }

    fn fractions(&self, jobs: &[LightJob]) -> Result<Vec<f64>, String> {
        let height = (jobs.len() as u32).div_ceil(WIDTH);
        let mut numbers = jobs.iter().map(record).collect::<Result<Vec<_>, _>>()?.concat();
        // Pixels beyond the jobs find a matrix of zeros, which is no lobe.
        numbers.resize((7 * 4 * WIDTH * height) as usize, 0.0);
        let bytes: Vec<u8> = numbers.into_iter().flat_map(f32::to_le_bytes).collect();
        let wgsl = format!("{}\n{MAIN}", compose(&["quad"], &SYMBOLS));
        let run = || {
            let grid = PixelGrid::new(&self.gpu, WIDTH, height)?;
            let resources = [Resource::storage(&self.gpu, &bytes)?];
            let stage = Stage::Compute;
            let source = PixelSource { wgsl: &wgsl, stage, tables: None, resources: &resources };
            PixelProgram::new(&self.gpu, &grid, &source)?.pixels(&self.gpu, &grid)
        };
        let pixels = run().map_err(|error: ltc_shade_gpu::GpuError| error.to_string())?;
        Ok(pixels.into_iter().take(jobs.len()).map(|[seen, ..]| f64::from(seen)).collect())
    }
}

fn record(job: &LightJob) -> Result<Vec<f32>, String> {
    let LightShape::Quad { corners, sides } = &job.light else { return Err("not a quad".to_owned()) };
    let m = job.m;
    let mut numbers = vec![m[0], m[3], m[6], 0.0, m[1], m[4], m[7], 0.0, m[2], m[5], m[8], 0.0];
    let two_sided = if *sides == Sides::Two { 1.0 } else { 0.0 };
    numbers.extend(corners.iter().flat_map(|c| [c.x, c.y, c.z, two_sided]));
    Ok(numbers)
}
