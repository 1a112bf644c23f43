//! From a specification to a table version.

use ltc_table::{BrdfInfo, CellStats, ChannelInfo, Errors, Manifest, Table, TableVersion, digest::digest};

use crate::{FitError, FitSpec, Lattice, Observer, channels, entries, joint, measure};

/// What names the program in manifests.
const TOOL: &str = concat!("ltc-fit ", env!("CARGO_PKG_VERSION"));

/// Fits a table: each entry by itself, all together, magnitude and Fresnel, and the statistics.
///
/// # Errors
/// [`FitError::Spec`] for a specification that makes no sense, [`FitError::Stopped`] when the observer says so.
pub fn fit(spec: &FitSpec, observer: Observer<'_>) -> Result<(Table, Errors), FitError> {
    spec.validate()?;
    let brdf = spec.brdf()?;
    let lattice = Lattice::new(&spec.axes, &spec.floors);
    let alone = entries::fit_entries(brdf, &spec.axes, &lattice, spec.objective()?, spec.entries, observer)?;
    let m = joint::refine(brdf, &spec.axes, &lattice, &alone, spec.joint, observer)?;
    let (magnitude, fresnel) = channels::fit_channels(brdf, &spec.axes, &lattice, spec.channels, observer)?;
    let bare = Table::new(spec.axes.clone(), m, magnitude, fresnel, CellStats::default())?;
    let cells = measure::cells(brdf, &bare, &spec.floors, spec.measure.samples)?;
    let errors = measure::errors(brdf, &bare, &cells, spec.measure)?;
    let (m, magnitude, fresnel) = (bare.m().to_vec(), bare.magnitude().to_vec(), bare.fresnel().to_vec());
    Ok((Table::new(spec.axes.clone(), m, magnitude, fresnel, cells)?, errors))
}

/// A fitted table with its manifest; `created` in RFC 3339, UTC.
///
/// # Errors
/// [`FitError::Table`], which no fitted table gives.
pub fn publish(
    spec: &FitSpec,
    table: &Table,
    errors: Errors,
    version: u32,
    created: String,
) -> Result<TableVersion, FitError> {
    let payload = TableVersion::payload_of(table)?;
    let manifest = Manifest {
        name: spec.name.clone(),
        version,
        digest: digest(&payload),
        payload_bytes: payload.len() as u64,
        axes: spec.axes.clone(),
        channels: channel_infos(),
        lobes: 1,
        normalisation: "scale and rotation of each matrix are part of the fit, for interpolation of m; its lobe does not \
                        depend on them"
            .to_owned(),
        handedness: "right-handed frame, x = tangent (alpha_x), z = normal; m maps cosine space to the lobe; det m > 0"
            .to_owned(),
        floors: spec.floors.clone(),
        brdf: BrdfInfo {
            name: spec.brdf.clone(),
            parameters: serde_json::json!({ "masking_shadowing": "Smith, height-correlated", "fresnel": 1 }),
        },
        fit: serde_json::to_value(spec).map_err(ltc_table::TableError::from)?,
        errors,
        created,
        tool: TOOL.to_owned(),
        licence: "CC0-1.0".to_owned(),
    };
    Ok(TableVersion::new(manifest, payload)?)
}

fn channel_infos() -> Vec<ChannelInfo> {
    let info = |name: &str, shape: &[usize], meaning: &str| ChannelInfo {
        name: name.to_owned(),
        shape: shape.to_vec(),
        meaning: meaning.to_owned(),
    };
    vec![
        info("m", &[3, 3], "row-major matrix, cosine space to lobe; interpolate it, then invert"),
        info("magnitude", &[], "n = integral of rho cos at F = 1"),
        info("fresnel", &[], "f = integral of (1 - wo.wh)^5 rho cos; reflectance = F0 n + (F90 - F0) f"),
        info("cell_tv", &[], "total variation between the entry's lobe and the BRDF's"),
        info("cell_leak", &[], "share of the entry's lobe below the horizon"),
        info("cell_condition", &[], "condition number of the entry's matrix"),
    ]
}

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
