//! `ltc integrate`

use anyhow::Result;
use clap::{Args, ValueEnum};
use ltc_lines::{Answer, Integration};
use ltc_shade_gpu::{Gpu, GpuOptions, LightJob, LightShape, Lights};

use crate::{json_lines, tables::Tables};

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

impl Integrate {
    pub fn run(self, tables: &Tables) -> Result<()> {
        let catalogue = tables.catalogue()?;
        anyhow::ensure!(
            self.backend == Backend::Cpu || self.precision == Precision::F32,
            "--backend gpu computes in f32 alone; leave out --precision f64"
        );
        if self.backend == Backend::Gpu {
            let gpu = Gpu::new(GpuOptions::default())?;
            let lights = Lights::new(&gpu)?;
            return json_lines::run(|line| on_gpu(&gpu, &lights, &Integration::parse(&catalogue, line)?));
        }
        match self.precision {
            Precision::F32 => json_lines::run(|line| Integration::parse(&catalogue, line)?.on_cpu::<f32>()),
            Precision::F64 => json_lines::run(|line| Integration::parse(&catalogue, line)?.on_cpu::<f64>()),
        }
    }
}

fn on_gpu(gpu: &Gpu, lights: &Lights, job: &Integration) -> Result<Answer, String> {
    // What f64 refuses, NaN and degenerate matrices, is refused in the same words here.
    job.on_cpu::<f64>()?;
    let light = LightShape::from(&job.light);
    let job_of = |(_, m): &(f64, [f64; 9])| LightJob { m: m.map(|x| x as f32), light: light.clone() };
    let jobs: Vec<_> = job.lobes.iter().map(job_of).collect();
    let fractions = lights.integrate(gpu, &jobs).map_err(|e| e.to_string())?;
    let value = job.lobes.iter().zip(fractions).map(|((weight, _), f)| weight * f64::from(f)).sum();
    Ok(Answer { value, precision: "f32" })
}
