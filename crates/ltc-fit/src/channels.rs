//! Magnitude and Fresnel: by quadrature at the entries, then so that what is interpolated is right between them.

use ltc_core::points::SplitMix64;
use ltc_table::{Axis, ClosedForm, Query, lookup::Corner};
use rayon::prelude::*;

use crate::{
    Brdf, DiskRule, FitError, Lattice, Lobe, draw,
    joint::query_corners,
    pieces::{self, Item},
};

/// Settings of [`fit_channels`].
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ChannelSettings {
    /// Nodes of each integral's quadrature, see [`DiskRule`].
    pub samples: usize,
    /// Random queries between the entries; 0 keeps the entries' own values.
    pub queries: usize,
    /// Seed of the queries.
    pub seed: u64,
    /// Power of the interpolation error that is minimised: 2 for the least mean, more for a smaller largest error.
    #[serde(default = "squares", skip_serializing_if = "is_squares")]
    pub power: u32,
    /// Formula for what changes too fast to be interpolated: entries are then fitted so that the formula at a query and the
    /// interpolation of what it leaves of them are right together. Takes [`ChannelSettings::queries`] even over the axes as
    /// well. None: entries are interpolated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub closed_form: Option<ClosedForm>,
}

impl ChannelSettings {
    /// Queries of all kinds.
    pub fn all_queries(&self) -> usize {
        if self.closed_form.is_some() { 2 * self.queries } else { self.queries }
    }
}

fn squares() -> u32 {
    2
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde calls it with a reference")]
fn is_squares(power: &u32) -> bool {
    *power == squares()
}

/// Magnitude and Fresnel term of every entry.
pub type Channels = (Vec<f64>, Vec<f64>);

/// Integrates both over every entry's lobe, then moves the entries to the least sum of a power of the error of lookups over
/// random queries up to grazing, held to their own values where few queries come. With a closed form `g` the error of a lookup
/// is that of `g(query) + Σ wᵢ (entryᵢ − g(nodeᵢ))`, and `magnitude` of an entry may be up to 0.02 beyond the most there is.
///
/// # Errors
/// [`FitError::Table`] for a closed form of an isotropic table; none for other valid axes and settings.
pub fn fit_channels(
    brdf: &dyn Brdf,
    axes: &[Axis],
    lattice: &Lattice,
    settings: ChannelSettings,
) -> Result<Channels, FitError> {
    let stage = ChannelStage::new(brdf, axes, lattice, settings)?;
    stage.finish(&pieces::all(stage.len(), |lobe, i| stage.item(lobe, i))?)
}

/// [`fit_channels`] as numbered evaluations, the entries and then the queries, that can be done in parts.
pub(crate) struct ChannelStage<'a> {
    brdf: &'a dyn Brdf,
    axes: &'a [Axis],
    lattice: &'a Lattice,
    rule: DiskRule,
    queries: Vec<Query>,
    power: u32,
    form: Option<Form>,
}

/// A closed form and its values at the entries.
struct Form {
    form: ClosedForm,
    at_entries: Vec<[f64; 2]>,
}

impl Form {
    fn new(form: ClosedForm, axes: &[Axis]) -> Result<Self, FitError> {
        Ok(Self { form, at_entries: form.at_entries(axes)? })
    }

    /// What lookups of a query add to the interpolation of entries: the form there less the interpolation of its values.
    fn added(&self, query: &Query, corners: &[Corner]) -> Result<[f64; 2], FitError> {
        let widths = query.validate()?;
        let mut added = self.form.at(crate::direction(query.theta, query.phi), widths.x(), widths.y());
        for Corner { index, weight } in corners {
            for (added, at) in added.iter_mut().zip(self.at_entries[*index]) {
                *added -= weight * at;
            }
        }
        Ok(added)
    }
}

impl<'a> ChannelStage<'a> {
    pub(crate) fn new(
        brdf: &'a dyn Brdf,
        axes: &'a [Axis],
        lattice: &'a Lattice,
        settings: ChannelSettings,
    ) -> Result<Self, FitError> {
        let rule = DiskRule::of_about(settings.samples);
        let isotropic = axes.len() == 2;
        let mut rng = SplitMix64::new(settings.seed);
        let mut queries = draw::grazing(&mut rng, settings.queries, isotropic);
        let form = settings.closed_form.map(|form| Form::new(form, axes)).transpose()?;
        if form.is_some() {
            queries.extend(draw::over(&mut rng, settings.queries, axes));
        }
        Ok(Self { brdf, axes, lattice, rule, queries, power: settings.power, form })
    }

