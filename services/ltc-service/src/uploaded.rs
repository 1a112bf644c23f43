//! Whether a table that was made elsewhere is what it says, measured anew.
//!
//! Two kinds of manifests are taken:
//! - one as this program writes it, whose `fit` is a specification: everything in it is recomputed as `ltc verify` does, and the
//!   payload is kept as it came;
//! - any other with at least `axes`, `brdf.name` and `licence`: the arrays are read, the statistics of every entry and the errors
//!   over the standard draw are measured against the BRDF of that name, and what is kept is the canonical payload of the result. What
//!   the manifest says of `errors.standard_draw.tv_mean` must not be better than what is measured.

use axum::body::Bytes;
use ltc_fit::measure::{self, MeasureSettings};
use ltc_fit::{Brdf, Cost, FitSpec, Layout, brdf};
use ltc_table::digest::digest;
use ltc_table::{
    Axis, BrdfInfo, CellStats, ChannelInfo, ClosedForm, Errors, Floors, Manifest, Quantity, Table,
    TableError, TableVersion, npz,
};
use serde::Deserialize;
use serde_json::{Value, json};

/// A manifest and a payload as they came.
#[derive(Clone, Debug)]
pub(crate) struct Uploaded {
    pub manifest: Value,
    pub payload: Bytes,
}

/// What is to be kept, and what is wrong with it.
#[derive(Clone, Debug)]
pub(crate) struct Checked {
    pub manifest: Value,
    pub payload: Bytes,
    /// None: publish it.
    pub faults: Vec<String>,
}

/// Total variation from which a table is not one of its BRDF: lobes that have nothing to do with each other differ by so much.
const NOT_THAT_BRDF: f64 = 0.3;
/// Mean error of magnitude or Fresnel term from which they are not those of the BRDF: both are shares of light, about 0 to 1.
const NOT_THOSE_CHANNELS: f64 = 0.1;
/// What magnitude and Fresnel term of an entry may be at most. Not every BRDF keeps energy: Charlie's sheen reaches 2.9.
const MOST: f64 = 10.0;
/// What share of the measured error a table may leave out of what it says: draws differ.
const BETTER: f64 = 0.2;

/// How tables made elsewhere are measured: as the presets are.
const MEASURE: MeasureSettings =
    MeasureSettings { queries: 3000, samples: 4096, seed: 77, layout: Layout::Matrix };

/// Checks an upload for a table of that name. Takes seconds.
pub(crate) fn check(name: &str, uploaded: &Uploaded) -> Checked {
    let kept =
        |faults| Checked { manifest: uploaded.manifest.clone(), payload: uploaded.payload.clone(), faults };
    if let Some(other) = uploaded.manifest.get("name").filter(|other| *other != name) {
        return kept(vec![format!("the manifest's name is {other}, the path's is \"{name}\"")]);
    }
    let stated = uploaded.manifest.get("digest");
    let found = digest(&uploaded.payload);
    if let Some(stated) = stated.filter(|stated| **stated != found) {
        return kept(vec![format!("digest: stated {stated}, found {found}")]);
    }
    let fit = uploaded.manifest.get("fit").cloned().unwrap_or_default();
    if serde_json::from_value::<FitSpec>(fit).is_ok() {
        return kept(faults_of_ours(uploaded).unwrap_or_else(|fault| vec![fault]));
    }
    match measured(name, uploaded) {
        Ok((manifest, payload)) => Checked { manifest, payload: payload.into(), faults: Vec::new() },
        Err(fault) => kept(vec![fault]),
    }
}

/// What `ltc verify` would say.
fn faults_of_ours(uploaded: &Uploaded) -> Result<Vec<String>, String> {
    let manifest: Manifest =
        serde_json::from_value(uploaded.manifest.clone()).map_err(|e| format!("manifest: {e}"))?;
    let spec: FitSpec = serde_json::from_value(manifest.fit.clone()).map_err(|e| format!("fit: {e}"))?;
    // Measuring is a part of fitting: what is too large to be fitted is too large to be measured.
    Cost::of(&spec).check(&ltc_fit::Limits::default()).map_err(|e| e.to_string())?;
    let version = TableVersion::new(manifest, uploaded.payload.to_vec()).map_err(|e| e.to_string())?;
    let mut faults = ltc_fit::verify(&version).map(|found| found.faults).map_err(|e| e.to_string())?;
    faults.extend(implausible(version.table(), &version.manifest().errors).err());
    Ok(faults)
}

