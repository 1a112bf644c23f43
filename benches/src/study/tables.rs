//! Total variation against bytes.

use ltc_fit::{FitSpec, GgxFamily, Layout, draw, fit, measure, silent};
use ltc_table::{Kind, Precision, Table, TableVersion};

use super::{Plan, Record, StudyError};

/// Samples of a lobe that a total variation is taken over.
const SAMPLES: usize = 4096;
/// Queries of the standard draw, and their seed: those of `ltc verify`.
const QUERIES: usize = 3000;
const SEED: u64 = 77;

/// A table that users have, at the precisions of its files.
///
/// # Errors
/// Those of rounding and looking up.
pub fn shipped(version: &TableVersion, plan: &Plan) -> Result<Vec<Record>, StudyError> {
    let name = &version.manifest().name;
    let layout = FitSpec::of_manifest(version.manifest())?.measure.layout;
    [Precision::F16, Precision::F32]
        .into_iter()
        .map(|precision| {
            let table = version.table().rounded(precision)?;
            let id = format!("table/{name}@{}/{}", version.manifest().version, precision.name());
            measured(id, &table, layout, precision, plan)
        })
        .collect()
}

/// Tables of other sizes, fitted here as the presets are; the short run fits for fewer steps, so that they are worse.
///
/// # Errors
/// Those of the fit.
pub fn sizes(plan: &Plan, mut step: impl FnMut(&str)) -> Result<Vec<Record>, StudyError> {
    let quick: &[(&str, &[usize])] = &[("ggx-isotropic", &[8, 8]), ("ggx-anisotropic", &[4, 4, 4, 4])];
    let full: &[(&str, &[usize])] = &[
        ("ggx-isotropic", &[8, 8]),
        ("ggx-isotropic", &[16, 16]),
        ("ggx-isotropic", &[32, 32]),
        ("ggx-anisotropic", &[4, 4, 4, 4]),
        ("ggx-anisotropic", &[5, 5, 5, 5]),
        ("ggx-anisotropic", &[6, 6, 6, 6]),
        ("ggx-anisotropic", &[12, 12, 12, 12]),
    ];
    let mut records = Vec::new();
    for (preset, lengths) in if plan.quick { quick } else { full } {
        let mut spec = FitSpec::preset(preset)?;
        for (axis, len) in spec.axes.iter_mut().zip(*lengths) {
            axis.len = *len;
        }
        if plan.quick {
            spec.joint.steps /= 5;
            spec.channels.queries /= 10;
        }
        let size: Vec<String> = lengths.iter().map(ToString::to_string).collect();
        let id = format!("table/{preset}-{}/f16", size.join("x"));
        step(&id);
        let (table, _) = fit(&spec, &silent)?;
        let table = table.rounded(Precision::F16)?;
        records.push(measured(id, &table, Layout::Matrix, Precision::F16, plan)?);
    }
    Ok(records)
}

/// Whether its errors are those of GGX.
pub fn is_ggx(version: &TableVersion) -> bool {
    version.manifest().brdf.name == "ggx"
}

fn measured(
    id: String,
    table: &Table,
    layout: Layout,
    precision: Precision,
    plan: &Plan,
) -> Result<Record, StudyError> {
    let isotropic = table.kind() == Kind::Isotropic;
    let queries = draw::standard(if plan.quick { QUERIES / 2 } else { QUERIES }, SEED, isotropic);
    let mut tv = measure::query_tv(&GgxFamily, &layout.reader(table)?, &queries, SAMPLES)?;
    tv.sort_by(f64::total_cmp);
    let mean = tv.iter().sum::<f64>() / tv.len() as f64;
    // Nine numbers of the matrix less the one that normalisation fixes, magnitude and Fresnel term: ten, in texels of four.
    let bytes = table.m().len() * 12 * precision.bytes();
    Ok(Record::new(id, "table")
        .sized(bytes as u64)
        .error("tv_mean", mean)
        .error("tv_p95", tv[tv.len() * 19 / 20])
        .error("tv_max", tv[tv.len() - 1]))
}
