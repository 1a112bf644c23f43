//! Everything that is known of a finished fit, for people who look into it.

use glam::DMat3;
use ltc_core::Matrix;
use ltc_table::{Query, Table};
use rayon::prelude::*;
use serde::Serialize;

use crate::{
    DiskPoints, EntryRecord, FitError, Fitted, Lobe, Observer, Pattern, Plan, Progress, Stop, draw,
    fit_entry,
    grid_errors::centre_misses,
    measure::{MEASURE_SHIFT, maximum, mean, quantile},
    progress::{CHANNELS, ENTRIES, JOINT, MEASUREMENT, REPORT},
    refine_entry, total_variation,
};

/// A report on a fit, as JSON. Times are in it, so no two are the same; the table does not depend on it.
#[derive(Clone, Debug, Serialize)]
pub struct FitReport {
    /// Name of the table.
    pub name: String,
    /// What each stage took.
    pub stages: Vec<StageReport>,
    /// The table against the best single LTC at each query of the standard draw.
    pub draw: Comparison,
    /// The same, by polar angle, larger width and ratio of the widths.
    pub regions: Vec<Region>,
    /// Total variation at the centre of each cell between entries, in C order.
    pub centre_tv: Vec<f64>,
    /// Every entry, in table order.
    pub entries: Vec<EntryReport>,
}

/// Time and throughput of a stage.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StageReport {
    /// Its name.
    pub stage: String,
    /// Seconds, on all threads at once.
    pub seconds: f64,
    /// Samples of lobes that were drawn or compared with an LTC.
    pub lobe_samples: u64,
    /// The same a second.
    pub lobe_samples_per_second: f64,
}

/// Total variation of a table and of the best that one LTC can do.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Comparison {
    /// How many queries.
    pub queries: usize,
    /// Mean over them, of the table.
    pub table_tv_mean: f64,
    /// 95th percentile.
    pub table_tv_p95: f64,
    /// Maximum.
    pub table_tv_max: f64,
    /// Mean over them, of the best single LTC at each.
    pub optimum_tv_mean: f64,
    /// 95th percentile.
    pub optimum_tv_p95: f64,
    /// Maximum.
    pub optimum_tv_max: f64,
}

/// A part of the standard draw.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Region {
    /// Polar angles, degrees, from and below (the last up to its end, as of the others).
    pub theta_degrees: [f64; 2],
    /// Larger widths, from and below.
    pub alpha: [f64; 2],
    /// Ratios of the widths, from and below.
    pub lambda: [f64; 2],
    /// The errors there.
    #[serde(flatten)]
    pub comparison: Comparison,
}

/// One entry of the table.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EntryReport {
    /// Polar angle that it stands for, radians, floors applied.
    pub theta: f64,
    /// Azimuth, radians.
    pub phi: f64,
    /// Larger width.
    pub alpha: f64,
    /// Smaller width over larger.
    pub lambda: f64,
    /// The entry that it follows from; itself where it was fitted.
    pub owner: usize,
    /// Total variation between its lobe and the BRDF's.
    pub tv: f64,
    /// Share of its lobe below the horizon.
    pub leak: f64,
    /// Condition number of its matrix.
    pub condition: f64,
    /// Total variation after it was fitted by itself, over the samples that it was fitted to.
    pub tv_alone: f64,
    /// Iterations that this took.
    pub iterations: usize,
    /// Why it stopped.
    pub stop: Stop,
}

impl FitReport {
    /// Looks into a finished fit. The best LTC at each query of the standard draw takes most of the time: about what the
    /// fit of as many entries takes.
    ///
    /// # Errors
    /// [`FitError::Stopped`] when the observer says so.
    pub fn new(plan: &Plan<'_>, fitted: &Fitted, observer: Observer<'_>) -> Result<Self, FitError> {
        let (queries, errors) = compare(plan, &fitted.table, observer)?;
        let regions = regions(fitted.table.axes().len() == 2).into_iter();
        let regions = regions.map(|mut region| {
            let inside = queries.iter().zip(&errors).filter(|(query, _)| region.holds(query));
            region.comparison = Comparison::of(&inside.map(|(_, error)| *error).collect::<Vec<_>>());
            region
        });
        let samples = plan.spec().measure.samples;
        let centres = centre_misses(
            plan.brdf(),
            &fitted.table,
            plan.spec().measure.layout,
            &plan.spec().floors,
            samples,
        )?;
        Ok(Self {
            name: plan.spec().name.clone(),
            stages: stages(plan, fitted),
            draw: Comparison::of(&errors),
            regions: regions.filter(|region| region.comparison.queries > 0).collect(),
            centre_tv: centres.iter().map(|miss| miss.tv).collect(),
            entries: entries(plan, fitted),
        })
    }
}

/// Total variation of the table and of the optimum, at one query.
#[derive(Clone, Copy, Debug)]
struct QueryErrors {
    table: f64,
    optimum: f64,
}

