//! A table with one number altered is found out, whichever number it is, even when digest and size are made to fit.

#![expect(clippy::unwrap_used, reason = "a test fails by a panic")]

use std::sync::OnceLock;

use glam::DMat3;
use ltc_fit::{FitSpec, Lattice, fit, publish, refit_digest, silent, verify};
use ltc_table::{CellStats, Manifest, Table, TableError, TableVersion, digest::digest};

fn spec(isotropic: bool) -> FitSpec {
    let name = if isotropic { "ggx-isotropic" } else { "ggx-anisotropic-closed-form" };
    let mut spec = FitSpec::preset(name).unwrap();
    spec.name = "small".to_owned();
    let lengths: &[usize] = if isotropic { &[6, 5] } else { &[4, 3, 3, 3] };
    for (axis, len) in spec.axes.iter_mut().zip(lengths) {
        axis.len = *len;
    }
    (spec.entries.samples, spec.entries.iterations) = (64, 10);
    (spec.joint.steps, spec.joint.queries, spec.joint.samples) = (10, 64, 32);
    (spec.channels.samples, spec.channels.queries) = (256, 100);
    (spec.measure.samples, spec.measure.queries) = (256, 100);
    spec
}

fn version(isotropic: bool) -> &'static TableVersion {
    static VERSIONS: [OnceLock<TableVersion>; 2] = [OnceLock::new(), OnceLock::new()];
    VERSIONS[usize::from(isotropic)].get_or_init(|| {
        let spec = spec(isotropic);
        let (table, errors) = fit(&spec, &silent).unwrap();
        publish(&spec, &table, errors, 1, "2026-01-01T00:00:00Z".to_owned()).unwrap()
    })
}

/// The arrays of a table, to be altered.
#[derive(Clone)]
struct Arrays {
    m: Vec<DMat3>,
    magnitude: Vec<f64>,
    fresnel: Vec<f64>,
    cells: CellStats,
}

/// The version with altered arrays and a manifest that is then altered, digest and size made to fit.
fn altered(
    version: &TableVersion,
    change: impl Fn(&mut Arrays),
    edit: impl Fn(&mut Manifest),
) -> Result<TableVersion, TableError> {
    let table = version.table();
    let mut arrays = Arrays {
        m: table.m().to_vec(),
        magnitude: table.magnitude().to_vec(),
        fresnel: table.fresnel().to_vec(),
        cells: table.cells().clone(),
    };
    change(&mut arrays);
    let Arrays { m, magnitude, fresnel, cells } = arrays;
    let other = Table::new(table.axes().to_vec(), m, magnitude, fresnel, cells)?;
    let payload = TableVersion::payload_of(&other.with_closed_form(table.closed_form())?)?;
    let mut manifest = version.manifest().clone();
    manifest.digest = digest(&payload);
    manifest.payload_bytes = payload.len() as u64;
    edit(&mut manifest);
    TableVersion::new(manifest, payload)
}

fn faults(version: &TableVersion) -> Vec<String> {
    verify(version).unwrap().faults
}

fn nothing(_: &mut Arrays) {}

#[test]
fn an_unaltered_table_has_no_fault() {
    for isotropic in [true, false] {
        let same = altered(version(isotropic), nothing, |_| ()).unwrap();
        assert_eq!(same.manifest(), version(isotropic).manifest());
        assert_eq!(faults(&same), [""; 0]);
        assert!(same.manifest().errors.grid.is_some());
    }
}

#[test]
fn every_entry_of_every_array_is_watched() {
    type Change = fn(&mut Arrays, usize);
    let changes: [(&str, Change); 7] = [
        ("m, one element", |a, i| a.m[i].y_axis.y *= 1.0 + 1e-5),
        ("m, scaled, which changes no lobe at the entry itself", |a, i| a.m[i] *= 1.0 + 1e-5),
        ("magnitude", |a, i| a.magnitude[i] *= 1.0 + 1e-4),
        ("fresnel", |a, i| a.fresnel[i] = 1e-5 + a.fresnel[i] * (1.0 + 1e-4)),
        ("cell_tv", |a, i| a.cells.tv[i] *= 1.0 + 1e-6),
        ("cell_leak", |a, i| a.cells.leak[i] = 1e-9 + a.cells.leak[i] * (1.0 + 1e-6)),
        ("cell_condition", |a, i| a.cells.condition[i] *= 1.0 + 1e-6),
    ];
    for isotropic in [true, false] {
        let version = version(isotropic);
        let nodes = version.table().m().len();
        // The last fifth of the entries lies at θ = 90°, where no query of the standard draw comes.
        for index in (0..nodes).step_by(7).chain([nodes - 1]) {
            for (what, change) in changes {
                let planted = altered(version, |arrays| change(arrays, index), |_| ()).unwrap();
                assert!(!faults(&planted).is_empty(), "{what}, entry {index}, was not seen");
            }
        }
    }
}