/// Refuses channels that are not those of the BRDF, whatever a manifest says of them.
fn implausible(table: &Table, errors: &Errors) -> Result<(), String> {
    for (name, entries, mean) in [
        ("magnitude", table.magnitude(), errors.magnitude_mean),
        ("fresnel", table.fresnel(), errors.fresnel_mean),
    ] {
        if let Some(entry) = entries.iter().find(|entry| **entry > MOST) {
            return Err(format!("{name}: an entry is {entry:e}, and it is about a share of light"));
        }
        if !(0.0..NOT_THOSE_CHANNELS).contains(&mean) {
            return Err(format!("{name}: its mean error is {mean:.3}: it is not that of the BRDF"));
        }
    }
    Ok(())
}

/// What a manifest from elsewhere must or may have. The rest of it is kept under `fit.stated`.
#[derive(Deserialize)]
struct Elsewhere {
    axes: Vec<Axis>,
    brdf: StatedBrdf,
    licence: String,
    floors: Option<Floors>,
    normalisation: Option<String>,
    tool: Option<String>,
    created: Option<String>,
    lobes: Option<u32>,
    #[serde(default)]
    fit: Value,
    #[serde(default)]
    errors: Value,
}

#[derive(Deserialize)]
struct StatedBrdf {
    name: String,
    parameters: Option<Value>,
}

/// The manifest and the payload of a table from elsewhere.
fn measured(name: &str, uploaded: &Uploaded) -> Result<(Value, Vec<u8>), String> {
    let stated: Elsewhere =
        serde_json::from_value(uploaded.manifest.clone()).map_err(|e| format!("manifest: {e}"))?;
    let brdf = brdf_of(&stated)?;
    if stated.lobes.is_some_and(|lobes| lobes != 1) {
        return Err("lobes: tables of one lobe can be read".to_owned());
    }
    for axis in &stated.axes {
        axis.validate().map_err(|e| e.to_string())?;
    }
    let table = npz::read(&uploaded.payload, &stated.axes).map_err(|e: TableError| e.to_string())?;
    let floors = stated.floors.clone().unwrap_or_else(|| floors(&stated.axes));
    check_floors(&floors)?;
    let cells = measure::cells(brdf, &table, &floors, MEASURE.samples).map_err(|e| e.to_string())?;
    let errors = measure::errors(brdf, &table, &cells, MEASURE).map_err(|e| e.to_string())?;
    let tv = errors.standard_draw.tv_mean;
    if !(0.0..NOT_THAT_BRDF).contains(&tv) {
        return Err(format!(
            "its mean total variation from {} is {tv:.3}: it is not a table of that BRDF",
            brdf.name()
        ));
    }
    implausible(&table, &errors)?;
    if let Some(claimed) = stated.errors.pointer("/standard_draw/tv_mean").and_then(Value::as_f64)
        && claimed < (1.0 - BETTER) * tv
    {
        return Err(format!("errors.standard_draw.tv_mean: stated {claimed}, found {tv}"));
    }
    let payload = payload(&table, cells).map_err(|e| e.to_string())?;
    let manifest = Manifest {
        name: name.to_owned(),
        version: 0,
        digest: digest(&payload),
        payload_bytes: payload.len() as u64,
        axes: stated.axes,
        channels: channels(table.closed_form()),
        lobes: 1,
        normalisation: stated.normalisation.unwrap_or_else(|| "as it came; the lobe of an entry does not depend on scale".to_owned()),
        handedness: "right-handed frame, x = tangent (alpha_x), z = normal; m maps cosine space to the lobe; det m > 0".to_owned(),
        floors,
        brdf: BrdfInfo { name: brdf.name().to_owned(), parameters: brdf.parameters() },
        fit: json!({ "made": "elsewhere", "measure": MEASURE, "stated": stated.fit }),
        errors,
        created: stated.created.unwrap_or_else(now),
        tool: stated.tool.unwrap_or_else(|| "not stated".to_owned()),
        licence: stated.licence,
    };
    Ok((serde_json::to_value(manifest).map_err(|e| e.to_string())?, payload))
}

