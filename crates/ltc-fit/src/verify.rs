//! Whether a table is what its manifest says.

use glam::DMat3;
use ltc_table::{CellStats, Errors, Table, TableError, TableVersion, digest::digest};
use serde_json::Value;

use crate::{
    Brdf, FitError, FitSpec, Lattice, Observer, Plan, fit::channel_infos, grid_errors::grid_errors, measure,
};

/// What [`verify`] found.
#[derive(Clone, Debug)]
pub struct Verification {
    /// The errors, recomputed.
    pub errors: Errors,
    /// What in the manifest or payload is not so.
    pub faults: Vec<String>,
}

/// Recomputes every figure of a manifest from the payload and the BRDF, and compares them with what manifest and payload
/// say: digest and size, axes, channels and their shapes, floors and BRDF against the specification, the symmetries, the
/// statistics of every entry, and the errors over the standard draw and over the whole grid.
///
/// # Errors
/// [`FitError::Spec`] when the manifest's `fit` is not a specification this program knows.
pub fn verify(version: &TableVersion) -> Result<Verification, FitError> {
    verify_with(FitSpec::of_manifest(version.manifest())?.brdf()?, version)
}

/// The same for a BRDF that [`FitSpec::brdf`] does not know.
///
/// # Errors
/// As [`verify`], and [`FitError::Spec`] when the manifest names another BRDF.
pub fn verify_with(brdf: &dyn Brdf, version: &TableVersion) -> Result<Verification, FitError> {
    let spec = FitSpec::of_manifest(version.manifest())?;
    spec.validate_with(brdf)?;
    let mut faults = Vec::new();
    check_payload(version, &mut faults)?;
    check_manifest(version, &spec, brdf, &mut faults);
    check_symmetries(version.table(), &spec, &mut faults);
    let errors = check_figures(version, &spec, brdf, &mut faults)?;
    Ok(Verification { errors, faults })
}

/// Fits the table again by the specification in its manifest; the digest of what comes of it. On the kind of machine and
/// with the version of the program that made the table it is the manifest's own.
///
/// # Errors
/// As [`verify`], and [`FitError::Stopped`] when the observer says so.
pub fn refit_digest(version: &TableVersion, observer: Observer<'_>) -> Result<String, FitError> {
    let (table, _) = crate::fit(&FitSpec::of_manifest(version.manifest())?, observer)?;
    Ok(digest(&TableVersion::payload_of(&table)?))
}

/// What a refit of this table would take.
///
/// # Errors
/// As [`verify`].
pub fn refit_plan(version: &TableVersion) -> Result<Plan<'static>, FitError> {
    Plan::new(FitSpec::of_manifest(version.manifest())?)
}

/// The payload is that of the manifest, and is what this program writes for its table: nothing else is in it.
fn check_payload(version: &TableVersion, faults: &mut Vec<String>) -> Result<(), FitError> {
    let (manifest, payload) = (version.manifest(), version.payload());
    let found = digest(payload);
    if found != manifest.digest {
        faults.push(format!("digest: stated {}, found {found}", manifest.digest));
    }
    if payload.len() as u64 != manifest.payload_bytes {
        faults.push(format!("payload_bytes: stated {}, found {}", manifest.payload_bytes, payload.len()));
    }
    if TableVersion::payload_of(version.table())? != payload {
        faults.push("the payload is not what the table's arrays and axes are written as".to_owned());
    }
    Ok(())
}

fn check_manifest(version: &TableVersion, spec: &FitSpec, brdf: &dyn Brdf, faults: &mut Vec<String>) {
    let manifest = version.manifest();
    for (what, same) in [
        ("fit.axes is not axes", spec.axes == manifest.axes),
        ("fit.name is not name", spec.name == manifest.name),
        ("fit.floors is not floors", spec.floors == manifest.floors),
        ("brdf.name is not that of fit.brdf", manifest.brdf.name == brdf.name()),
        (
            "fit.channels.closed_form is not that of the payload",
            spec.channels.closed_form == version.table().closed_form(),
        ),
        ("brdf.parameters are not those of fit.brdf", manifest.brdf.parameters == brdf.parameters()),
    ] {
        if !same {
            faults.push(what.to_owned());
        }
    }
    let shapes: Vec<_> = manifest.channels.iter().map(|c| (c.name.clone(), c.shape.clone())).collect();
    let infos = channel_infos(spec.channels.closed_form);
    let expected: Vec<_> = infos.into_iter().map(|c| (c.name, c.shape)).collect();
    if shapes != expected {
        faults.push(format!("channels: stated {shapes:?}, found {expected:?}"));
    }
}

