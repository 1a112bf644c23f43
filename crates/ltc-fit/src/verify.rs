//! Whether a table is what its manifest says.

use ltc_table::{Errors, TableVersion};

use crate::{FitError, FitSpec, measure};

/// What [`verify`] found.
#[derive(Clone, Debug)]
pub struct Verification {
    /// The errors, recomputed.
    pub errors: Errors,
    /// What in the manifest or payload is not so.
    pub faults: Vec<String>,
}

/// Recomputes the error statistics of a table, per entry and over the standard draw, and compares them with what its
/// manifest and payload say. (The digest was checked when the version was read.)
///
/// # Errors
/// [`FitError::Spec`] when the manifest's `fit` is not a specification this program knows.
pub fn verify(version: &TableVersion) -> Result<Verification, FitError> {
    let manifest = version.manifest();
    let spec: FitSpec = serde_json::from_value(manifest.fit.clone())
        .map_err(|e| FitError::Spec { field: "fit", reason: e.to_string() })?;
    spec.validate()?;
    let brdf = spec.brdf()?;
    let table = version.table();
    let cells = measure::cells(brdf, table, &spec.floors, spec.measure.samples)?;
    let errors = measure::errors(brdf, table, &cells, spec.measure)?;
    let mut faults = Vec::new();
    compare_cells("cell_tv", &cells.tv, &table.cells().tv, &mut faults);
    compare_cells("cell_leak", &cells.leak, &table.cells().leak, &mut faults);
    compare_cells("cell_condition", &cells.condition, &table.cells().condition, &mut faults);
    compare_errors(&errors, &manifest.errors, &mut faults)?;
    if spec.axes != manifest.axes || spec.name != manifest.name {
        faults.push("fit.axes or fit.name differ from the manifest's own".to_owned());
    }
    Ok(Verification { errors, faults })
}

/// Relative difference that other mathematical libraries may make.
const SAME: f64 = 1e-6;

fn same(a: f64, b: f64) -> bool {
    (a - b).abs() <= SAME * (1e-3 + a.abs().max(b.abs()))
}

fn compare_cells(name: &str, found: &[f64], stated: &[f64], faults: &mut Vec<String>) {
    if stated.len() != found.len() {
        faults.push(format!("{name} is missing"));
    } else if let Some(i) = (0..found.len()).find(|i| !same(found[*i], stated[*i])) {
        faults.push(format!("{name}, entry {i}: stated {}, found {}", stated[i], found[i]));
    }
}

/// Every number of the manifest's `errors` against the recomputed one.
fn compare_errors(found: &Errors, stated: &Errors, faults: &mut Vec<String>) -> Result<(), FitError> {
    let to_value = |errors: &Errors| serde_json::to_value(errors).map_err(ltc_table::TableError::from);
    compare_values("errors", &to_value(found)?, &to_value(stated)?, faults);
    Ok(())
}

fn compare_values(
    path: &str,
    found: &serde_json::Value,
    stated: &serde_json::Value,
    faults: &mut Vec<String>,
) {
    if let (Some(found), Some(stated)) = (found.as_object(), stated.as_object()) {
        for (key, value) in found {
            compare_values(&format!("{path}.{key}"), value, &stated[key], faults);
        }
        return;
    }
    let equal = match (found.as_f64(), stated.as_f64()) {
        (Some(a), Some(b)) => same(a, b),
        _ => found == stated,
    };
    if !equal {
        faults.push(format!("{path}: stated {stated}, found {found}"));
    }
}
