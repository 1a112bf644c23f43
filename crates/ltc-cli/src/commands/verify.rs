//! `ltc verify`

use anyhow::{Result, bail};
use clap::Args;

use crate::commands::tables::print_errors;
use crate::tables::Tables;

/// Recomputes a table's digest and error statistics and compares them with its manifest.
///
/// Example: ltc verify ggx-anisotropic
#[derive(Args)]
pub struct Verify {
    /// NAME, NAME@VERSION or a digest.
    #[arg(value_name = "TABLE")]
    table: String,
    /// Prints JSON.
    #[arg(long)]
    json: bool,
}

impl Verify {
    pub fn run(self, tables: &Tables) -> Result<()> {
        let catalogue = tables.catalogue()?;
        let version = catalogue.find(&self.table)?;
        let found = ltc_fit::verify(version)?;
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
                outln!("as the manifest says");
            }
            return Ok(());
        }
        bail!("{} does not hold what its manifest says: {}", manifest.name, found.faults.join("; "))
    }
}