    /// Evaluations in all.
    pub(crate) fn len(&self) -> usize {
        self.lattice.nodes.len() + self.queries.len()
    }

    /// Magnitude and Fresnel term at an entry or a query.
    pub(crate) fn item(&self, lobe: &mut Lobe, index: usize) -> Result<Item, FitError> {
        let nodes = &self.lattice.nodes;
        let (wo, alpha) = match nodes.get(index) {
            Some(node) => (node.wo(), node.widths()?),
            None => {
                let query = &self.queries[index - nodes.len()];
                (crate::direction(query.theta, query.phi), query.validate()?)
            }
        };
        let (magnitude, fresnel) = self.brdf.albedo(wo, alpha, &self.rule, lobe);
        Ok([magnitude, fresnel, 0.0])
    }

    /// The channels, from all evaluations.
    pub(crate) fn finish(&self, items: &[Item]) -> Result<Channels, FitError> {
        let (own, between) = items.split_at(self.lattice.nodes.len().min(items.len()));
        let (magnitude, fresnel): (Vec<f64>, Vec<f64>) = own.iter().map(|item| (item[0], item[1])).unzip();
        if between.is_empty() {
            return Ok((magnitude, fresnel));
        }
        let rows: Vec<Row> = self
            .queries
            .par_iter()
            .zip(between)
            .map(|(query, item)| self.row(query, item))
            .collect::<Result<_, _>>()?;
        // No surface reflects more than it gets (or its model lets it), and a Fresnel weight is at most 1: least squares
        // alone may say otherwise.
        let slack = if self.form.is_some() { FORM_SLACK } else { 0.0 };
        let most = vec![self.brdf.max_magnitude() + slack; magnitude.len()];
        let magnitude = self.solve(&magnitude, &rows, &most, |row| row.magnitude);
        let fresnel = self.solve(&fresnel, &rows, &magnitude, |row| row.fresnel);
        Ok((magnitude, fresnel))
    }

    /// The entries between 0 and `most` that leave the least errors, those that share a lobe alike.
    fn solve(&self, own: &[f64], rows: &[Row], most: &[f64], value: fn(&Row) -> f64) -> Vec<f64> {
        let pull = if self.form.is_some() { FORM_PULL } else { PULL };
        tied(self.lattice, &least_power(self.power, pull, own, rows, most, value))
    }

    /// The equation of a query, for the entries that own themselves: those that share a lobe share a value.
    fn row(&self, query: &Query, item: &Item) -> Result<Row, FitError> {
        let mut corners = query_corners(self.axes, &query.fold()?);
        let added = match &self.form {
            Some(form) => form.added(query, &corners)?,
            None => [0.0; 2],
        };
        for corner in &mut corners {
            corner.index = self.lattice.ties[corner.index].owner;
        }
        let [magnitude, fresnel] = [0, 1].map(|i| item[i] - added[i]);
        Ok(Row { corners, magnitude, fresnel, judged: draw::is_judged(query) })
    }
}

/// One equation: the interpolation of some entries is a value.
struct Row {
    corners: Vec<Corner>,
    magnitude: f64,
    fresnel: f64,
    /// Whether its largest errors count for more than their squares.
    judged: bool,
}

impl Row {
    fn interpolate(&self, x: &[f64]) -> f64 {
        self.corners.iter().map(|c| c.weight * x[c.index]).sum()
    }
}

/// Weight of an entry's own value against one query at it.
const PULL: f64 = 0.05;
/// The same with a closed form, where an entry's own value is nearly the best one: few queries must not carry it off.
const FORM_PULL: f64 = 0.5;

/// How far an entry of magnitude may go beyond the most there is, with a closed form: it stands between the form and what lookups
/// come to, which is clamped. With none the largest error of magnitude of `ggx-anisotropic-closed-form` doubles, and 0.02 is all that it takes.
const FORM_SLACK: f64 = 0.02;

