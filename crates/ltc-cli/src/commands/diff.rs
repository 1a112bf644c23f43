//! `ltc diff`

use anyhow::Result;
use clap::Args;
use ltc_fit::diff::{Change, TableDiff};

use crate::tables::Tables;

/// Compares two tables: entry by entry where their axes are the same, by lookups over random queries, and by what their
/// manifests say.
///
/// Example: ltc diff ggx-isotropic@1 ggx-isotropic
#[derive(Args)]
pub struct Diff {
    /// NAME, NAME@VERSION or a digest.
    #[arg(value_name = "A")]
    first: String,
    /// The other.
    #[arg(value_name = "B")]
    second: String,
    /// Prints JSON, with every entry's total variation.
    #[arg(long)]
    json: bool,
}

impl Diff {
    pub fn run(self, tables: &Tables) -> Result<()> {
        let catalogue = tables.catalogue()?;
        let (first, second) = (catalogue.find(&self.first)?, catalogue.find(&self.second)?);
        let found = ltc_fit::diff::diff(first, second)?;
        if self.json {
            outln!("{}", serde_json::to_string(&found)?);
            return Ok(());
        }
        print(&found)
    }
}

fn print(found: &TableDiff) -> Result<()> {
    outln!("{}", if found.same_payload { "the same table, byte for byte" } else { "different tables" });
    match &found.entries {
        Some(entries) => {
            print_change("entries", &entries.all)?;
            outln!(
                "  m, scale and turn left out: mean {:.2e} max {:.2e}; most changed is entry {} {:?}",
                entries.m_mean,
                entries.m_max,
                entries.worst,
                entries.worst_node
            );
        }
        None => outln!("their axes differ: entries cannot be compared"),
    }
    print_change("lookups of the standard draw", &found.lookups)?;
    for (path, [first, second]) in &found.manifest {
        outln!("{path}: {first} -> {second}");
    }
    Ok(())
}

fn print_change(what: &str, change: &Change) -> Result<()> {
    outln!(
        "{} {what}: TV between the lobes mean {:.4} max {:.4}, magnitude mean {:.1e} max {:.1e}, Fresnel mean {:.1e} max {:.1e}",
        change.compared,
        change.tv_mean,
        change.tv_max,
        change.magnitude_mean,
        change.magnitude_max,
        change.fresnel_mean,
        change.fresnel_max
    );
    Ok(())
}
