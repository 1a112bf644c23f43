//! From a specification to a table version.

use ltc_table::{BrdfInfo, ChannelInfo, ClosedForm, Errors, Manifest, Table, TableVersion, digest::digest};

use crate::{Brdf, FitError, FitRun, FitSpec, Fitted, Layout, Observer, Plan};

/// What names the program in manifests.
const TOOL: &str = concat!("ltc-fit ", env!("CARGO_PKG_VERSION"));

/// Fits a table: each entry by itself, all together, magnitude and Fresnel, and the statistics. [`FitRun`] does the same
/// in pieces.
///
/// # Errors
/// [`FitError::Spec`] for a specification that makes no sense, [`FitError::Stopped`] when the observer says so.
pub fn fit(spec: &FitSpec, observer: Observer<'_>) -> Result<(Table, Errors), FitError> {
    fit_with(spec.brdf()?, spec, observer)
}

/// The same for a BRDF that [`FitSpec::brdf`] does not know, one's own for example; `spec.brdf` must have its name.
///
/// # Errors
/// As [`fit`], and [`FitError::Brdf`] for a BRDF that gives negative values or NaN.
pub fn fit_with(
    brdf: &dyn Brdf,
    spec: &FitSpec,
    observer: Observer<'_>,
) -> Result<(Table, Errors), FitError> {
    let plan = Plan::with_brdf(brdf, spec.clone())?;
    let mut run = FitRun::new(&plan);
    while run.advance(observer)? {}
    let Fitted { table, errors, .. } = run.finish()?;
    Ok((table, errors))
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
    publish_with(spec.brdf()?, spec, table, errors, version, created)
}

/// The same for a BRDF that [`FitSpec::brdf`] does not know.
///
/// # Errors
/// As [`publish`], and [`FitError::Spec`] when `spec.brdf` is not the BRDF's name.
pub fn publish_with(
    brdf: &dyn Brdf,
    spec: &FitSpec,
    table: &Table,
    errors: Errors,
    version: u32,
    created: String,
) -> Result<TableVersion, FitError> {
    spec.validate_with(brdf)?;
    let payload = TableVersion::payload_of(table)?;
    let manifest = Manifest {
        name: spec.name.clone(),
        version,
        digest: digest(&payload),
        payload_bytes: payload.len() as u64,
        axes: spec.axes.clone(),
        channels: channel_infos(spec.channels.closed_form),
        lobes: 1,
        normalisation: normalisation(spec.joint.layout).to_owned(),
        handedness: "right-handed frame, x = tangent (alpha_x), z = normal; m maps cosine space to the lobe; det m > 0"
            .to_owned(),
        floors: spec.floors.clone(),
        brdf: BrdfInfo {
            name: spec.brdf.clone(),
            parameters: brdf.parameters(),
        },
        fit: serde_json::to_value(spec).map_err(ltc_table::TableError::from)?,
        errors,
        created,
        tool: TOOL.to_owned(),
        licence: "CC0-1.0".to_owned(),
    };
    Ok(TableVersion::new(manifest, payload)?)
}

fn normalisation(layout: Layout) -> &'static str {
    match layout {
        Layout::Matrix => {
            "scale and rotation of each matrix are part of the fit, for interpolation of m; its lobe does not depend on them"
        }
        Layout::DropIn => {
            "fitted for interpolation of the inverse of m divided by its middle entry, as engines do (ltc_1, ltc_2); scale of m is of \
             no consequence"
        }
    }
}

/// What a fitted table's payload holds.
pub(crate) fn channel_infos(closed_form: Option<ClosedForm>) -> Vec<ChannelInfo> {
    let info = |name: &str, shape: &[usize], meaning: &str| ChannelInfo {
        name: name.to_owned(),
        shape: shape.to_vec(),
        meaning: meaning.to_owned(),
        closed_form: None,
    };
    let mut infos = vec![
        info("m", &[3, 3], "row-major matrix, cosine space to lobe; interpolate it, then invert"),
        info("magnitude", &[], "n = integral of rho cos at F = 1 (base colour 1)"),
        info(
            "fresnel",
            &[],
            "f = integral of w rho cos, w = (1 - wo.wh)^5 unless brdf.parameters says otherwise; reflectance = F0 n + (F90 - \
             F0) f",
        ),
        info("cell_tv", &[], "total variation between the entry's lobe and the BRDF's"),
        info("cell_leak", &[], "share of the entry's lobe below the horizon"),
        info("cell_condition", &[], "condition number of the entry's matrix"),
    ];
    if let Some(form) = closed_form {
        form.describe(&mut infos);
    }
    infos
}