/// Minimises `Σ |interpolation − value|ᵖ` by Newton's method: a step is 1/(p − 1) of the way to the weighted least squares
/// whose weights are `|residual|^(p − 2)`. The power grows from 2 by one each step, so that each begins near its end.
/// Queries outside the judged draw count by their squares: their errors are larger, and would have all weight.
fn least_power(
    power: u32,
    pull: f64,
    own: &[f64],
    rows: &[Row],
    most: &[f64],
    value: fn(&Row) -> f64,
) -> Vec<f64> {
    let bounded =
        |x: Vec<f64>| -> Vec<f64> { x.iter().zip(most).map(|(x, most)| x.clamp(0.0, *most)).collect() };
    let mut weights = vec![1.0; rows.len()];
    let mut solved = bounded(least_squares(own, pull, own, rows, &weights, most, value));
    let steps = if power > 2 { NEWTON_STEPS } else { 0 };
    for step in 1..=steps {
        let p = power.min(2 + step);
        let residuals: Vec<f64> =
            rows.iter().map(|row| (value(row) - row.interpolate(&solved)).abs()).collect();
        let mean = (residuals.iter().sum::<f64>() / rows.len() as f64).max(f64::MIN_POSITIVE);
        for ((weight, residual), row) in weights.iter_mut().zip(&residuals).zip(rows) {
            let wanted = (residual / mean).clamp(LEAST_RESIDUAL, MOST_RESIDUAL).powi(p as i32 - 2);
            *weight = if row.judged { wanted } else { 1.0 };
        }
        let goal = least_squares(&solved, pull, own, rows, &weights, most, value);
        let part = 1.0 / f64::from(p - 1);
        solved = bounded(solved.iter().zip(goal).map(|(x, goal)| x + part * (goal - x)).collect());
    }
    solved
}

/// Steps of [`least_power`]; the largest errors settle within ten.
const NEWTON_STEPS: u32 = 12;
/// Residuals below this part of the average count as this: an entry that all queries agree with stays determined.
const LEAST_RESIDUAL: f64 = 0.3;
/// Residuals above this multiple of the average count as this: single queries would decide.
const MOST_RESIDUAL: f64 = 30.0;

/// Minimises `Σ weight (interpolation − value)² + pull Σ (entry − own)²` from `start` by conjugate gradients on the normal
/// equations, each unknown in the units of its own curvature. Those that lie at 0 or at `most` and would go beyond stay where
/// they are.
fn least_squares(
    start: &[f64],
    pull: f64,
    own: &[f64],
    rows: &[Row],
    weights: &[f64],
    most: &[f64],
    value: fn(&Row) -> f64,
) -> Vec<f64> {
    let mut curvature = vec![pull; start.len()];
    let mut pulled: Vec<f64> = own.iter().zip(start).map(|(own, start)| pull * (own - start)).collect();
    for (row, weight) in rows.iter().zip(weights) {
        let excess = weight * (value(row) - row.interpolate(start));
        for corner in &row.corners {
            pulled[corner.index] += corner.weight * excess;
            curvature[corner.index] += weight * corner.weight * corner.weight;
        }
    }
    let held: Vec<bool> = (0..start.len())
        .map(|i| (start[i] >= most[i] && pulled[i] > 0.0) || (start[i] <= 0.0 && pulled[i] < 0.0))
        .collect();
    let free = |mut x: Vec<f64>| {
        x.iter_mut().zip(&held).filter(|(_, held)| **held).for_each(|(x, _)| *x = 0.0);
        x
    };
    let mut residual = free(pulled);
    let apply = |x: &[f64]| {
        let mut out: Vec<f64> = x.iter().map(|v| pull * v).collect();
        for (row, weight) in rows.iter().zip(weights) {
            let inner = weight * row.interpolate(x);
            for corner in &row.corners {
                out[corner.index] += corner.weight * inner;
            }
        }
        free(out)
    };
    let scaled = |r: &[f64]| r.iter().zip(&curvature).map(|(r, c)| r / c).collect::<Vec<f64>>();
    let mut change = vec![0.0; start.len()];
    let mut direction = scaled(&residual);
    let mut square = dot(&residual, &direction);
    let enough = 1e-12 * square;
    for _ in 0..100 {
        if square <= enough {
            break;
        }
        let image = apply(&direction);
        let step = square / dot(&direction, &image);
        for i in 0..change.len() {
            change[i] += step * direction[i];
            residual[i] -= step * image[i];
        }
        let preconditioned = scaled(&residual);
        let next = dot(&residual, &preconditioned);
        for (d, r) in direction.iter_mut().zip(&preconditioned) {
            *d = r + next / square * *d;
        }
        square = next;
    }
    start.iter().zip(change).map(|(x, d)| x + d).collect()
}

