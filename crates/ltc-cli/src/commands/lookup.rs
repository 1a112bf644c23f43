//! `ltc lookup`

use anyhow::Result;
use clap::Args;

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

impl Lookup {
    pub fn run(self, tables: &Tables) -> Result<()> {
        let catalogue = tables.catalogue()?;
        let table = catalogue.find(&self.table)?.table();
        json_lines::run(|line| ltc_lines::lookup(table, line))
    }
}