/// Both errors at every query of the standard draw: those of the manifest.
fn compare(
    plan: &Plan<'_>,
    table: &Table,
    observer: Observer<'_>,
) -> Result<(Vec<Query>, Vec<QueryErrors>), FitError> {
    /// Iterations for an optimum: enough to converge.
    const ITERATIONS: usize = 300;
    let (brdf, settings) = (plan.brdf(), plan.spec().measure);
    let reader = settings.layout.reader(table)?;
    let queries = draw::standard(settings.queries, settings.seed, table.axes().len() == 2);
    let [fitted, unseen] = [[0.5, 0.5], MEASURE_SHIFT].map(|shift| DiskPoints::new(settings.samples, shift));
    let done = std::sync::atomic::AtomicUsize::new(0);
    let errors: Result<Vec<QueryErrors>, FitError> = queries
        .par_iter()
        .map_init(Lobe::default, |lobe, query| {
            let (wo, alpha) = (crate::direction(query.theta, query.phi), query.validate()?);
            let of_table = DMat3::from_row_array(reader.lookup(query)?.lobes[0].m);
            brdf.sample_lobe(wo, alpha, &fitted, lobe);
            let starts = [
                fit_entry(lobe, wo, Pattern::General, ITERATIONS),
                refine_entry(lobe, of_table, Pattern::General, ITERATIONS),
            ];
            brdf.sample_lobe(wo, alpha, &unseen, lobe);
            let table = total_variation(lobe, of_table);
            let optimum = starts.iter().map(|fit| total_variation(lobe, fit.m)).fold(table, f64::min);
            let done = 1 + done.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
            let go_on = observer(Progress { stage: REPORT, done, total: queries.len(), tv: None });
            if go_on { Ok(QueryErrors { table, optimum }) } else { Err(FitError::Stopped) }
        })
        .collect();
    let errors = errors?;
    Ok((queries, errors))
}

impl Comparison {
    fn of(errors: &[QueryErrors]) -> Self {
        let sorted = |of: fn(&QueryErrors) -> f64| {
            let mut values: Vec<f64> = errors.iter().map(of).collect();
            values.sort_by(f64::total_cmp);
            values
        };
        let (table, optimum) = (sorted(|e| e.table), sorted(|e| e.optimum));
        Self {
            queries: errors.len(),
            table_tv_mean: mean(&table),
            table_tv_p95: quantile(&table, 0.95),
            table_tv_max: maximum(&table),
            optimum_tv_mean: mean(&optimum),
            optimum_tv_p95: quantile(&optimum, 0.95),
            optimum_tv_max: maximum(&optimum),
        }
    }
}

/// The parts of the draw, without their errors.
fn regions(isotropic: bool) -> Vec<Region> {
    const THETA: [f64; 5] = [0.0, 30.0, 60.0, 75.0, 90.0];
    const ALPHA: [f64; 4] = [0.0, draw::NARROW_ALPHA, 0.4, 1.0];
    const LAMBDA: [f64; 3] = [0.0, 0.3, 1.0];
    let lambdas: &[f64] = if isotropic { &[0.0, 1.0] } else { &LAMBDA };
    let mut regions = Vec::new();
    for theta in THETA.windows(2) {
        for alpha in ALPHA.windows(2) {
            for lambda in lambdas.windows(2) {
                let [theta_degrees, alpha, lambda] = [theta, alpha, lambda].map(|w| [w[0], w[1]]);
                regions.push(Region { theta_degrees, alpha, lambda, comparison: Comparison::default() });
            }
        }
    }
    regions
}

impl Region {
    fn holds(&self, query: &Query) -> bool {
        let (low, high) = (query.alpha_x.min(query.alpha_y), query.alpha_x.max(query.alpha_y));
        let within = |[from, to]: [f64; 2], value: f64, end: f64| from <= value && (value < to || to == end);
        within(self.theta_degrees, query.theta.to_degrees(), 90.0)
            && within(self.alpha, high, 1.0)
            && within(self.lambda, low / high, 1.0)
    }
}

fn entries(plan: &Plan<'_>, fitted: &Fitted) -> Vec<EntryReport> {
    let (lattice, cells) = (plan.lattice(), fitted.table.cells());
    let mut alone: Vec<Option<&EntryRecord>> = vec![None; lattice.nodes.len()];
    for (owner, record) in plan.owners().iter().zip(&fitted.entries) {
        alone[*owner] = Some(record);
    }
    let report = |i: usize| {
        let (node, owner) = (&lattice.nodes[i], lattice.ties[i].owner);
        alone[owner].map(|record| EntryReport {
            theta: node.theta,
            phi: node.phi,
            alpha: node.alpha,
            lambda: node.lambda,
            owner,
            tv: cells.tv[i],
            leak: cells.leak[i],
            condition: cells.condition[i],
            tv_alone: record.tv,
            iterations: record.iterations,
            stop: record.stop,
        })
    };
    (0..lattice.nodes.len()).filter_map(report).collect()
}

fn stages(plan: &Plan<'_>, fitted: &Fitted) -> Vec<StageReport> {
    let spec = plan.spec();
    let nodes = plan.lattice().nodes.len();
    let centres: usize = spec.axes.iter().map(|axis| axis.len - 1).product();
    let comparisons: usize = fitted.entries.iter().map(|entry| 1 + entry.evaluations).sum();
    let stage = |time: &crate::StageTime| {
        let samples = match time.stage.as_str() {
            ENTRIES => comparisons * spec.entries.samples,
            JOINT => spec.joint.steps * spec.joint.queries * spec.joint.samples,
            CHANNELS => (nodes + spec.channels.all_queries()) * spec.channels.samples,
            MEASUREMENT => (2 * nodes + centres + spec.measure.queries) * spec.measure.samples,
            _ => 0,
        };
        StageReport {
            stage: time.stage.clone(),
            seconds: time.seconds,
            lobe_samples: samples as u64,
            lobe_samples_per_second: samples as f64 / time.seconds.max(f64::MIN_POSITIVE),
        }
    };
    fitted.times.iter().map(stage).collect()
}