fn brdf_of(stated: &Elsewhere) -> Result<&'static dyn Brdf, String> {
    let name = &stated.brdf.name;
    let brdf = brdf::by_name(name).ok_or_else(|| {
        format!(
            "brdf.name: \"{name}\" is not known here, so that no error can be measured; there are: {}",
            brdf::names()
        )
    })?;
    match &stated.brdf.parameters {
        Some(parameters) if *parameters != brdf.parameters() => {
            Err(format!("brdf.parameters: stated {parameters}, those of {name} are {}", brdf.parameters()))
        }
        _ => Ok(brdf),
    }
}

/// The floors of the presets, no lower than the axes reach.
fn floors(axes: &[Axis]) -> Floors {
    let low = |quantity, least: f64| {
        axes.iter().find(|a| a.quantity == quantity).map_or(least, |a| a.domain[0].max(least))
    };
    Floors {
        alpha: low(Quantity::Alpha, 1e-3),
        lambda: low(Quantity::Lambda, 0.03),
        theta_max: 89.5_f64.to_radians(),
    }
}

fn check_floors(floors: &Floors) -> Result<(), String> {
    let Floors { alpha, lambda, theta_max } = *floors;
    let right = (1e-6..=1.0).contains(&alpha)
        && (1e-6..=1.0).contains(&lambda)
        && (0.0..core::f64::consts::FRAC_PI_2).contains(&theta_max);
    if right {
        Ok(())
    } else {
        Err("floors: alpha and lambda must be 1e-6 to 1, theta_max 0 to below pi/2".to_owned())
    }
}

fn payload(table: &Table, cells: CellStats) -> Result<Vec<u8>, TableError> {
    let (m, magnitude, fresnel) = (table.m().to_vec(), table.magnitude().to_vec(), table.fresnel().to_vec());
    let measured = Table::new(table.axes().to_vec(), m, magnitude, fresnel, cells)?;
    TableVersion::payload_of(&measured.with_closed_form(table.closed_form())?)
}

fn channels(closed_form: Option<ClosedForm>) -> Vec<ChannelInfo> {
    let mut infos = [
        ("m", &[3, 3][..], "row-major matrix, cosine space to lobe; interpolate it, then invert"),
        ("magnitude", &[], "n = integral of rho cos at F = 1 (base colour 1)"),
        ("fresnel", &[], "f = integral of (1 - wo.wh)^5 rho cos; reflectance = F0 n + (F90 - F0) f"),
        ("cell_tv", &[], "total variation between the entry's lobe and the BRDF's"),
        ("cell_leak", &[], "share of the entry's lobe below the horizon"),
        ("cell_condition", &[], "condition number of the entry's matrix"),
    ]
    .map(|(name, shape, meaning)| ChannelInfo {
        name: name.to_owned(),
        shape: shape.to_vec(),
        meaning: meaning.to_owned(),
        closed_form: None,
    });
    if let Some(form) = closed_form {
        form.describe(&mut infos);
    }
    infos.into()
}

