//! `ltc probe`

use anyhow::{Result, bail};
use clap::Args;
use ltc_shade_gpu::{Gpu, GpuOptions, ProbeReport, Verdict, probe};

/// Tests this machine's GPU: what its shaders compute of small known cases, by feature.
///
/// The exit code is 0 when nothing is off. WGPU_BACKEND (vulkan, gl, metal, dx12) chooses the interface.
///
/// Example: ltc probe --json
#[derive(Args)]
pub struct Probe {
    /// The software driver, although there is hardware.
    #[arg(long)]
    software: bool,
    /// Prints the findings as JSON.
    #[arg(long)]
    json: bool,
}

impl Probe {
    pub fn run(self) -> Result<()> {
        let options = GpuOptions { software_only: self.software, ..GpuOptions::default() };
        let report = probe(&Gpu::new(options)?)?;
        if self.json {
            outln!("{:#}", json(&report));
        } else {
            out!("{report}");
        }
        let off: Vec<_> = report.findings.iter().filter(|f| f.verdict == Verdict::Off).collect();
        if !off.is_empty() {
            let names: Vec<_> = off.iter().map(|finding| finding.feature.as_str()).collect();
            bail!("off on this device: {}", names.join(", "))
        }
        Ok(())
    }
}

/// Numbers that are not finite become null.
fn json(report: &ProbeReport) -> serde_json::Value {
    let device = &report.device;
    let findings: Vec<_> = report
        .findings
        .iter()
        .map(|finding| {
            serde_json::json!({
                "feature": finding.feature,
                "verdict": finding.verdict.name(),
                "measured": finding.measured,
                "allowed": finding.allowed,
                "note": finding.note,
            })
        })
        .collect();
    serde_json::json!({
        "good": report.is_good(),
        "device": {
            "name": device.name,
            "backend": device.backend,
            "driver": device.driver,
            "software": device.software,
        },
        "findings": findings,
    })
}