#[test]
fn the_closed_form_is_watched() {
    let version = version(false);
    let form = version.table().closed_form();
    assert!(form.is_some());
    let bare = version.table().clone().with_closed_form(None).unwrap();
    let payload = TableVersion::payload_of(&bare).unwrap();
    let mut manifest = version.manifest().clone();
    (manifest.digest, manifest.payload_bytes) = (digest(&payload), payload.len() as u64);
    // Manifest and payload must say the same.
    let error = TableVersion::new(manifest.clone(), payload.clone()).unwrap_err();
    assert!(matches!(error, TableError::Disagreement { .. }), "{error}");
    manifest.channels.iter_mut().for_each(|channel| channel.closed_form = None);
    let found = faults(&TableVersion::new(manifest, payload).unwrap());
    assert!(found.iter().any(|fault| fault.starts_with("fit.channels.closed_form")), "{found:?}");
    assert!(found.iter().any(|fault| fault.starts_with("errors.magnitude_mean")), "{found:?}");
    let silent = altered(version, nothing, |m| m.fit["channels"]["closed_form"] = serde_json::Value::Null);
    assert!(faults(&silent.unwrap()).iter().any(|fault| fault.starts_with("fit.channels.closed_form")));
}

#[test]
fn elements_of_a_grazing_entry_are_watched() {
    let version = version(false);
    let spec = spec(false);
    let lattice = Lattice::new(&spec.axes, &spec.floors);
    // An entry at θ = 90° that owns itself and has no symmetry.
    let free =
        |i: &usize| lattice.ties[*i].owner == *i && lattice.ties[*i].pattern == ltc_fit::Pattern::General;
    let index = (0..lattice.nodes.len()).rev().find(free).unwrap();
    assert!(lattice.nodes[index].theta > 86.0_f64.to_radians());
    for element in 0..9 {
        let nudge = |arrays: &mut Arrays| {
            let mut elements = arrays.m[index].to_cols_array();
            elements[element] += 1e-4;
            arrays.m[index] = DMat3::from_cols_array(&elements);
        };
        let planted = altered(version, nudge, |_| ()).unwrap();
        assert!(!faults(&planted).is_empty(), "element {element} was not seen");
    }
}

#[test]
fn every_figure_of_the_manifest_is_recomputed() {
    // Each number below `errors`, one after the other.
    let errors = serde_json::to_value(&version(true).manifest().errors).unwrap();
    let mut paths = Vec::new();
    numbers("", &errors, &mut paths);
    assert!(paths.len() >= 30, "{paths:?}");
    for path in paths {
        let flatter = |manifest: &mut Manifest| {
            let mut errors = serde_json::to_value(&manifest.errors).unwrap();
            let figure = errors.pointer_mut(&path).unwrap();
            *figure = match figure.as_u64() {
                Some(count) => (count + 1).into(),
                None => (figure.as_f64().unwrap() * (1.0 + 1e-6) + 1e-12).into(),
            };
            manifest.errors = serde_json::from_value(errors).unwrap();
        };
        let found = faults(&altered(version(true), nothing, flatter).unwrap());
        let name = format!("errors{}:", path.replace('/', "."));
        assert!(found.len() == 1 && found[0].starts_with(&name), "{path}: {found:?}");
    }
}

/// The JSON pointers of all numbers of a value.
fn numbers(path: &str, value: &serde_json::Value, found: &mut Vec<String>) {
    if value.is_number() {
        found.push(path.to_owned());
    }
    for (key, value) in value.as_object().into_iter().flatten() {
        numbers(&format!("{path}/{key}"), value, found);
    }
}

#[test]
fn whatever_else_the_manifest_says_is_checked() {
    type Edit = fn(&mut Manifest);
    let edits: [(&str, Edit); 9] = [
        ("payload_bytes", |m| m.payload_bytes += 1),
        ("fit.name", |m| m.name = "other".to_owned()),
        ("fit.floors", |m| m.floors.alpha *= 1.5),
        ("brdf.name", |m| m.brdf.name = "phong".to_owned()),
        ("brdf.parameters", |m| m.brdf.parameters = serde_json::json!({})),
        ("channels", |m| m.channels.truncate(3)),
        ("channels", |m| m.channels[0].shape = vec![9]),
        ("errors.standard_draw.draw", |m| m.errors.standard_draw.draw = "anisotropic".to_owned()),
        // Within what a reader puts up with.
        ("the payload is not", |m| {
            m.axes[1].domain[1] -= 1e-10;
            m.fit["axes"][1]["domain"][1] = m.axes[1].domain[1].into();
        }),
    ];
    for (word, edit) in edits {
        let found = faults(&altered(version(true), nothing, edit).unwrap());
        assert!(found.iter().any(|fault| fault.contains(word)), "{word}: {found:?}");
    }
    let other_fit = altered(version(true), nothing, |m| m.fit["speed"] = 3.into()).unwrap();
    assert!(verify(&other_fit).unwrap_err().to_string().contains("unknown field `speed`"));
    let wrong_digest = altered(version(true), nothing, |m| m.digest = digest(b""));
    assert!(matches!(wrong_digest, Err(TableError::DigestMismatch { .. })));
}

#[test]
fn a_manifest_from_before_there_were_grid_errors_is_still_verified() {
    let old = altered(version(true), nothing, |m| m.errors.grid = None).unwrap();
    assert!(!old.manifest_json().unwrap().contains("\"grid\""));
    assert_eq!(faults(&old), [""; 0]);
}

#[test]
fn fitting_again_gives_the_same_digest_or_tells() {
    let version = version(true);
    assert_eq!(refit_digest(version, &silent).unwrap(), version.manifest().digest);
    let other = altered(version, |arrays| arrays.magnitude[3] *= 0.999, |_| ()).unwrap();
    assert_ne!(refit_digest(&other, &silent).unwrap(), other.manifest().digest);
}
