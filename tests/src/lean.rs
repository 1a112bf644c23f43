//! Lean lights on a device: the functions as an engine composes them.

use std::sync::LazyLock;

use glam::Vec4;
use ltc_core::Sides;
use ltc_shade_gpu::modules::compose;
use ltc_shade_gpu::timing::{PixelGrid, PixelProgram, PixelSource, Resource, Stage};
use ltc_shade_gpu::{Gpu, LightJob, LightShape};

use crate::LightBackEnd;
use crate::devices::on_each_device;

/// Seven vectors a job: the columns of M, and what the call takes.
const MAIN: &str = "
@group(1) @binding(0) var<storage, read> jobs: array<vec4f>;

fn pixel(at: vec2u, index: u32) -> vec4f {
    let first = 7u * index;
    let lobe = ltc_lobe(mat3x3f(jobs[first].xyz, jobs[first + 1u].xyz, jobs[first + 2u].xyz));
    let a = jobs[first + 3u];
    let b = jobs[first + 4u];
    let c = jobs[first + 5u];
    let d = jobs[first + 6u];
    return vec4f(CALL, 0.0, 0.0, 0.0);
}
";
const SYMBOLS: [&str; 4] = ["surface_horizon", "cosine_horizon", "two_sided", "lean_lights"];
/// Pixels in a row.
const WIDTH: u32 = 256;

/// Lights of the feature `lean-lights`; the jobs are of one kind.
#[derive(Debug)]
pub struct LeanLights {
    gpu: Gpu,
}

static DEVICES: LazyLock<Vec<LeanLights>> =
    LazyLock::new(|| on_each_device(|_| Ok(())).into_iter().map(|(gpu, ())| LeanLights { gpu }).collect());

/// On every device that can run here.
pub fn lean_lights() -> &'static [LeanLights] {
    &DEVICES
}

impl LightBackEnd for LeanLights {
    fn name(&self) -> String {
        format!("lean, {}", self.gpu.info())
    }

    fn fractions(&self, jobs: &[LightJob]) -> Result<Vec<f64>, String> {
        let height = (jobs.len() as u32).div_ceil(WIDTH);
        let mut numbers = jobs.iter().map(record).collect::<Result<Vec<_>, _>>()?.concat();
        // Pixels beyond the jobs find a matrix of zeros, which is no lobe.
        numbers.resize((7 * 4 * WIDTH * height) as usize, 0.0);
        let bytes: Vec<u8> = numbers.into_iter().flat_map(f32::to_le_bytes).collect();
        let (module, call) = call(jobs.first().map(|job| &job.light))?;
        let wgsl = format!("{}\n{}", compose(&[module], &SYMBOLS), MAIN.replace("CALL", call));
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

/// The module of a kind of light, and the call.
fn call(light: Option<&LightShape>) -> Result<(&'static str, &'static str), String> {
    Ok(match light {
        Some(LightShape::Quad { .. }) => ("quad", "ltc_quad(lobe, a.xyz, b.xyz, c.xyz, d.xyz, a.w != 0.0)"),
        Some(LightShape::Line { .. }) => ("line", "ltc_line(lobe, a.xyz, b.xyz, a.w)"),
        Some(LightShape::Strip { .. }) => ("strip", "ltc_strip(lobe, a.xyz, b.xyz, a.w, c.xyz, b.w != 0.0)"),
        _ => return Err("no lean light".to_owned()),
    })
}

fn record(job: &LightJob) -> Result<Vec<f32>, String> {
    let m = job.m;
    let mut numbers = vec![m[0], m[3], m[6], 0.0, m[1], m[4], m[7], 0.0, m[2], m[5], m[8], 0.0];
    let flag = |sides: Sides| if sides == Sides::Two { 1.0 } else { 0.0 };
    let vectors = match &job.light {
        LightShape::Quad { corners: [a, b, c, d], sides } => {
            [a.extend(flag(*sides)), b.extend(0.0), c.extend(0.0), d.extend(0.0)]
        }
        LightShape::Line { p0, p1, radius, caps: false } => {
            [p0.extend(*radius), p1.extend(0.0), Vec4::ZERO, Vec4::ZERO]
        }
        LightShape::Strip { p0, p1, width, normal, sides } => {
            [p0.extend(*width), p1.extend(flag(*sides)), normal.extend(0.0), Vec4::ZERO]
        }
        _ => return Err("no lean light".to_owned()),
    };
    numbers.extend(vectors.iter().flat_map(Vec4::to_array));
    Ok(numbers)
}
