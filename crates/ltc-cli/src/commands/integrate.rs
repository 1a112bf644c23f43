//! `ltc integrate`

use anyhow::Result;
use clap::{Args, ValueEnum};
use glam::DMat3;
use ltc_core::{AnyLight, Horizon, Ltc, Matrix, Real};
use ltc_shade_gpu::{Gpu, GpuOptions, PolygonJob, Polygons};
use ltc_table::{Catalogue, Query};
use serde::{Deserialize, Serialize};

use crate::{json_lines, light_json::LightJson, tables::Tables};

/// Integrates lobes over lights: JSON lines on stdin, JSON lines on stdout.
///
/// In: `{"m":[9 numbers, row-major]}` or `{"table":NAME,"theta":…,"phi":…,"alpha_x":…,"alpha_y":…}`, and a `"light"`, seen
/// from the shading point at the origin in the shading frame, one of
/// `{"type":"polygon","vertices":[[x,y,z],…],"two_sided":false}`, counter-clockwise seen from its emitting side;
/// `{"type":"line","p0":…,"p1":…,"radius":r}`, a thin tube, approximately;
/// `{"type":"strip","p0":…,"p1":…,"width":w,"normal":[…],"two_sided":false}`, a thin rectangle, approximately;
/// `{"type":"cylinder","p0":…,"p1":…,"radius":r,"caps":false}`;
/// `{"type":"disk","center":…,"normal":…,"radius":r,"two_sided":false}`;
/// `{"type":"ellipse","center":…,"axis_u":…,"axis_v":…,"two_sided":false}`; `{"type":"sphere","center":…,"radius":r}`.
/// Out: `{"value":v,"precision":"f32"}`, v in 0 to 1 the fraction of the lobe that sees the light. A degenerate light
/// gives 0, a bad line `{"error":"…"}`.
///
/// Example: `echo '{"m":[1,0,0,0,1,0,0,0,1],"light":{"type":"polygon","vertices":[[0,0,1],[0,1,1],[1,0,1]]}}' | ltc integrate`
#[derive(Args)]
pub struct Integrate {
    /// Precision of the arithmetic.
    #[arg(long, value_enum, default_value_t = Precision::F32)]
    precision: Precision,
    /// Where to compute; the GPU has f32 alone.
    #[arg(long, value_enum, default_value_t = Backend::Cpu)]
    backend: Backend,
    /// Output is JSON in any case.
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Precision {
    F32,
    F64,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Backend {
    Cpu,
    Gpu,
}

/// One line of input.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Line {
    m: Option<[f64; 9]>,
    table: Option<String>,
    theta: Option<f64>,
    phi: Option<f64>,
    alpha_x: Option<f64>,
    alpha_y: Option<f64>,
    light: LightJson,
}

#[derive(Serialize)]
struct Answer {
    value: f64,
    precision: &'static str,
}

/// A line understood: lobes with their weights, and a light.
struct Job {
    lobes: Vec<(f64, [f64; 9])>,
    light: AnyLight,
}

impl Integrate {
    pub fn run(self, tables: &Tables) -> Result<()> {
        let catalogue = tables.catalogue()?;
        anyhow::ensure!(
            self.backend == Backend::Cpu || self.precision == Precision::F32,
            "--backend gpu computes in f32 alone; leave out --precision f64"
        );
        if self.backend == Backend::Gpu {
            let gpu = Gpu::new(GpuOptions::default())?;
            let polygons = Polygons::new(&gpu)?;
            return json_lines::run(|line| on_gpu(&gpu, &polygons, &job(&catalogue, line)?));
        }
        let evaluate = match self.precision {
            Precision::F32 => on_cpu::<f32>,
            Precision::F64 => on_cpu::<f64>,
        };
        json_lines::run(|line| evaluate(&job(&catalogue, line)?))
    }
}

fn job(catalogue: &Catalogue, line: &str) -> Result<Job, String> {
    let line: Line = json_lines::object(line)?;
    let lobes = lobes(catalogue, &line)?;
    Ok(Job { lobes, light: line.light.into() })
}

fn lobes(catalogue: &Catalogue, line: &Line) -> Result<Vec<(f64, [f64; 9])>, String> {
    match (line, &line.m, &line.table) {
        (Line { theta: None, phi: None, alpha_x: None, alpha_y: None, .. }, Some(m), None) => {
            Ok(vec![(1.0, *m)])
        }
        (
            Line { theta: Some(theta), phi, alpha_x: Some(alpha_x), alpha_y: Some(alpha_y), .. },
            None,
            Some(table),
        ) => {
            let table = catalogue.find(table).map_err(|e| e.to_string())?.table();
            let phi = phi.unwrap_or(0.0);
            let query = Query { theta: *theta, phi, alpha_x: *alpha_x, alpha_y: *alpha_y };
            let lookup = table.lookup(&query).map_err(|e| e.to_string())?;
            Ok(lookup.lobes.into_iter().map(|lobe| (lobe.weight, lobe.m)).collect())
        }
        _ => {
            Err("give either \"m\", or \"table\" with \"theta\", \"phi\", \"alpha_x\" and \"alpha_y\""
                .to_owned())
        }
    }
}

fn on_cpu<R: Real>(job: &Job) -> Result<Answer, String> {
    let mut value = 0.0;
    for (weight, m) in &job.lobes {
        let ltc = Ltc::<R>::new(R::Mat3::from_row_array(m.map(R::of))).map_err(|e| e.to_string())?;
        let fraction = job.light.integrate(&ltc, Horizon::BOTH).map_err(|e| e.to_string())?;
        value += weight * fraction.to_f64();
    }
    Ok(Answer { value, precision: if size_of::<R>() == 4 { "f32" } else { "f64" } })
}

fn on_gpu(gpu: &Gpu, polygons: &Polygons, job: &Job) -> Result<Answer, String> {
    let AnyLight::Polygon { vertices, sides } = &job.light else {
        let name = job.light.name();
        return Err(format!("--backend gpu has polygons alone, no {name} yet; --backend cpu has all"));
    };
    let vertices: Vec<[f32; 3]> = vertices.iter().map(|v| v.map(|x| x as f32)).collect();
    let mut value = 0.0;
    for (weight, m) in &job.lobes {
        // What f64 refuses, NaN and degenerate matrices, is refused in the same words here.
        let exact = Ltc::<f64>::new(DMat3::from_row_array(*m)).map_err(|e| e.to_string())?;
        job.light.integrate(&exact, Horizon::BOTH).map_err(|e| e.to_string())?;
        let job = PolygonJob { m: m.map(|x| x as f32), vertices: &vertices, sides: *sides };
        let fraction = polygons.integrate(gpu, &[job]).map_err(|e| e.to_string())?;
        value += weight * f64::from(fraction[0]);
    }
    Ok(Answer { value, precision: "f32" })
}
