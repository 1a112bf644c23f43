//! A fit in pieces: it can stop between any two of them, be written down, and go on later or elsewhere.

use std::time::Instant;

use glam::DMat3;
use ltc_table::{CellStats, Errors, Table};
use serde::{Deserialize, Serialize};

use crate::{
    EntryFit, FitError, Observer, Plan, Progress, Stop,
    channels::{self, ChannelStage},
    entries, grid_errors,
    joint::{JointState, Refinement},
    measurement::Measurement,
    pieces,
    progress::{CHANNELS, ENTRIES, JOINT, MEASUREMENT},
};

/// How one entry that owns itself was fitted, before the joint refinement.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EntryRecord {
    /// `M`, column-major.
    pub m: [f64; 9],
    /// Total variation over the samples that were fitted.
    pub tv: f64,
    /// Iterations that it took.
    pub iterations: usize,
    /// How often the lobe was compared with an LTC.
    pub evaluations: usize,
    /// Why it stopped.
    pub stop: Stop,
}

impl From<EntryFit> for EntryRecord {
    fn from(fit: EntryFit) -> Self {
        let EntryFit { m, tv, iterations, evaluations, stop, .. } = fit;
        Self { m: m.to_cols_array(), tv, iterations, evaluations, stop }
    }
}

/// Time that a stage has taken so far, interruptions left out. No result depends on it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StageTime {
    /// Name of the stage.
    pub stage: String,
    /// Seconds.
    pub seconds: f64,
}

/// What a fit knows between two pieces of work. With the specification it is all that the rest depends on: a fit that
/// goes on from it ends with the same table, to the last bit.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FitState {
    /// The owners fitted by themselves so far, in table order.
    pub entries: Vec<EntryRecord>,
    /// The joint refinement, once a step of it is done.
    pub joint: Option<JointState>,
    /// Every `M` (column-major) after the joint refinement; empty before its end.
    pub m: Vec<[f64; 9]>,
    /// What the stage after the joint refinement, or the measurement, has evaluated so far; empty between stages.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub evaluated: Vec<[f64; 3]>,
    /// Magnitude and Fresnel term of every entry.
    pub channels: Option<channels::Channels>,
    /// The statistics.
    pub errors: Option<Measured>,
    /// Times of the stages that have begun.
    pub times: Vec<StageTime>,
}

/// The statistics of a finished table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Measured {
    /// Total variation of each entry.
    pub tv: Vec<f64>,
    /// Leak of each entry.
    pub leak: Vec<f64>,
    /// Condition number of each entry.
    pub condition: Vec<f64>,
    /// The summary.
    pub errors: Errors,
}

/// A finished fit.
#[derive(Clone, Debug)]
pub struct Fitted {
    /// The table.
    pub table: Table,
    /// Its errors.
    pub errors: Errors,
    /// How the owners were fitted, in table order.
    pub entries: Vec<EntryRecord>,
    /// What each stage took.
    pub times: Vec<StageTime>,
}

/// A fit that is done piece by piece.
pub struct FitRun<'a> {
    plan: &'a Plan<'a>,
    state: FitState,
    /// The refinement while it is under way; its own state is in it, not in `state`.
    refinement: Option<Refinement<'a>>,
}

impl<'a> FitRun<'a> {
    /// Before the first piece.
    pub fn new(plan: &'a Plan<'a>) -> Self {
        Self { plan, state: FitState::default(), refinement: None }
    }

    /// Goes on from a state that [`FitRun::state`] gave for the same plan.
    ///
    /// # Errors
    /// [`FitError::State`] when it is of another table.
    pub fn resume(plan: &'a Plan<'a>, state: FitState) -> Result<Self, FitError> {
        let wrong = |what| Err(FitError::State { what });
        let (owners, nodes) = (plan.owners().len(), plan.lattice().nodes.len());
        let all_fitted = state.entries.len() == owners;
        let lengths = |arrays: &[usize]| arrays.iter().all(|len| *len == nodes);
        if state.entries.len() > owners {
            return wrong("it has too many entries");
        }
        if !(state.m.is_empty() || all_fitted && lengths(&[state.m.len()])) {
            return wrong("the number of matrices");
        }
        if state.channels.as_ref().is_some_and(|(n, f)| state.m.is_empty() || !lengths(&[n.len(), f.len()])) {
            return wrong("the number of magnitudes");
        }
        let measured = |e: &Measured| lengths(&[e.tv.len(), e.leak.len(), e.condition.len()]);
        if state.errors.as_ref().is_some_and(|e| state.channels.is_none() || !measured(e)) {
            return wrong("the number of statistics");
        }
        if state.evaluated.len() > evaluations(plan, &state) {
            return wrong("the number of evaluations");
        }
        let mut run = Self { plan, state, refinement: None };
        if let Some(joint) = run.state.joint.take() {
            let mut refinement = run.refinement_from_entries();
            if !(all_fitted && run.state.m.is_empty() && refinement.resume(&joint)) {
                return wrong("the joint refinement");
            }
            run.refinement = Some(refinement);
        }
        Ok(run)
    }

    /// What the fit knows now.
    pub fn state(&self) -> FitState {
        let joint = self.refinement.as_ref().map(Refinement::state);
        FitState { joint, ..self.state.clone() }
    }

    /// Does the next piece: some entries, one joint step, or some evaluations of the later stages. `false` when nothing is left.
    ///
    /// # Errors
    /// [`FitError::Stopped`] when the observer says so; the state is then that of before the piece, or after it where the
    /// piece was complete.
    pub fn advance(&mut self, observer: Observer<'_>) -> Result<bool, FitError> {
        let Some(stage) = self.stage() else { return Ok(false) };
        let start = Instant::now();
        let result = match stage {
            ENTRIES => self.fit_entries(observer),
            JOINT => self.refine(observer),
            CHANNELS => self.fit_channels(observer),
            _ => self.measure(observer),
        };
        self.add_time(stage, start.elapsed().as_secs_f64());
        result.map(|()| self.stage().is_some())
    }