/// The values of the owners, given to those that follow them.
fn tied(lattice: &Lattice, values: &[f64]) -> Vec<f64> {
    lattice.ties.iter().map(|tie| values[tie.owner]).collect()
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
            judged: true,
        };
        let rows: Vec<Row> = (0..3000).map(|i| row(f64::from(i) / 2999.0)).collect();
        let start = [0.9, 3.2];
        let solved =
            least_squares(&start, PULL, &start, &rows, &vec![1.0; rows.len()], &[9.0; 2], |r| r.magnitude);
        assert!((solved[0] - 1.0).abs() < 1e-3 && (solved[1] - 3.0).abs() < 1e-3, "{solved:?}");
    }

    #[test]
    fn powers_of_the_error_are_minimised() {
        // 1 + x² by a line, which by symmetry is 1 − c + x: c solves ∫ (x² − x + c)^(p−1) dx = 0, found by bisection, and the
        // error is largest at the ends, where it is c. The least largest error is 1/8.
        let row = |t: f64| Row {
            corners: vec![Corner { index: 0, weight: 1.0 - t }, Corner { index: 1, weight: t }],
            magnitude: 1.0 + t * t,
            fresnel: 0.0,
            judged: true,
        };
        let rows: Vec<Row> = (0..3000).map(|i| row(f64::from(i) / 2999.0)).collect();
        let largest = |power| {
            let solved = least_power(power, PULL, &[1.0, 2.0], &rows, &[9.0; 2], |r| r.magnitude);
            rows.iter().map(|row| (row.magnitude - row.interpolate(&solved)).abs()).fold(0.0, f64::max)
        };
        for (power, expected) in [(2, 1.0 / 6.0), (4, 0.151_022), (8, 0.140_599)] {
            let found = largest(power);
            assert!((found - expected).abs() < 3e-4, "{power}: {found}");
        }
    }

    /// The preset with a few nodes.
    fn small() -> crate::FitSpec {
        let mut spec = crate::FitSpec::preset("ggx-anisotropic-closed-form").unwrap();
        spec.axes.iter_mut().zip([5, 3, 5, 4]).for_each(|(axis, len)| axis.len = len);
        (spec.channels.samples, spec.channels.queries) = (512, 3000);
        spec
    }

    /// A table of these channels; its lobes are of no consequence.
    fn table(spec: &crate::FitSpec, (magnitude, fresnel): Channels) -> ltc_table::Table {
        let m = vec![glam::DMat3::IDENTITY; magnitude.len()];
        let table =
            ltc_table::Table::new(spec.axes.clone(), m, magnitude, fresnel, ltc_table::CellStats::default());
        table.unwrap().with_closed_form(spec.channels.closed_form).unwrap()
    }

    #[test]
    fn rows_say_what_lookups_say() {
        let spec = small();
        let lattice = Lattice::new(&spec.axes, &spec.floors);
        let brdf = spec.brdf().unwrap();
        let stage = ChannelStage::new(brdf, &spec.axes, &lattice, spec.channels).unwrap();
        assert_eq!(stage.len(), lattice.nodes.len() + spec.channels.all_queries());
        // Entries in mid-range, so that nothing is clamped; alike where they share a lobe.
        let entries: Vec<f64> = lattice.ties.iter().map(|tie| 0.4 + 1e-4 * tie.owner as f64).collect();
        let table = table(&spec, (entries.clone(), entries.clone()));
        for query in stage.queries.iter().step_by(7) {
            let found = table.lookup(query).unwrap();
            // The residual of an equation is the lookup's error.
            let row = stage.row(query, &[0.7, 0.6, 0.0]).unwrap();
            let interpolated = row.interpolate(&entries);
            assert!((row.magnitude - interpolated - (0.7 - found.magnitude)).abs() < 1e-12, "{query:?}");
            assert!((row.fresnel - interpolated - (0.6 - found.fresnel)).abs() < 1e-12, "{query:?}");
        }
    }

    #[test]
    fn a_closed_form_lessens_the_errors() {
        let with = small();
        let mut without = with.clone();
        without.channels.closed_form = None;
        let (brdf, rule) = (with.brdf().unwrap(), DiskRule::of_about(2048));
        let queries = draw::up_to(draw::ALBEDO_THETA_MAX_DEGREES, 400, 7, false);
        let [form, plain] = [with, without].map(|spec| {
            let lattice = Lattice::new(&spec.axes, &spec.floors);
            let table = table(&spec, fit_channels(brdf, &spec.axes, &lattice, spec.channels).unwrap());
            let mut lobe = Lobe::default();
            let errors = queries.iter().map(|query| {
                let wo = crate::direction(query.theta, query.phi);
                let (n, f) = brdf.albedo(wo, query.validate().unwrap(), &rule, &mut lobe);
                let found = table.lookup(query).unwrap();
                [(found.magnitude - n).abs(), (found.fresnel - f).abs()]
            });
            errors.fold([0.0; 2], |sum, error| [sum[0] + error[0], sum[1] + error[1]]).map(|sum| sum / 400.0)
        });
        for k in 0..2 {
            assert!(form[k] < 0.75 * plain[k], "{form:?} with, {plain:?} without");
        }
    }
}
