//! What a running fit tells, on its way from its threads to the job.

use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::Instant;

use ltc_fit::progress::{CHANNELS, ENTRIES, JOINT, MEASUREMENT};
use ltc_fit::{Cost, Forecast, Outlook, Plan, Progress};
use ltc_store::ShardReport;

/// Lines of the log that wait for the next report; more are dropped.
const LINES: usize = 100;

/// Shared by the threads that fit and the task that reports.
pub(crate) struct Live {
    stop: AtomicBool,
    start: Instant,
    /// Lobes of each stage, once the plan is known.
    lobes: OnceLock<[(&'static str, u64); 4]>,
    state: Mutex<State>,
}

struct State {
    forecast: Forecast,
    stage: &'static str,
    outlook: Outlook,
    tv: Option<f64>,
    /// Lobes evaluated so far in this attempt, and the share of the stage at which counting began.
    lobes: f64,
    stage_done: f64,
    lines: VecDeque<String>,
}

impl Live {
    /// For a job that has come so far, which holds until the fit says more.
    pub(crate) fn new(cost: &Cost, done: f64) -> Self {
        let state = State {
            forecast: Forecast::new(cost),
            stage: "",
            outlook: Outlook { done, stage_left: None, left: None },
            tv: None,
            lobes: 0.0,
            stage_done: 0.0,
            lines: VecDeque::new(),
        };
        Self {
            stop: AtomicBool::new(false),
            start: Instant::now(),
            lobes: OnceLock::new(),
            state: Mutex::new(state),
        }
    }

    /// Says what is fitted.
    pub(crate) fn plan(&self, plan: &Plan<'_>) {
        self.lobes.get_or_init(|| lobes(plan));
    }

    /// Asks the fit to stop.
    pub(crate) fn stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    /// Takes a report from the fit; whether it may go on.
    pub(crate) fn observe(&self, progress: &Progress) -> bool {
        let mut state = self.state();
        let within = progress.done as f64 / progress.total.max(1) as f64;
        let known = self.lobes.get().into_iter().flatten().find(|(stage, _)| *stage == progress.stage);
        let of_stage = known.map_or(0.0, |(_, lobes)| *lobes as f64);
        if state.stage != progress.stage {
            // What was done before the first report was done by an earlier attempt.
            state.stage_done = if state.stage.is_empty() { within } else { 0.0 };
            state.stage = progress.stage;
            let left = progress.total.saturating_sub(progress.done);
            state.lines.push_back(format!("{}: {left} of {} left", progress.stage, progress.total));
        }
        if within > state.stage_done {
            state.lobes += (within - state.stage_done) * of_stage;
            state.stage_done = within;
        }
        state.tv = progress.tv.or(state.tv);
        state.outlook = state.forecast.update(progress, self.start.elapsed());
        !self.stop.load(Ordering::Relaxed)
    }

    /// Adds a line to the log.
    pub(crate) fn say(&self, line: String) {
        let mut state = self.state();
        if state.lines.len() < LINES {
            state.lines.push_back(line);
        }
    }

    /// What there is to report now; each line is told once.
    pub(crate) fn report(&self) -> ShardReport {
        let mut state = self.state();
        let lines: Vec<String> = state.lines.drain(..).collect();
        ShardReport {
            progress: state.outlook.done,
            seconds_left: state.outlook.left.map(|left| left.as_secs_f64()),
            tv: state.tv,
            log: (!lines.is_empty()).then(|| lines.join("\n")),
        }
    }

    /// Lobes evaluated in this attempt, and the mean total variation at present.
    pub(crate) fn figures(&self) -> (u64, Option<f64>) {
        let state = self.state();
        (state.lobes as u64, state.tv)
    }

    fn state(&self) -> MutexGuard<'_, State> {
        // Nothing panics while it holds this lock.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Lobes of the BRDF that each stage draws.
fn lobes(plan: &Plan<'_>) -> [(&'static str, u64); 4] {
    let spec = plan.spec();
    let nodes = plan.lattice().nodes.len();
    let centres: usize = spec.axes.iter().map(|axis| axis.len - 1).product();
    [
        (ENTRIES, plan.owners().len()),
        (JOINT, spec.joint.steps * spec.joint.queries),
        (CHANNELS, nodes + spec.channels.all_queries()),
        (MEASUREMENT, 2 * nodes + centres + spec.measure.queries),
    ]
    .map(|(stage, lobes)| (stage, lobes as u64))
}
