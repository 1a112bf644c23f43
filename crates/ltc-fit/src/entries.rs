//! Every entry of a table fitted by itself.

use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DMat3;
use ltc_table::Axis;
use rayon::prelude::*;

use crate::{Brdf, DiskPoints, EntryFit, FitError, Lattice, Lobe, Observer, Progress, fit_entry, gauge};

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
    let points = DiskPoints::new(settings.samples, [0.5, 0.5]);
    let owners = lattice.owners();
    let done = AtomicUsize::new(0);
    let fitted: Result<Vec<DMat3>, FitError> = owners
        .par_iter()
        .map_init(Lobe::default, |lobe, &index| {
            let node = &lattice.nodes[index];
            brdf.sample_lobe(node.wo(), node.widths()?, &points, lobe);
            let EntryFit { m, .. } =
                fit_entry(lobe, node.wo(), lattice.ties[index].pattern, settings.iterations);
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            let report = Progress { stage: "entries", done, total: owners.len(), tv: None };
            if observer(report) { Ok(m) } else { Err(FitError::Stopped) }
        })
        .collect();
    let mut m = vec![DMat3::IDENTITY; lattice.nodes.len()];
    for (index, fitted) in owners.iter().zip(fitted?) {
        m[*index] = fitted;
    }
    lattice.follow(&mut m);
    gauge::smooth(axes, lattice, &mut m);
    gauge::scale(axes, lattice, &mut m);
    Ok(m)
}