    /// The stage of the next piece; `None` when nothing is left.
    pub fn stage(&self) -> Option<&'static str> {
        if self.state.entries.len() < self.plan.owners().len() {
            Some(ENTRIES)
        } else if self.state.m.is_empty() {
            Some(JOINT)
        } else if self.state.channels.is_none() {
            Some(CHANNELS)
        } else if self.state.errors.is_none() {
            Some(MEASUREMENT)
        } else {
            None
        }
    }

    /// The finished table.
    ///
    /// # Errors
    /// [`FitError::State`] while pieces are left; [`FitError::Table`], which no finished fit gives.
    pub fn finish(self) -> Result<Fitted, FitError> {
        let FitState {
            entries, m, channels: Some((magnitude, fresnel)), errors: Some(measured), times, ..
        } = self.state
        else {
            return Err(FitError::State { what: "pieces are left to do" });
        };
        let m = m.iter().map(DMat3::from_cols_array).collect();
        let Measured { tv, leak, condition, errors } = measured;
        let cells = CellStats { tv, leak, condition };
        let spec = self.plan.spec();
        let table = Table::new(spec.axes.clone(), m, magnitude, fresnel, cells)?
            .with_closed_form(spec.channels.closed_form)?;
        Ok(Fitted { table, errors, entries, times })
    }

    fn fit_entries(&mut self, observer: Observer<'_>) -> Result<(), FitError> {
        let (plan, done) = (self.plan, self.state.entries.len());
        let stage = plan.entry_stage()?;
        let sum: f64 = self.state.entries.iter().map(|entry| entry.tv).sum();
        let tv = (done > 0).then(|| sum / done as f64);
        let observer: Observer<'_> = &|progress| observer(Progress { tv, ..progress });
        let fitted = stage.fit(stage.piece(done), observer)?;
        self.state.entries.extend(fitted.into_iter().map(EntryRecord::from));
        Ok(())
    }

    fn refine(&mut self, observer: Observer<'_>) -> Result<(), FitError> {
        let mut refinement = match self.refinement.take() {
            Some(refinement) => refinement,
            None => self.refinement_from_entries(),
        };
        if refinement.is_done() {
            self.state.m = refinement.finish().iter().map(DMat3::to_cols_array).collect();
            return Ok(());
        }
        let progress = refinement.step();
        self.refinement = Some(refinement);
        if observer(progress?) { Ok(()) } else { Err(FitError::Stopped) }
    }

    fn refinement_from_entries(&self) -> Refinement<'a> {
        let plan = self.plan;
        let (axes, lattice) = (&plan.spec().axes, plan.lattice());
        let fitted = self.state.entries.iter().map(|entry| DMat3::from_cols_array(&entry.m));
        let start = entries::assemble(axes, lattice, plan.owners(), fitted);
        Refinement::new(plan.brdf(), axes, lattice, start, plan.spec().joint)
    }

    fn fit_channels(&mut self, observer: Observer<'_>) -> Result<(), FitError> {
        let (plan, spec) = (self.plan, self.plan.spec());
        let stage = ChannelStage::new(plan.brdf(), &spec.axes, plan.lattice(), spec.channels)?;
        let (items, total) = (&mut self.state.evaluated, stage.len());
        pieces::next(items, total, spec.channels.samples, |lobe, i| stage.item(lobe, i))?;
        let done = items.len();
        if done == total {
            self.state.channels = Some(stage.finish(items)?);
            items.clear();
        }
        report(observer, Progress { stage: CHANNELS, done, total, tv: None })
    }

    fn measure(&mut self, observer: Observer<'_>) -> Result<(), FitError> {
        let (brdf, spec) = (self.plan.brdf(), self.plan.spec());
        let (magnitude, fresnel) = self.state.channels.clone().unwrap_or_default();
        let m = self.state.m.iter().map(DMat3::from_cols_array).collect();
        let bare = Table::new(spec.axes.clone(), m, magnitude, fresnel, CellStats::default())?
            .with_closed_form(spec.channels.closed_form)?;
        let stage = Measurement::new(brdf, &bare, &spec.floors, spec.measure)?;
        let (items, total) = (&mut self.state.evaluated, stage.len());
        pieces::next(items, total, spec.measure.samples, |lobe, i| stage.item(lobe, i))?;
        let done = items.len();
        if done == total {
            self.state.errors = Some(stage.finish(items));
            items.clear();
        }
        report(observer, Progress { stage: MEASUREMENT, done, total, tv: None })
    }

    fn add_time(&mut self, stage: &str, seconds: f64) {
        match self.state.times.iter_mut().find(|time| time.stage == stage) {
            Some(time) => time.seconds += seconds,
            None => self.state.times.push(StageTime { stage: stage.to_owned(), seconds }),
        }
    }
}

/// Evaluations that a state may hold, by the stage that it is in.
fn evaluations(plan: &Plan<'_>, state: &FitState) -> usize {
    let (spec, nodes) = (plan.spec(), plan.lattice().nodes.len());
    match (&state.channels, &state.errors) {
        (None, None) if !state.m.is_empty() => nodes + spec.channels.all_queries(),
        (Some(_), None) => 2 * nodes + 2 * spec.measure.queries + grid_errors::cells(&spec.axes),
        _ => 0,
    }
}

fn report(observer: Observer<'_>, progress: Progress) -> Result<(), FitError> {
    if observer(progress) { Ok(()) } else { Err(FitError::Stopped) }
}
