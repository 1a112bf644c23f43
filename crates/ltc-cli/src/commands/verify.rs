//! `ltc verify`

use anyhow::{Result, bail};
use clap::Args;
use ltc_fit::Cost;
use ltc_table::TableVersion;

use crate::commands::tables::print_errors;
use crate::fit_progress::FitProgress;
use crate::tables::Tables;

/// Recomputes every figure of a table's manifest from the table and the BRDF, and compares: digest and size, axes, channels
/// and floors, the symmetries, the statistics of every entry, the errors over the standard draw and over the whole grid.
///
/// Example: ltc verify ggx-anisotropic
#[derive(Args)]
pub struct Verify {
    /// NAME, NAME@VERSION or a digest.
    #[arg(value_name = "TABLE")]
    table: String,
    /// Also fits the table again by the specification in its manifest, and compares the digests. The program's version
    /// and the kind of machine must be those that made the table.
    #[arg(long)]
    refit: bool,
    /// Prints JSON.
    #[arg(long)]
    json: bool,
}

impl Verify {
    pub fn run(self, tables: &Tables) -> Result<()> {
        let catalogue = tables.catalogue()?;
        let version = catalogue.find(&self.table)?;
        let mut found = ltc_fit::verify(version)?;
        if self.refit {
            found.faults.extend(self.fit_again(version)?);
        }
        let mut manifest = version.manifest().clone();
        manifest.errors = found.errors;
        if self.json {
            let ok = found.faults.is_empty();
            let (digest, errors, faults) = (&manifest.digest, &manifest.errors, &found.faults);
            outln!(
                "{}",
                serde_json::json!({ "ok": ok, "digest": digest, "errors": errors, "faults": faults })
            );
        } else {
            outln!("{} version {}: digest {}", manifest.name, manifest.version, manifest.digest);
            print_errors(&manifest)?;
        }
        if found.faults.is_empty() {
            if !self.json {
                let refitted = if self.refit { ", and fitted again to the same digest" } else { "" };
                outln!("as the manifest says{refitted}");
            }
            return Ok(());
        }
        bail!("{} does not hold what its manifest says: {}", manifest.name, found.faults.join("; "))
    }

    /// What is wrong with the digest.
    fn fit_again(&self, version: &TableVersion) -> Result<Option<String>> {
        let plan = ltc_fit::refit_plan(version)?;
        let progress = FitProgress::new(&Cost::of(plan.spec()), self.json);
        let found = ltc_fit::refit_digest(version, &|p| {
            progress.report(&p);
            true
        })?;
        progress.finish();
        let stated = &version.manifest().digest;
        Ok((found != *stated).then(|| format!("fitted again, the digest is {found}, not {stated}")))
    }
}
