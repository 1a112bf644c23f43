//! How good a table is.

use glam::DMat3;
use ltc_core::{Alpha, Matrix};
use ltc_table::{CellStats, DrawErrors, Errors, Floors, Kind, Lookup, Query, Table};
use rayon::prelude::*;

use crate::{
    Brdf, DiskPoints, DiskRule, EntryFit, FitError, Lattice, Layout, Lobe, Node, Pattern, Reader, draw,
    fit_entry, total_variation,
};

/// How the errors of a table are sampled.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MeasureSettings {
    /// Queries of the standard draw.
    pub queries: usize,
    /// Samples of the lobe at each query and at each entry.
    pub samples: usize,
    /// Seed of the queries; the fit must not use it.
    pub seed: u64,
    /// What a reader of the table interpolates.
    #[serde(default, skip_serializing_if = "Layout::is_matrix")]
    pub layout: Layout,
}

/// Where the samples of a measurement start; fits start elsewhere or at random.
pub(crate) const MEASURE_SHIFT: [f64; 2] = [0.37, 0.71];

/// Statistics of every entry, at its own node.
///
/// # Errors
/// None for a valid table.
pub fn cells(brdf: &dyn Brdf, table: &Table, floors: &Floors, samples: usize) -> Result<CellStats, FitError> {
    let lattice = Lattice::new(table.axes(), floors);
    let points = DiskPoints::new(samples, MEASURE_SHIFT);
    let tv: Result<Vec<f64>, FitError> = lattice
        .nodes
        .par_iter()
        .zip(table.m())
        .map_init(Lobe::default, |lobe, (node, m)| node_tv(brdf, node, *m, &points, lobe))
        .collect();
    Ok(cell_stats(table, tv?))
}

/// Total variation of an entry at its own node.
pub(crate) fn node_tv(
    brdf: &dyn Brdf,
    node: &Node,
    m: DMat3,
    points: &DiskPoints,
    lobe: &mut Lobe,
) -> Result<f64, FitError> {
    brdf.sample_lobe(node.wo(), node.widths()?, points, lobe);
    Ok(total_variation(lobe, m))
}

/// The statistics of every entry, from its total variation.
pub(crate) fn cell_stats(table: &Table, tv: Vec<f64>) -> CellStats {
    let leak = table.m().iter().map(|m| leak(*m)).collect();
    CellStats { tv, leak, condition: table.m().iter().map(|m| condition(*m)).collect() }
}

/// Errors over the standard draw, and the summary of `cells`. Magnitude and Fresnel over the same draw with θ up to
/// [`draw::ALBEDO_THETA_MAX_DEGREES`]: they are shaded with up to grazing, and hardest there.
///
/// # Errors
/// None for a valid table.
pub fn errors(
    brdf: &dyn Brdf,
    table: &Table,
    cells: &CellStats,
    settings: MeasureSettings,
) -> Result<Errors, FitError> {
    let isotropic = table.kind() == Kind::Isotropic;
    let reader = settings.layout.reader(table)?;
    let queries = draw::standard(settings.queries, settings.seed, isotropic);
    let tv = query_tv(brdf, &reader, &queries, settings.samples)?;
    let albedo = albedo_errors(brdf, &reader, settings, isotropic)?;
    Ok(summary(draw_errors(&queries, &tv, settings, isotropic), cells, &albedo))
}

/// The errors of a table, from those at each entry and at each query.
pub(crate) fn summary(standard_draw: DrawErrors, cells: &CellStats, albedo: &[[f64; 2]]) -> Errors {
    let magnitude: Vec<f64> = albedo.iter().map(|e| e[0]).collect();
    let fresnel: Vec<f64> = albedo.iter().map(|e| e[1]).collect();
    Errors {
        standard_draw,
        leak_max: maximum(&cells.leak),
        leak_mean: mean(&cells.leak),
        condition_max: maximum(&cells.condition),
        cell_tv_mean: mean(&cells.tv),
        cell_tv_max: maximum(&cells.tv),
        magnitude_mean: mean(&magnitude),
        magnitude_max: maximum(&magnitude),
        fresnel_mean: mean(&fresnel),
        fresnel_max: maximum(&fresnel),
        grid: None,
    }
}

