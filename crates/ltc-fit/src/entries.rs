//! Every entry of a table fitted by itself.

use core::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DMat3;
use ltc_table::Axis;
use rayon::prelude::*;

use crate::{
    Brdf, DiskPoints, EntryFit, FitError, Lattice, Lobe, Objective, Observer, Optimiser, Pattern, Progress,
    gauge, median_start, path, progress::ENTRIES, refine_by, refine_by_simplex,
};

/// Settings of [`fit_entries`].
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EntrySettings {
    /// Samples of each lobe.
    pub samples: usize,
    /// Most iterations of each entry.
    pub iterations: usize,
    /// The method; `quasi_newton` unless said otherwise.
    #[serde(default, skip_serializing_if = "Optimiser::is_default")]
    pub optimiser: Optimiser,
    /// Whether each entry is fitted again from where its neighbours ended, and the lowest kept. It takes nine times as
    /// long and helps few entries; see [`EntryStage`].
    #[serde(default, skip_serializing_if = "core::ops::Not::not")]
    pub continuation: bool,
}

impl EntrySettings {
    /// By the default method, from the medians alone.
    pub fn new(samples: usize, iterations: usize) -> Self {
        Self { samples, iterations, optimiser: Optimiser::default(), continuation: false }
    }
}

/// Fits each entry that owns itself and lets the others follow. The result does not depend on the number of threads.
///
/// # Errors
/// [`FitError::Stopped`] when the observer says so.
pub fn fit_entries(
    brdf: &dyn Brdf,
    axes: &[Axis],
    lattice: &Lattice,
    objective: Objective,
    settings: EntrySettings,
    observer: Observer<'_>,
) -> Result<Vec<DMat3>, FitError> {
    let owners = lattice.owners();
    let stage = EntryStage { brdf, axes, lattice, owners: &owners, objective, settings };
    let fitted = stage.fit(0..owners.len(), observer)?;
    Ok(assemble(axes, lattice, &owners, fitted.iter().map(|fit| fit.m)))
}

/// The table of these owners, the others following, turned to lie smoothly beside each other.
pub fn assemble(
    axes: &[Axis],
    lattice: &Lattice,
    owners: &[usize],
    fitted: impl Iterator<Item = DMat3>,
) -> Vec<DMat3> {
    let mut m = unsmoothed(lattice, owners, fitted);
    gauge::smooth(axes, lattice, &mut m);
    gauge::scale(axes, lattice, &mut m);
    m
}

fn unsmoothed(lattice: &Lattice, owners: &[usize], fitted: impl Iterator<Item = DMat3>) -> Vec<DMat3> {
    let mut m = vec![DMat3::IDENTITY; lattice.nodes.len()];
    for (index, fitted) in owners.iter().zip(fitted) {
        m[*index] = fitted;
    }
    lattice.follow(&mut m);
    m
}

/// The first stage of a fit, which can be done in pieces.
///
/// The medians of the lobe are start enough: with continuation, 129 of the 3,256 entries of the `ggx-anisotropic` preset end
/// more than 1e-3 lower in total variation, 5 more than 1e-2 (θ > 77°, λ = 0.03), the mean 1.3e-4 lower, and 1.6e-5 over samples
/// that the fit did not see; so it is off unless asked for. It takes one more pass, which starts from where the entries on
/// either side along each axis ended in the first.
#[derive(Clone, Copy)]
pub struct EntryStage<'a> {
    /// The material.
    pub brdf: &'a dyn Brdf,
    /// The table's axes.
    pub axes: &'a [Axis],
    /// Its entries.
    pub lattice: &'a Lattice,
    /// Those that own themselves, in table order.
    pub owners: &'a [usize],
    /// What is lowered.
    pub objective: Objective,
    /// How.
    pub settings: EntrySettings,
}

/// Entries that are fitted in one piece: a second's work or less, and enough for many threads.
pub(crate) const PIECE: usize = 256;

