//! A line of `ltc lookup`.

use ltc_table::{Lookup, Query, Table};
use serde::Deserialize;

use crate::object;
use crate::object::reason;

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

/// What `table` says to `{"theta":…,"phi":…,"alpha_x":…,"alpha_y":…}`.
///
/// # Errors
/// What is wrong with the line.
pub fn lookup(table: &Table, line: &str) -> Result<Lookup, String> {
    let Line { theta, phi, alpha_x, alpha_y } = object(line)?;
    table.lookup(&Query { theta, phi, alpha_x, alpha_y }).map_err(reason)
}
