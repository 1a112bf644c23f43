//! A self-test for the user's device: small known cases, and by feature what comes out wrong.

mod arithmetic;
mod derivatives;
mod lights;
mod textured;
mod textures;

use std::fmt;

use crate::modules::{Program, compose};
use crate::{Gpu, GpuError, GpuInfo};

/// What came of one question.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// As it should be.
    Good,
    /// Worse than what the shaders count on.
    Off,
    /// The device does without; nothing that is on by default needs it.
    Absent,
}

impl Verdict {
    /// The name in JSON.
    pub fn name(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::Off => "off",
            Self::Absent => "absent",
        }
    }
}

/// One question to the device and its answer.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// Its name, for example `light quad` or `filtering precision`.
    pub feature: String,
    /// What came of it.
    pub verdict: Verdict,
    /// The largest error that was seen; 0 where nothing is measured.
    pub measured: f64,
    /// The largest error that is allowed.
    pub allowed: f64,
    /// What is measured, and what follows when it is off.
    pub note: &'static str,
}

impl Finding {
    fn measured(feature: impl Into<String>, measured: f64, allowed: f64, note: &'static str) -> Self {
        // Not `measured > allowed`: NaN is off, too.
        let verdict = if measured <= allowed { Verdict::Good } else { Verdict::Off };
        Self { feature: feature.into(), verdict, measured, allowed, note }
    }

    fn absent(feature: &str, note: &'static str) -> Self {
        Self { feature: feature.to_owned(), verdict: Verdict::Absent, measured: 0.0, allowed: 0.0, note }
    }

    /// A device that could not answer at all.
    fn failed(feature: &str, note: &'static str) -> Self {
        Self::measured(feature, f64::NAN, 0.0, note)
    }
}

/// What a device can do, and how well.
#[derive(Clone, Debug, PartialEq)]
pub struct ProbeReport {
    /// Which device.
    pub device: GpuInfo,
    /// One for each feature.
    pub findings: Vec<Finding>,
}

impl ProbeReport {
    /// Whether nothing is off.
    pub fn is_good(&self) -> bool {
        self.findings.iter().all(|finding| finding.verdict != Verdict::Off)
    }
}

impl fmt::Display for ProbeReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.device)?;
        for Finding { feature, verdict, measured, allowed, note } in &self.findings {
            match verdict {
                Verdict::Absent => writeln!(f, "absent  {feature}: {note}")?,
                _ => writeln!(f, "{:<7} {feature}: {measured:.1e} of {allowed:.1e}: {note}", verdict.name())?,
            }
        }
        Ok(())
    }
}

/// The shaders under test; a control plants errors in them.
struct Sources {
    arithmetic: String,
    integrate: String,
    textured: String,
    derivatives: String,
}

impl Sources {
    fn own() -> Self {
        let arithmetic = format!("{}\n{}", compose(&["math", "precise"], &[]), include_str!("probe.wgsl"));
        Self {
            arithmetic,
            integrate: Program::Integrate.source(),
            textured: Program::IntegrateTextured.source(),
            derivatives: include_str!("derivatives.wgsl").to_owned(),
        }
    }
}

/// Evaluates small known cases on the device: arithmetic, NaN, filtering of float textures and its precision, derivatives, and
/// a light of every kind, and one with a texture, against `f64`. Takes a second or so, most of it for compiling.
///
/// ```no_run
/// let gpu = ltc_shade_gpu::Gpu::new(ltc_shade_gpu::GpuOptions::default())?;
/// let report = ltc_shade_gpu::probe(&gpu)?;
/// println!("{report}");
/// assert!(report.is_good());
/// # Ok::<(), ltc_shade_gpu::GpuError>(())
/// ```
///
/// # Errors
/// [`GpuError::Device`] when a shader does not compile or the device is lost; wrong results are no errors but findings.
pub fn probe(gpu: &Gpu) -> Result<ProbeReport, GpuError> {
    examine(gpu, &Sources::own())
}

