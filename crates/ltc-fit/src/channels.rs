//! Magnitude and Fresnel: by quadrature at the entries, then so that what is interpolated is right between them.

use ltc_core::points::SplitMix64;
use ltc_table::{Axis, lookup::Corner};
use rayon::prelude::*;

use crate::{Brdf, DiskPoints, FitError, Lattice, Lobe, Observer, Progress, draw, joint::query_corners};

/// Settings of [`fit_channels`].
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ChannelSettings {
    /// Visible-normal samples of each integral.
    pub samples: usize,
    /// Random queries between the entries; 0 keeps the entries' own values.
    pub queries: usize,
    /// Seed of the queries.
    pub seed: u64,
}

/// Magnitude and Fresnel term of every entry.
pub type Channels = (Vec<f64>, Vec<f64>);

/// Integrates both over every entry's lobe, then moves the entries to the least squares of the interpolation error over
/// random queries, held to their own values where few queries come.
///
/// # Errors
/// [`FitError::Stopped`] when the observer says so.
pub fn fit_channels(
    brdf: &dyn Brdf,
    axes: &[Axis],
    lattice: &Lattice,
    settings: ChannelSettings,
    observer: Observer<'_>,
) -> Result<Channels, FitError> {
    let points = DiskPoints::new(settings.samples, [0.5, 0.5]);
    let own: Result<Vec<(f64, f64)>, FitError> = lattice
        .nodes
        .par_iter()
        .map_init(Lobe::default, |lobe, node| {
            brdf.sample_lobe(node.wo(), node.widths()?, &points, lobe);
            Ok((lobe.magnitude, lobe.fresnel))
        })
        .collect();
    let (magnitude, fresnel): (Vec<f64>, Vec<f64>) = own?.into_iter().unzip();
    report(observer, 1)?;
    if settings.queries == 0 {
        return Ok((magnitude, fresnel));
    }
    let rows = sample_rows(brdf, axes, settings, &points)?;
    report(observer, 2)?;
    let solve = |start: &[f64], value: fn(&Row) -> f64| tied(lattice, &least_squares(start, &rows, value));
    let mut magnitude = solve(&magnitude, |r| r.magnitude);
    let mut fresnel = solve(&fresnel, |r| r.fresnel);
    // No surface reflects more than it gets (or its model lets it), and a Fresnel weight is at most 1: least squares alone
    // may say otherwise.
    for (n, f) in magnitude.iter_mut().zip(&mut fresnel) {
        *n = n.clamp(0.0, brdf.max_magnitude());
        *f = f.clamp(0.0, *n);
    }
    report(observer, 3)?;
    Ok((magnitude, fresnel))
}

fn report(observer: Observer<'_>, done: usize) -> Result<(), FitError> {
    let go_on = observer(Progress { stage: "magnitude and Fresnel", done, total: 3, tv: None });
    if go_on { Ok(()) } else { Err(FitError::Stopped) }
}

/// One equation: the interpolation of some entries is a value.
struct Row {
    corners: Vec<Corner>,
    magnitude: f64,
    fresnel: f64,
}

fn sample_rows(
    brdf: &dyn Brdf,
    axes: &[Axis],
    settings: ChannelSettings,
    points: &DiskPoints,
) -> Result<Vec<Row>, FitError> {
    let isotropic = axes.len() == 2;
    let queries = draw::training(&mut SplitMix64::new(settings.seed), settings.queries, isotropic);
    queries
        .par_iter()
        .map_init(Lobe::default, |lobe, query| {
            brdf.sample_lobe(crate::direction(query.theta, query.phi), query.validate()?, points, lobe);
            let corners = query_corners(axes, &query.fold()?);
            Ok(Row { corners, magnitude: lobe.magnitude, fresnel: lobe.fresnel })
        })
        .collect()
}

/// Weight of an entry's own value against one query at it.
const PULL: f64 = 0.05;

/// Minimises `Σ (interpolation − value)² + PULL Σ (entry − start)²` by conjugate gradients on the normal equations.
fn least_squares(start: &[f64], rows: &[Row], value: fn(&Row) -> f64) -> Vec<f64> {
    let interpolate = |x: &[f64], row: &Row| row.corners.iter().map(|c| c.weight * x[c.index]).sum::<f64>();
    let apply = |x: &[f64]| {
        let mut out: Vec<f64> = x.iter().map(|v| PULL * v).collect();
        for row in rows {
            let inner = interpolate(x, row);
            for corner in &row.corners {
                out[corner.index] += corner.weight * inner;
            }
        }
        out
    };
    let mut residual = vec![0.0; start.len()];
    for row in rows {
        let excess = value(row) - interpolate(start, row);
        for corner in &row.corners {
            residual[corner.index] += corner.weight * excess;
        }
    }
    let mut change = vec![0.0; start.len()];
    let mut direction = residual.clone();
    let mut square = dot(&residual, &residual);
    let enough = 1e-16 * square;
    for _ in 0..200 {
        if square <= enough {
            break;
        }
        let image = apply(&direction);
        let step = square / dot(&direction, &image);
        for i in 0..change.len() {
            change[i] += step * direction[i];
            residual[i] -= step * image[i];
        }
        let next = dot(&residual, &residual);
        for (d, r) in direction.iter_mut().zip(&residual) {
            *d = r + next / square * *d;
        }
        square = next;
    }
    start.iter().zip(change).map(|(x, d)| x + d).collect()
}

/// The values of entries that share a lobe, made equal.
fn tied(lattice: &Lattice, values: &[f64]) -> Vec<f64> {
    let mut sums = vec![(0.0, 0.0); values.len()];
    for (tie, value) in lattice.ties.iter().zip(values) {
        sums[tie.owner].0 += value;
        sums[tie.owner].1 += 1.0;
    }
    lattice.ties.iter().map(|tie| sums[tie.owner].0 / sums[tie.owner].1).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn least_squares_finds_a_line_through_its_points() {
        // Two entries, interpolated at three places whose values lie on a line from 1 to 3.
        let row = |t: f64| Row {
            corners: vec![Corner { index: 0, weight: 1.0 - t }, Corner { index: 1, weight: t }],
            magnitude: 1.0 + 2.0 * t,
            fresnel: 0.0,
        };
        let rows: Vec<Row> = (0..3000).map(|i| row(f64::from(i) / 2999.0)).collect();
        let solved = least_squares(&[0.9, 3.2], &rows, |r| r.magnitude);
        assert!((solved[0] - 1.0).abs() < 1e-3 && (solved[1] - 3.0).abs() < 1e-3, "{solved:?}");
    }
}
