//! Every entry of a table fitted by itself.

use core::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DMat3;
use ltc_table::Axis;
use rayon::prelude::*;

use crate::{
    Brdf, DiskPoints, EntryFit, FitError, Lattice, Lobe, Observer, Progress, fit_entry, gauge,
    progress::ENTRIES,
};

/// Settings of [`fit_entries`].
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EntrySettings {
    /// Samples of each lobe.
    pub samples: usize,
    /// Most quasi-Newton iterations of each entry.
    pub iterations: usize,
}

/// Fits each entry that owns itself and lets the others follow. Entries are independent of each other, so the result
/// does not depend on the number of threads.
///
/// # Errors
/// [`FitError::Stopped`] when the observer says so.
pub fn fit_entries(
    brdf: &dyn Brdf,
    axes: &[Axis],
    lattice: &Lattice,
    settings: EntrySettings,
    observer: Observer<'_>,
) -> Result<Vec<DMat3>, FitError> {
    let owners = lattice.owners();
    let fitted = fit_owners(brdf, lattice, &owners, 0..owners.len(), settings, observer)?;
    Ok(assemble(axes, lattice, &owners, fitted.iter().map(|fit| fit.m)))
}

/// Fits some of the owners, each by itself.
///
/// # Errors
/// [`FitError::Stopped`] when the observer says so.
pub fn fit_owners(
    brdf: &dyn Brdf,
    lattice: &Lattice,
    owners: &[usize],
    which: Range<usize>,
    settings: EntrySettings,
    observer: Observer<'_>,
) -> Result<Vec<EntryFit>, FitError> {
    let points = DiskPoints::new(settings.samples, [0.5, 0.5]);
    let done = AtomicUsize::new(which.start);
    owners[which]
        .par_iter()
        .map_init(Lobe::default, |lobe, &index| {
            let node = &lattice.nodes[index];
            brdf.sample_lobe(node.wo(), node.widths()?, &points, lobe);
            let fit = fit_entry(lobe, node.wo(), lattice.ties[index].pattern, settings.iterations);
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            let report = Progress { stage: ENTRIES, done, total: owners.len(), tv: None };
            if observer(report) { Ok(fit) } else { Err(FitError::Stopped) }
        })
        .collect()
}

/// The table of these owners, the others following, turned to lie smoothly beside each other.
pub fn assemble(
    axes: &[Axis],
    lattice: &Lattice,
    owners: &[usize],
    fitted: impl Iterator<Item = DMat3>,
) -> Vec<DMat3> {
    let mut m = vec![DMat3::IDENTITY; lattice.nodes.len()];
    for (index, fitted) in owners.iter().zip(fitted) {
        m[*index] = fitted;
    }
    lattice.follow(&mut m);
    gauge::smooth(axes, lattice, &mut m);
    m
}
