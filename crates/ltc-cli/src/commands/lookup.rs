//! `ltc lookup`

use anyhow::Result;
use clap::Args;
use ltc_table::{Query, Table};
use serde::Deserialize;

use crate::{json_lines, tables::Tables};

/// Looks up lobes: JSON lines on stdin, JSON lines on stdout.
///
/// In: `{"theta":0.7,"phi":0.3,"alpha_x":0.4,"alpha_y":0.1}`. Out: `{"lobes":[{"weight":1.0,"m":[9 numbers, row-major]}],
/// "magnitude":n,"fresnel":f}`. A bad line gives `{"error":"…"}`.
///
/// Example: `echo '{"theta":0.7,"phi":0.3,"alpha_x":0.4,"alpha_y":0.1}' | ltc lookup --table ggx-anisotropic`
#[derive(Args)]
pub struct Lookup {
    /// NAME, NAME@VERSION or a digest.
    #[arg(long, value_name = "TABLE")]
    table: String,
    /// Output is JSON in any case.
    #[arg(long)]
    json: bool,
}

/// A query with nothing else beside it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Line {
    theta: f64,
    #[serde(default)]
    phi: f64,
    alpha_x: f64,
    alpha_y: f64,
}

impl Lookup {
    pub fn run(self, tables: &Tables) -> Result<()> {
        let catalogue = tables.catalogue()?;
        let table = catalogue.find(&self.table)?.table();
        json_lines::run(|line| answer(table, line))
    }
}

fn answer(table: &Table, line: &str) -> Result<ltc_table::Lookup, String> {
    let Line { theta, phi, alpha_x, alpha_y } = json_lines::object(line)?;
    table.lookup(&Query { theta, phi, alpha_x, alpha_y }).map_err(|e| e.to_string())
}
