//! A table as JSON: the arrays of the NPZ as nested lists.

use std::collections::BTreeMap;

use ltc_core::Matrix;
use ltc_table::{Axis, Channels, Precision, Table, TableError, TableVersion};
use serde::{Serialize, Serializer};

#[derive(Serialize)]
struct Document<'a> {
    name: &'a str,
    version: u32,
    digest: &'a str,
    precision: Precision,
    axes: &'a [Axis],
    #[serde(flatten)]
    arrays: BTreeMap<String, Array<'a>>,
}

/// Numbers in C order, written as lists within lists.
struct Array<'a> {
    shape: Vec<usize>,
    values: std::borrow::Cow<'a, [f64]>,
}

impl Serialize for Array<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        Nested { shape: &self.shape, values: &self.values }.serialize(serializer)
    }
}

struct Nested<'a> {
    shape: &'a [usize],
    values: &'a [f64],
}

impl Serialize for Nested<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.shape {
            [] | [_] => serializer.collect_seq(self.values),
            [count, shape @ ..] => {
                let stride = (self.values.len() / (*count).max(1)).max(1);
                serializer.collect_seq(self.values.chunks(stride).map(|values| Self { shape, values }))
            }
        }
    }
}

/// Writes `table`, which is `version`'s or a part of it, rounded to `precision`.
///
/// # Errors
/// Those of [`Table::rounded`].
pub(crate) fn write(
    version: &TableVersion,
    table: &Table,
    precision: Precision,
    channels: Channels,
) -> Result<Vec<u8>, TableError> {
    let table = table.rounded(precision)?;
    let manifest = version.manifest();
    let document = Document {
        name: &manifest.name,
        version: manifest.version,
        digest: &manifest.digest,
        precision,
        axes: table.axes(),
        arrays: arrays(&table, channels),
    };
    Ok(serde_json::to_vec(&document)?)
}

/// By their names in the NPZ.
fn arrays(table: &Table, channels: Channels) -> BTreeMap<String, Array<'_>> {
    let shape = table.shape();
    let mut arrays = BTreeMap::new();
    for axis in table.axes() {
        let nodes = Array { shape: vec![axis.len], values: axis.nodes().into() };
        arrays.insert(format!("axis_{}", axis.quantity.name()), nodes);
    }
    if channels.m {
        let rows: Vec<f64> = table.m().iter().flat_map(|m| m.to_row_array()).collect();
        let shape = [&shape[..], &[3, 3]].concat();
        arrays.insert("m".to_owned(), Array { shape, values: rows.into() });
    }
    if let Some(form) = table.closed_form().filter(|_| channels.magnitude || channels.fresnel) {
        arrays.insert("closed_form".to_owned(), Array { shape: vec![1], values: vec![form.code()].into() });
    }
    let cells = table.cells();
    for (name, values, chosen) in [
        ("magnitude", table.magnitude(), channels.magnitude),
        ("fresnel", table.fresnel(), channels.fresnel),
        ("cell_tv", &cells.tv, channels.cells),
        ("cell_leak", &cells.leak, channels.cells),
        ("cell_condition", &cells.condition, channels.cells),
    ] {
        if chosen && !values.is_empty() {
            arrays.insert(name.to_owned(), Array { shape: shape.clone(), values: values.into() });
        }
    }
    arrays
}
