//! `ltc fit`

use std::path::PathBuf;
use std::time::{Instant, SystemTime};

use anyhow::{Context, Result, ensure};
use clap::Args;
use ltc_fit::{FitSpec, Progress};
use ltc_table::{Catalogue, TableVersion};

use crate::progress::Reporter;

/// Fits a table and writes it as a new version. The same preset gives the same digest, whatever the number of threads.
///
/// Nothing is written before the fit is complete; Ctrl-C leaves the folder as it was.
///
/// Example: ltc fit ggx-isotropic -o my-tables
#[derive(Args)]
pub struct Fit {
    /// What to fit: ggx-isotropic or ggx-anisotropic.
    #[arg(value_name = "PRESET")]
    preset: String,
    /// Folder of tables; the version goes to DIR/NAME/NUMBER.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Threads to use; all cores by default.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Prints the manifest as JSON.
    #[arg(long)]
    json: bool,
}

impl Fit {
    pub fn run(self) -> Result<()> {
        let spec = FitSpec::preset(&self.preset)?;
        // Known before the work is done, not after.
        std::fs::create_dir_all(&self.output).with_context(|| self.output.display().to_string())?;
        let known = Catalogue::read_folder(&self.output)?;
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(self.threads.map_or(0, usize::from))
            .build()
            .context("cannot start threads")?;
        let reporter = Reporter::new();
        let start = Instant::now();
        let observer = |p: Progress| {
            let note = p.tv.map_or_else(String::new, |tv| format!(", TV {tv:.4}"));
            reporter.report(p.stage, p.done, p.total, &note);
            true
        };
        let (table, errors) = pool.install(|| ltc_fit::fit(&spec, &observer))?;
        reporter.finish();
        let version = next_version(&known, &spec.name);
        let created = humantime::format_rfc3339_seconds(SystemTime::now()).to_string();
        let fitted = ltc_fit::publish(&spec, &table, errors, version, created)?;
        self.store(&known, &fitted, start)
    }

    fn store(&self, known: &Catalogue, fitted: &TableVersion, start: Instant) -> Result<()> {
        let manifest = fitted.manifest();
        let seconds = start.elapsed().as_secs_f64();
        let tv = manifest.errors.standard_draw.tv_mean;
        let summary = format!("mean TV {tv:.4} on unseen queries, {seconds:.1} s, {}", manifest.digest);
        if let Ok(same) = known.version(&manifest.name, &manifest.digest) {
            eprintln!(
                "{}: version {} is this very table; nothing to write",
                manifest.name,
                same.manifest().version
            );
        } else {
            let folder = self.output.join(&manifest.name).join(manifest.version.to_string());
            ensure!(!folder.exists(), "{} exists and is not a table; move it away", folder.display());
            fitted.write_folder(&folder)?;
            eprintln!("{}: version {} written to {}", manifest.name, manifest.version, folder.display());
        }
        if self.json {
            out!("{}", fitted.manifest_json()?);
        } else {
            outln!("{}: {summary}", manifest.name);
        }
        Ok(())
    }
}

fn next_version(known: &Catalogue, name: &str) -> u32 {
    known.version(name, "latest").map_or(1, |latest| latest.manifest().version + 1)
}
