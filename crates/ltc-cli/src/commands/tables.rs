//! `ltc tables`, `ltc inspect`

use anyhow::Result;
use clap::Args;
use ltc_table::{Manifest, TableVersion};

use crate::tables::Tables;

/// Lists the tables and their versions.
///
/// Example: ltc tables --json
#[derive(Args)]
pub struct List {
    /// Prints JSON, as `GET /v1/tables` does.
    #[arg(long)]
    json: bool,
}

impl List {
    pub fn run(self, tables: &Tables) -> Result<()> {
        let catalogue = tables.catalogue()?;
        let mut rows = Vec::new();
        let width = catalogue.names().map(str::len).max().unwrap_or(0);
        for name in catalogue.names() {
            let versions: Vec<_> = catalogue.versions(name)?.map(|v| v.manifest()).collect();
            if let Some(latest) = versions.last() {
                let numbers: Vec<u32> = versions.iter().map(|m| m.version).collect();
                if !self.json {
                    let shape: Vec<String> = latest.axes.iter().map(|a| a.len.to_string()).collect();
                    let (shape, tv) = (shape.join("×"), latest.errors.standard_draw.tv_mean);
                    outln!(
                        "{name:<width$} latest {:<4} {shape:<10} mean TV {tv:.4}  {}",
                        latest.version,
                        latest.digest
                    );
                }
                rows.push(serde_json::json!({
                    "name": name, "latest": latest.version, "versions": numbers, "digest": latest.digest,
                }));
            }
        }
        if self.json {
            outln!("{}", serde_json::json!({ "tables": rows }));
        }
        Ok(())
    }
}

/// Says what a table is, how it was made, and how good it is.
///
/// Example: ltc inspect ggx-anisotropic
#[derive(Args)]
pub struct Inspect {
    /// NAME, NAME@VERSION or a digest.
    #[arg(value_name = "TABLE")]
    table: String,
    /// Prints the manifest as JSON.
    #[arg(long)]
    json: bool,
}

impl Inspect {
    pub fn run(self, tables: &Tables) -> Result<()> {
        let catalogue = tables.catalogue()?;
        let version = catalogue.find(&self.table)?;
        if self.json {
            out!("{}", version.manifest_json()?);
        } else {
            describe(version)?;
        }
        Ok(())
    }
}

fn describe(version: &TableVersion) -> Result<()> {
    let m: &Manifest = version.manifest();
    outln!("{} version {}, {} bytes, {}", m.name, m.version, m.payload_bytes, m.digest);
    outln!("made {} by {}; licence {}", m.created, m.tool, m.licence);
    outln!("BRDF {} {}", m.brdf.name, m.brdf.parameters);
    for axis in &m.axes {
        let (name, [low, high]) = (axis.quantity.name(), axis.domain);
        outln!("axis {name:<7} {} nodes, {:?}, {low:.4} to {high:.4}", axis.len, axis.mapping);
    }
    outln!("floors: alpha {}, lambda {}, theta {:.4}", m.floors.alpha, m.floors.lambda, m.floors.theta_max);
    outln!("{}\n{}", m.normalisation, m.handedness);
    print_errors(m)
}

/// The errors of a manifest, for a person.
pub fn print_errors(m: &Manifest) -> Result<()> {
    let (e, d) = (&m.errors, &m.errors.standard_draw);
    outln!("total variation on {} unseen queries ({} draw, {} samples each):", d.queries, d.draw, d.samples);
    outln!("  mean {:.4}  median {:.4}  p95 {:.4}  max {:.4}", d.tv_mean, d.tv_median, d.tv_p95, d.tv_max);
    outln!(
        "  alpha < 0.14: {:.4}  alpha >= 0.14: {:.4}",
        d.tv_mean_alpha_below_0_14,
        d.tv_mean_alpha_from_0_14
    );
    outln!("magnitude: mean error {:.1e}, max {:.1e}", e.magnitude_mean, e.magnitude_max);
    outln!("Fresnel:   mean error {:.1e}, max {:.1e}", e.fresnel_mean, e.fresnel_max);
    outln!(
        "entries: TV mean {:.4} max {:.4}, leak mean {:.4} max {:.4}, condition up to {:.1e}",
        e.cell_tv_mean,
        e.cell_tv_max,
        e.leak_mean,
        e.leak_max,
        e.condition_max
    );
    if let Some(g) = &e.grid {
        outln!("whole grid, up to the ends of the axes:");
        outln!("  half-way between entries: TV mean {:.4} max {:.4}", g.centre_tv_mean, g.centre_tv_max);
        for (name, [mean, max], [own_mean, own_max]) in [
            (
                "magnitude:",
                [g.centre_magnitude_mean, g.centre_magnitude_max],
                [g.node_magnitude_mean, g.node_magnitude_max],
            ),
            (
                "Fresnel:  ",
                [g.centre_fresnel_mean, g.centre_fresnel_max],
                [g.node_fresnel_mean, g.node_fresnel_max],
            ),
        ] {
            outln!(
                "  {name} mean {mean:.1e} max {max:.1e}, at the entries mean {own_mean:.1e} max {own_max:.1e}"
            );
        }
    }
    Ok(())
}