/// Entries that a symmetry forces to be zero or equal, or that follow from others.
fn check_symmetries(table: &Table, spec: &FitSpec, faults: &mut Vec<String>) {
    let lattice = Lattice::new(&spec.axes, &spec.floors);
    if lattice.ties.len() != table.m().len() {
        return; // fit.axes are others, which is a fault of its own
    }
    let off = |a: DMat3, b: DMat3| {
        !a.abs_diff_eq(b, SAME_ROTATED * a.to_cols_array().map(f64::abs).iter().sum::<f64>())
    };
    let broken = |i: usize| {
        let (tie, m) = (&lattice.ties[i], table.m());
        if tie.owner == i {
            off(tie.pattern.project(m[i]), m[i])
        } else {
            off(tie.follow(m[tie.owner]), m[i])
        }
    };
    if let Some(i) = (0..table.m().len()).find(|i| broken(*i)) {
        faults.push(format!("m, entry {i}: is not what the symmetries make of it"));
    }
    for (name, values) in [("magnitude", table.magnitude()), ("fresnel", table.fresnel())] {
        if let Some(i) = (0..values.len()).find(|i| values[*i] != values[lattice.ties[*i].owner]) {
            let (owner, found) = (lattice.ties[i].owner, values[i]);
            faults.push(format!(
                "{name}, entry {i}: {found} is not that of entry {owner}, whose lobe it shares"
            ));
        }
    }
}

/// Every number of the manifest's `errors`, and every entry's statistics.
fn check_figures(
    version: &TableVersion,
    spec: &FitSpec,
    brdf: &dyn Brdf,
    faults: &mut Vec<String>,
) -> Result<Errors, FitError> {
    let (table, stated) = (version.table(), &version.manifest().errors);
    let cells = measure::cells(brdf, table, &spec.floors, spec.measure.samples)?;
    compare_cells(&cells, table.cells(), faults);
    let mut errors = measure::errors(brdf, table, &cells, spec.measure)?;
    // Tables from before there were such errors say nothing of them.
    if stated.grid.is_some() {
        errors.grid = Some(grid_errors(brdf, table, &spec.floors, spec.measure)?);
    }
    let value = |errors: &Errors| serde_json::to_value(errors).map_err(TableError::from);
    compare_values("errors", &value(&errors)?, &value(stated)?, faults);
    Ok(errors)
}

/// Relative difference that other mathematical libraries may make in an integral over a lobe.
const SAME: f64 = 1e-8;
/// The same for what takes sums, products and roots alone, which are the same everywhere.
const SAME_ARITHMETIC: f64 = 1e-12;
/// The same for a rotated matrix, relative to the sum of its entries.
const SAME_ROTATED: f64 = 1e-13;

fn same(a: f64, b: f64, tolerance: f64) -> bool {
    (a - b).abs() <= tolerance * a.abs().max(b.abs()).max(1e-6)
}

fn compare_cells(found: &CellStats, stated: &CellStats, faults: &mut Vec<String>) {
    for (name, found, stated, tolerance) in [
        ("cell_tv", &found.tv, &stated.tv, SAME),
        ("cell_leak", &found.leak, &stated.leak, SAME_ARITHMETIC),
        ("cell_condition", &found.condition, &stated.condition, SAME_ARITHMETIC),
    ] {
        if stated.len() != found.len() {
            faults.push(format!("{name} is missing"));
        } else if let Some(i) = (0..found.len()).find(|i| !same(found[*i], stated[*i], tolerance)) {
            faults.push(format!("{name}, entry {i}: stated {}, found {}", stated[i], found[i]));
        }
    }
}

/// Every number of `found` against that of `stated`.
fn compare_values(path: &str, found: &Value, stated: &Value, faults: &mut Vec<String>) {
    if let (Some(found), Some(stated)) = (found.as_object(), stated.as_object()) {
        let keys: std::collections::BTreeSet<&String> = found.keys().chain(stated.keys()).collect();
        for key in keys {
            let of = |object: &serde_json::Map<String, Value>| object.get(key).cloned().unwrap_or_default();
            compare_values(&format!("{path}.{key}"), &of(found), &of(stated), faults);
        }
        return;
    }
    let equal = match (found.as_f64(), stated.as_f64()) {
        (Some(a), Some(b)) => same(a, b, SAME),
        _ => found == stated,
    };
    if !equal {
        faults.push(format!("{path}: stated {stated}, found {found}"));
    }
}
