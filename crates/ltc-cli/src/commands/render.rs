//! `ltc render`

use std::path::PathBuf;

use anyhow::{Context, Result};
use clap::{Args, ValueEnum};
use ltc_render::{
    Backend, Comparison, Format, RenderOptions, RenderTables, Rendered, Scene, ToneMap, compare, render,
};

use crate::progress::Reporter;
use crate::tables::Tables;

/// Renders a scene of spheres and planes under area lights to a PNG or EXR file.
///
/// examples/scenes/README.md documents the scene format. There are no shadows: every back end computes unoccluded direct
/// light.
///
/// Example: ltc render examples/scenes/anisotropic-spheres.json -o spheres.png --compare reference
#[derive(Args)]
pub struct Render {
    /// The scene, JSON.
    #[arg(value_name = "SCENE.json")]
    scene: PathBuf,
    /// Picture to write: .png (tone-mapped) or .exr (linear radiance).
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// What shades: LTC on the GPU (a software driver will do), LTC on the CPU, or sampling of the BRDFs themselves.
    #[arg(long, value_enum, default_value_t = BackendName::Gpu)]
    backend: BackendName,
    /// Writes picture, ground truth and their difference side by side, and prints the error.
    #[arg(long, value_enum)]
    compare: Option<Against>,
    /// Exposure of the PNG in stops.
    #[arg(long, value_name = "STOPS", default_value_t = 0.0, allow_negative_numbers = true)]
    exposure: f64,
    /// Camera samples a pixel: 1, 4, 9, 16, 25, 36, 49 or 64.
    #[arg(long, value_name = "N", default_value_t = 4)]
    samples_per_pixel: u32,
    /// Light samples of the reference, for each camera sample and light.
    #[arg(long, value_name = "N", default_value_t = 256)]
    reference_samples: u32,
    /// Table for isotropic materials.
    #[arg(long, value_name = "TABLE", default_value = "ggx-isotropic")]
    isotropic_table: String,
    /// Table for anisotropic materials.
    #[arg(long, value_name = "TABLE", default_value = "ggx-anisotropic")]
    anisotropic_table: String,
    /// Prints time, device and errors as JSON.
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, ValueEnum)]
enum BackendName {
    Gpu,
    Cpu,
    Reference,
}

#[derive(Clone, Copy, ValueEnum)]
enum Against {
    Reference,
}

impl Render {
    pub fn run(self, tables: &Tables) -> Result<()> {
        // A name that cannot be written is said before the work, not after.
        Format::of(&self.output)?;
        anyhow::ensure!(
            self.exposure.is_finite(),
            "--exposure is {}, must be a finite number",
            self.exposure
        );
        let scene = Scene::load(&self.scene)?;
        let catalogue = tables.catalogue()?;
        let isotropic = catalogue.find(&self.isotropic_table)?.table();
        let anisotropic = catalogue.find(&self.anisotropic_table)?.table();
        let tables = RenderTables { isotropic, anisotropic };
        let backend = match self.backend {
            BackendName::Gpu => Backend::Gpu,
            BackendName::Cpu => Backend::Cpu,
            BackendName::Reference => Backend::Reference,
        };
        let reporter = Reporter::new();
        let progress = |part: f32| reporter.report("reference", (part * 100.0) as usize, 100, "");
        let needs_progress = self.compare.is_some() || backend == Backend::Reference;
        let options = RenderOptions {
            samples_per_pixel: self.samples_per_pixel,
            reference_samples: self.reference_samples,
            progress: if needs_progress { Some(&progress) } else { None },
            ..RenderOptions::default()
        };
        let tone = ToneMap { exposure: self.exposure };
        if let Some(Against::Reference) = self.compare {
            let comparison = compare(&scene, &tables, backend, &options)?;
            reporter.finish();
            comparison.write(&self.output, tone)?;
            return self.print_comparison(&comparison);
        }
        let rendered = render(&scene, &tables, backend, &options)?;
        reporter.finish();
        rendered.image.write(&self.output, tone)?;
        self.print(&rendered)
    }

    fn print(&self, rendered: &Rendered) -> Result<()> {
        let path = self.output.display().to_string();
        let Rendered { seconds, shading_seconds, device, image, .. } = rendered;
        let (width, height) = (image.width(), image.height());
        if self.json {
            let value = serde_json::json!({
                "file": path, "width": width, "height": height,
                "seconds": seconds, "shading_seconds": shading_seconds, "device": device,
            });
            outln!("{value}");
        } else {
            outln!(
                "{path}: {width}×{height}, {seconds:.2} s ({shading_seconds:.2} s of shading) on {device}"
            );
        }
        Ok(())
    }

    fn print_comparison(&self, comparison: &Comparison) -> Result<()> {
        let path = self.output.display().to_string();
        let Comparison { test, reference, errors, amplification } = comparison;
        if self.json {
            let value = serde_json::json!({
                "file": path, "seconds": test.seconds, "reference_seconds": reference.seconds, "device": test.device,
                "errors": serde_json::to_value(errors).context("errors")?, "amplification": amplification,
            });
            outln!("{value}");
            return Ok(());
        }
        outln!("{path}: picture · reference · difference (×{amplification})");
        outln!("  {:.2} s on {}; reference {:.1} s", test.seconds, test.device, reference.seconds);
        let relative =
            errors.relative_rmse.map_or_else(String::new, |r| format!(", relative RMSE {:.2} %", 100.0 * r));
        let (rmse, mean, max) = (errors.rmse, errors.mean_abs, errors.max_abs);
        outln!("  over {} pixels: RMSE {rmse:.5}, mean {mean:.5}, max {max:.4}{relative}", errors.pixels);
        Ok(())
    }
}