impl EntrySettings {
    /// Whether entries start from each other, so that all are fitted in one piece.
    pub(crate) fn is_chained(&self) -> bool {
        self.continuation || self.optimiser.form().is_some()
    }
}

impl EntryStage<'_> {
    /// The owners to fit next when so many are done: a few hundred, or all that are left where entries start from each other.
    pub fn piece(&self, done: usize) -> Range<usize> {
        let count = self.owners.len();
        if self.is_chained() { done..count } else { done..(done + PIECE).min(count) }
    }

    /// Fits some of the owners. Where entries start from each other all are fitted, whichever are asked for.
    ///
    /// # Errors
    /// [`FitError::Stopped`] when the observer says so.
    pub fn fit(&self, which: Range<usize>, observer: Observer<'_>) -> Result<Vec<EntryFit>, FitError> {
        if !self.is_chained() {
            return self.alone(which, observer);
        }
        let all = match self.settings.optimiser.form() {
            Some(form) => path::fit_along_path(self, form, observer)?,
            None => self.continued(&self.alone(0..self.owners.len(), observer)?, observer)?,
        };
        Ok(all[which].to_vec())
    }

    fn is_chained(&self) -> bool {
        self.settings.is_chained()
    }

    fn alone(&self, which: Range<usize>, observer: Observer<'_>) -> Result<Vec<EntryFit>, FitError> {
        self.each(which, 0, observer, |lobe, _, index, pattern| {
            let start = median_start(lobe, self.lattice.nodes[index].wo(), pattern);
            self.refine(lobe, start, pattern)
        })
    }

    /// The lowest of each fit and those from its neighbours' ends.
    fn continued(&self, alone: &[EntryFit], observer: Observer<'_>) -> Result<Vec<EntryFit>, FitError> {
        let m = unsmoothed(self.lattice, self.owners, alone.iter().map(|fit| fit.m));
        self.each(0..self.owners.len(), self.owners.len(), observer, |lobe, position, index, pattern| {
            let starts = gauge::neighbours(self.axes, index).map(|n| pattern.project(m[n]));
            starts.filter(|start| start.determinant() > 0.0).fold(alone[position], |lowest, start| {
                let mut fit = self.refine(lobe, start, pattern);
                let evaluations = lowest.evaluations + fit.evaluations;
                fit = if fit.value < lowest.value { fit } else { lowest };
                EntryFit { evaluations, ..fit }
            })
        })
    }

    /// `fit(lobe, position, index, pattern)` for some of the owners, in any order of time; `before` were done in a pass before.
    fn each(
        &self,
        which: Range<usize>,
        before: usize,
        observer: Observer<'_>,
        fit: impl Fn(&Lobe, usize, usize, Pattern) -> EntryFit + Sync,
    ) -> Result<Vec<EntryFit>, FitError> {
        let points = DiskPoints::new(self.settings.samples, [0.5, 0.5]);
        let total = self.owners.len() * if self.settings.continuation { 2 } else { 1 };
        let done = AtomicUsize::new(before + which.start);
        let one = |lobe: &mut Lobe, position: usize| {
            let index = self.owners[position];
            let node = &self.lattice.nodes[index];
            self.brdf.sample_lobe(node.wo(), node.widths()?, &points, lobe);
            let fit = fit(lobe, position, index, self.lattice.ties[index].pattern);
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            let report = Progress { stage: ENTRIES, done, total, tv: None };
            if observer(report) { Ok(fit) } else { Err(FitError::Stopped) }
        };
        which.into_par_iter().map_init(Lobe::default, one).collect()
    }

    fn refine(&self, lobe: &Lobe, start: DMat3, pattern: Pattern) -> EntryFit {
        let refine = match self.settings.optimiser {
            Optimiser::NelderMead => refine_by_simplex,
            _ => refine_by,
        };
        refine(&self.objective.towards(lobe), start, pattern, self.settings.iterations)
    }
}