/// Total variation of what a reader gets for each query.
///
/// # Errors
/// Those of the reader's lookup.
pub fn query_tv(
    brdf: &dyn Brdf,
    reader: &Reader<'_>,
    queries: &[Query],
    samples: usize,
) -> Result<Vec<f64>, FitError> {
    let points = DiskPoints::new(samples, MEASURE_SHIFT);
    queries
        .par_iter()
        .map_init(Lobe::default, |lobe, query| one_tv(brdf, reader, query, &points, lobe))
        .collect()
}

/// Total variation of what a reader gets for one query.
pub(crate) fn one_tv(
    brdf: &dyn Brdf,
    reader: &Reader<'_>,
    query: &Query,
    points: &DiskPoints,
    lobe: &mut Lobe,
) -> Result<f64, FitError> {
    brdf.sample_lobe(crate::direction(query.theta, query.phi), query.validate()?, points, lobe);
    let Lookup { lobes, .. } = reader.lookup(query)?;
    Ok(total_variation(lobe, DMat3::from_row_array(lobes[0].m)))
}

/// Nodes of the quadrature that magnitude and Fresnel are held against: right to 1e-4, see [`DiskRule`].
pub(crate) const ALBEDO_NODES: usize = 8192;

/// Errors of the magnitude and the Fresnel term at each query.
fn albedo_errors(
    brdf: &dyn Brdf,
    reader: &Reader<'_>,
    settings: MeasureSettings,
    isotropic: bool,
) -> Result<Vec<[f64; 2]>, FitError> {
    let rule = DiskRule::of_about(ALBEDO_NODES);
    draw::up_to(draw::ALBEDO_THETA_MAX_DEGREES, settings.queries, settings.seed, isotropic)
        .par_iter()
        .map_init(Lobe::default, |lobe, query| albedo_error(brdf, reader, query, &rule, lobe))
        .collect()
}

/// Errors of the magnitude and the Fresnel term at one query.
pub(crate) fn albedo_error(
    brdf: &dyn Brdf,
    reader: &Reader<'_>,
    query: &Query,
    rule: &DiskRule,
    lobe: &mut Lobe,
) -> Result<[f64; 2], FitError> {
    let wo = crate::direction(query.theta, query.phi);
    let (magnitude, fresnel) = brdf.albedo(wo, query.validate()?, rule, lobe);
    let found = reader.lookup(query)?;
    Ok([(found.magnitude - magnitude).abs(), (found.fresnel - fresnel).abs()])
}

/// The least total variation that any single LTC leaves at each query of the standard draw: each fitted by itself, from the
/// medians of its lobe, and judged by other samples than it was fitted to. No table of single LTCs can do better.
///
/// # Errors
/// None for a valid BRDF.
pub fn optimum(brdf: &dyn Brdf, queries: &[Query], samples: usize) -> Result<Vec<f64>, FitError> {
    const MOST_ITERATIONS: usize = 300;
    let fitted = DiskPoints::new(samples.min(2048), [0.5, 0.5]);
    let unseen = DiskPoints::new(samples, MEASURE_SHIFT);
    queries
        .par_iter()
        .map_init(Lobe::default, |lobe, query| {
            let folded = query.fold()?;
            // Equal widths: any φ has the lobe of φ = 0, turned.
            let (phi, pattern) =
                if folded.lambda == 1.0 { (0.0, Pattern::MirrorY) } else { (folded.phi, Pattern::General) };
            let wo = crate::direction(folded.theta, phi);
            let alpha = Alpha::new(folded.alpha, folded.alpha * folded.lambda)?;
            brdf.sample_lobe(wo, alpha, &fitted, lobe);
            let EntryFit { m, .. } = fit_entry(lobe, wo, pattern, MOST_ITERATIONS);
            brdf.sample_lobe(wo, alpha, &unseen, lobe);
            Ok(total_variation(lobe, m))
        })
        .collect()
}