fn now() -> String {
    humantime::format_rfc3339_seconds(std::time::SystemTime::now()).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A shipped table, small enough to be measured in a test.
    fn shipped(name: &str) -> Uploaded {
        let catalogue = ltc_tables::shipped().unwrap();
        let version = catalogue.version(name, "latest").unwrap();
        let manifest = serde_json::to_value(version.manifest()).unwrap();
        Uploaded { manifest, payload: version.payload().to_vec().into() }
    }

    /// The same without what only this program writes.
    fn elsewhere(name: &str) -> Uploaded {
        let Uploaded { manifest, payload } = shipped(name);
        let manifest = json!({
            "axes": manifest["axes"], "brdf": { "name": manifest["brdf"]["name"] }, "licence": "CC0-1.0",
            "fit": { "program": "another" },
        });
        Uploaded { manifest, payload }
    }

    const NAME: &str = "disney-diffuse";

    fn fault(uploaded: &Uploaded) -> String {
        let checked = check(NAME, uploaded);
        assert_eq!(checked.payload, uploaded.payload, "kept as it came");
        checked.faults.join("; ")
    }

    #[test]
    fn what_this_program_made_is_kept_as_it_is() {
        let uploaded = shipped(NAME);
        let checked = check(NAME, &uploaded);
        assert_eq!(checked.faults, [""; 0]);
        assert_eq!(checked.payload, uploaded.payload);
        assert_eq!(checked.manifest, uploaded.manifest);
    }

    #[test]
    fn what_others_made_is_measured() {
        let checked = check(NAME, &elsewhere(NAME));
        assert_eq!(checked.faults, [""; 0]);
        let manifest: Manifest = serde_json::from_value(checked.manifest).unwrap();
        let original: Manifest = serde_json::from_value(shipped(NAME).manifest).unwrap();
        let (found, expected) =
            (manifest.errors.standard_draw.tv_mean, original.errors.standard_draw.tv_mean);
        assert!((found - expected).abs() < 1e-3, "{found} {expected}");
        assert_eq!(manifest.fit["stated"]["program"], "another");
        TableVersion::new(manifest, checked.payload.to_vec()).unwrap();
    }

    /// The table with one channel changed.
    fn with_channels(change: impl Fn(&mut [f64], &mut [f64])) -> Uploaded {
        let uploaded = elsewhere(NAME);
        let axes: Vec<Axis> = serde_json::from_value(uploaded.manifest["axes"].clone()).unwrap();
        let table = npz::read(&uploaded.payload, &axes).unwrap();
        let (mut magnitude, mut fresnel) = (table.magnitude().to_vec(), table.fresnel().to_vec());
        change(&mut magnitude, &mut fresnel);
        let changed =
            Table::new(axes, table.m().to_vec(), magnitude, fresnel, table.cells().clone()).unwrap();
        Uploaded { payload: TableVersion::payload_of(&changed).unwrap().into(), ..uploaded }
    }

    #[test]
    fn channels_of_something_else_are_a_fault() {
        let same = with_channels(|_, _| ());
        assert_eq!(check(NAME, &same).faults, [""; 0]);
        for (changed, said) in [
            (with_channels(|n, _| n.iter_mut().for_each(|n| *n *= 0.3)), "magnitude: its mean error"),
            (with_channels(|_, f| f.iter_mut().for_each(|f| *f += 0.2)), "fresnel: its mean error"),
            (with_channels(|n, _| n[3] = 1e300), "magnitude: an entry is 1e300"),
            (with_channels(|_, f| f[0] = 15.0), "fresnel: an entry is 1.5e1"),
        ] {
            let found = fault(&changed);
            assert!(found.contains(said), "{said}: {found}");
        }
    }

    #[test]
    fn whatever_is_wrong_is_a_fault() {
        let with = |pointer: &str, value: Value, mut uploaded: Uploaded| {
            *uploaded.manifest.pointer_mut(pointer).unwrap() = value;
            uploaded
        };
        let extra = |key: &str, value: Value| {
            let mut uploaded = elsewhere(NAME);
            uploaded.manifest[key] = value;
            uploaded
        };
        let mut damaged = shipped(NAME);
        let mut bytes = damaged.payload.to_vec();
        bytes[500] ^= 1;
        damaged.payload = bytes.into();
        let mut garbage = elsewhere(NAME);
        garbage.payload = Bytes::from_static(b"not a zip");
        for (uploaded, said) in [
            (damaged, "digest: stated"),
            (garbage, "npz"),
            (
                with("/errors/standard_draw/tv_mean", json!(0.001), shipped(NAME)),
                "errors.standard_draw.tv_mean",
            ),
            (with("/brdf/name", json!("phong"), elsewhere(NAME)), "\"phong\" is not known"),
            (with("/brdf/name", json!("ggx"), elsewhere(NAME)), "not a table of that BRDF"),
            (with("/axes/0/len", json!(7), elsewhere(NAME)), "axis_theta"),
            (with("/axes/0/len", json!(u64::MAX), elsewhere(NAME)), ""),
            (with("/axes", json!([]), elsewhere(NAME)), ""),
            (extra("name", json!("other")), "the manifest's name"),
            (extra("lobes", json!(2)), "lobes"),
            (extra("floors", json!({ "alpha": -1.0, "lambda": 0.5, "theta_max": 1.0 })), "floors"),
            (extra("errors", json!({ "standard_draw": { "tv_mean": 0.0 } })), "tv_mean: stated 0"),
            (Uploaded { manifest: json!({}), payload: Bytes::new() }, "missing field"),
        ] {
            let found = fault(&uploaded);
            assert!(!found.is_empty() && found.contains(said), "{said}: {found}");
        }
    }
}
