//! Stages that evaluate many lobes, each for itself: a piece of them at a time.

use rayon::prelude::*;

use crate::{FitError, Lobe};

/// What one evaluation gives; what is not needed is 0.
pub(crate) type Item = [f64; 3];

/// Samples of lobes in a piece: about a tenth of a second of one core.
const SAMPLES: usize = 2_000_000;

/// Evaluations in a piece, when each takes so many samples.
pub(crate) fn length(samples: usize) -> usize {
    (SAMPLES / samples.max(1)).max(1)
}

/// Does the next piece: appends its evaluations to those that are done. Each depends on its number alone, so that the result
/// is the same however the stage was cut.
pub(crate) fn next(
    items: &mut Vec<Item>,
    total: usize,
    samples: usize,
    item: impl Fn(&mut Lobe, usize) -> Result<Item, FitError> + Sync,
) -> Result<(), FitError> {
    let done = items.len();
    let piece = done..total.min(done + length(samples));
    let more: Result<Vec<Item>, FitError> =
        piece.into_par_iter().map_init(Lobe::default, |lobe, i| item(lobe, i)).collect();
    items.extend(more?);
    Ok(())
}

/// Everything in one go.
pub(crate) fn all(
    total: usize,
    item: impl Fn(&mut Lobe, usize) -> Result<Item, FitError> + Sync,
) -> Result<Vec<Item>, FitError> {
    (0..total).into_par_iter().map_init(Lobe::default, |lobe, i| item(lobe, i)).collect()
}