/// The statistics of the total variation at each query of a draw.
pub fn draw_errors(queries: &[Query], tv: &[f64], settings: MeasureSettings, isotropic: bool) -> DrawErrors {
    let mut sorted = tv.to_vec();
    sorted.sort_by(f64::total_cmp);
    let among = |narrow: bool| {
        let chosen: Vec<f64> = queries
            .iter()
            .zip(tv)
            .filter(|(q, _)| (q.alpha_x.max(q.alpha_y) < draw::NARROW_ALPHA) == narrow)
            .map(|(_, tv)| *tv)
            .collect();
        mean(&chosen)
    };
    DrawErrors {
        draw: if isotropic { "isotropic" } else { "anisotropic" }.to_owned(),
        tv_mean: mean(tv),
        tv_median: quantile(&sorted, 0.5),
        tv_p95: quantile(&sorted, 0.95),
        tv_max: maximum(tv),
        tv_mean_alpha_below_0_14: among(true),
        tv_mean_alpha_from_0_14: among(false),
        queries: queries.len() as u32,
        samples: settings.samples as u32,
        seed: settings.seed,
    }
}

/// Share of an LTC's mass below the surface's horizon: `(1 − cos γ)/2`, γ the angle between the third row of `M` (the
/// surface's normal as cosine space sees it) and z.
pub fn leak(m: DMat3) -> f64 {
    let row = m.row(2);
    let length = row.length();
    // The difference as a product, which keeps its digits when the leak is small.
    let sideways = row.x * row.x + row.y * row.y;
    if length <= 0.0 {
        1.0
    } else if row.z > 0.0 {
        0.5 * sideways / (length * (length + row.z))
    } else {
        0.5 * (1.0 - row.z / length)
    }
}

/// Condition number in the 2-norm: the ratio of the extreme singular values, by one-sided Jacobi rotations.
pub fn condition(m: DMat3) -> f64 {
    let mut c = [m.x_axis, m.y_axis, m.z_axis];
    for _ in 0..12 {
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            let (a, b, g) = (c[i].length_squared(), c[j].length_squared(), c[i].dot(c[j]));
            if g == 0.0 {
                continue;
            }
            let zeta = (b - a) / (2.0 * g);
            let t = zeta.signum() / (zeta.abs() + (1.0 + zeta * zeta).sqrt());
            let cos = 1.0 / (1.0 + t * t).sqrt();
            let sin = cos * t;
            (c[i], c[j]) = (c[i] * cos - c[j] * sin, c[i] * sin + c[j] * cos);
        }
    }
    let lengths = c.map(glam::DVec3::length);
    let largest = lengths.into_iter().fold(0.0, f64::max);
    let smallest = lengths.into_iter().fold(f64::INFINITY, f64::min);
    largest / smallest.max(f64::MIN_POSITIVE)
}

pub(crate) fn mean(values: &[f64]) -> f64 {
    if values.is_empty() { 0.0 } else { values.iter().sum::<f64>() / values.len() as f64 }
}

pub(crate) fn maximum(values: &[f64]) -> f64 {
    values.iter().copied().fold(0.0, f64::max)
}

pub(crate) fn quantile(sorted: &[f64], q: f64) -> f64 {
    let index = (q * sorted.len().saturating_sub(1) as f64).round() as usize;
    sorted.get(index).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ltc_core::{Ltc, points::r2};

    fn matrix() -> DMat3 {
        DMat3::from_row_array([0.4, 0.05, -0.9, 0.1, 0.2, -0.2, 0.3, 0.1, 0.3])
    }

    #[test]
    fn leak_is_the_share_of_samples_below() {
        let ltc = Ltc::<f64>::new(matrix()).unwrap();
        let n = 1 << 16;
        let below =
            (0..n).filter(|i| ltc.sample(r2(*i, [0.5, 0.5])).z < 0.0).count() as f64 / f64::from(1 << 16);
        assert!((leak(matrix()) - below).abs() < 1e-3, "{} {below}", leak(matrix()));
        assert!(below > 0.01);
        assert_eq!(leak(DMat3::IDENTITY), 0.0);
    }

    #[test]
    fn condition_of_known_singular_values() {
        let (u, v) =
            (DMat3::from_rotation_x(0.7), DMat3::from_rotation_y(-1.1) * DMat3::from_rotation_z(0.3));
        for small in [1.0, 1e-3, 1e-8] {
            let m = u * DMat3::from_diagonal(glam::DVec3::new(0.5, small, 1.0)) * v;
            let expected = 1.0 / f64::min(small, 0.5);
            assert!((condition(m) / expected - 1.0).abs() < 1e-6, "{} {expected}", condition(m));
        }
    }
}