fn examine(gpu: &Gpu, sources: &Sources) -> Result<ProbeReport, GpuError> {
    let mut findings = arithmetic::findings(gpu, &sources.arithmetic)?;
    findings.extend(textures::findings(gpu, &sources.arithmetic)?);
    findings.push(derivatives::finding(gpu, &sources.derivatives)?);
    findings.extend(lights::findings(gpu, &sources.integrate)?);
    findings.push(textured::finding(gpu, &sources.textured)?);
    Ok(ProbeReport { device: gpu.info().clone(), findings })
}

fn module(gpu: &Gpu, source: &str) -> Result<wgpu::ShaderModule, GpuError> {
    gpu.checked(|| {
        Ok(gpu.device().create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("ltc probe"),
            source: wgpu::ShaderSource::Wgsl(source.into()),
        }))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::GpuOptions;

    fn gpu() -> Option<Gpu> {
        match Gpu::new(GpuOptions::default()) {
            Ok(gpu) => Some(gpu),
            Err(error) => {
                assert!(std::env::var_os("CI").is_none(), "{error}");
                eprintln!("skipped, because no GPU adapter can run this: {error}");
                None
            }
        }
    }

    fn off(findings: &[Finding]) -> Vec<&str> {
        let off = findings.iter().filter(|f| f.verdict == Verdict::Off);
        off.map(|f| f.feature.as_str()).collect()
    }

    #[test]
    fn a_device_is_good_and_planted_errors_are_named() {
        let Some(gpu) = gpu() else { return };
        let report = probe(&gpu).unwrap();
        println!("{report}");
        assert_eq!(off(&report.findings), [""; 0], "{report}");
        assert!(report.is_good() && report.findings.len() >= 15, "{report}");
        let plant = |text: &str, from: &str, to: &str| {
            assert!(text.contains(from), "{from} is gone");
            text.replace(from, to)
        };
        // The controls, one for each kind of question.
        let own = Sources::own();
        let planted = plant(&own.arithmetic, "-0.33332949", "-0.33432949");
        assert_eq!(off(&arithmetic::findings(&gpu, &planted).unwrap()), ["arc tangent"]);
        let planted = plant(&own.arithmetic, "if !(x == x)", "if x == x");
        assert_eq!(off(&arithmetic::findings(&gpu, &planted).unwrap()), ["NaN"]);
        let planted = plant(&own.arithmetic, "probe_input[id.x].x, 0.5)", "probe_input[id.x].x + 0.01, 0.5)");
        let filtering = textures::findings(&gpu, &planted).unwrap();
        assert!(filtering.len() == 1 || off(&filtering) == ["filtering precision"], "{filtering:?}");
        let planted = plant(&own.derivatives, "dpdy(5.0", "dpdy(5.1");
        assert_eq!(derivatives::finding(&gpu, &planted).unwrap().verdict, Verdict::Off);
        let planted = plant(&own.textured, "LTC_WIDE_SIGMA: f32 = 2.2360680", "LTC_WIDE_SIGMA: f32 = 2.3");
        assert_eq!(textured::finding(&gpu, &planted).unwrap().verdict, Verdict::Off);
        let planted = plant(&own.integrate, "LTC_PI: f32 = 3.1415927", "LTC_PI: f32 = 3.15");
        let lights = examine(&gpu, &Sources { integrate: planted, ..own }).unwrap();
        assert!(off(&lights.findings).contains(&"light quad") && !lights.is_good(), "{lights}");
        assert!(!off(&lights.findings).contains(&"arc tangent"), "{lights}");
    }

    /// GL has less, and says so instead of failing.
    #[test]
    fn gl_is_probed_too() {
        let gpu = match Gpu::new(GpuOptions { backend: Some("gl"), ..GpuOptions::default() }) {
            Ok(gpu) => gpu,
            Err(error @ GpuError::NoAdapter { .. }) => {
                eprintln!("skipped, because GL cannot run this: {error}");
                return;
            }
            Err(error) => panic!("{error}"),
        };
        let report = probe(&gpu).unwrap();
        println!("{report}");
        assert_eq!(off(&report.findings), [""; 0], "{report}");
    }

    #[test]
    fn not_a_number_is_off() {
        assert_eq!(Finding::measured("x", f64::NAN, 1.0, "").verdict, Verdict::Off);
        assert_eq!(Finding::failed("x", "").verdict, Verdict::Off);
    }
}
