//! The warm-start path of the blog on fitting: each entry of an isotropic table starts where its neighbour ended.

use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DVec3;
use rayon::prelude::*;

use crate::{
    DiskPoints, EntryFit, FitError, Lobe, Objective, Observer, Pattern, Point, Progress,
    bfgs::Minimum,
    entries::EntryStage,
    form::{Form, mean_direction},
    gauge, nelder_mead,
    objective::total_variation,
    progress::ENTRIES,
};

/// Edge of the first simplex, in units of the parameters.
const SIMPLEX: f64 = 0.05;

/// Fits the entries of a table over θ and α in a restricted form by Nelder and Mead's simplex.
///
/// As the blog has it: along normal incidence from the roughest entry, which starts at the identity, to the smoothest;
/// then from each of these, at constant roughness, towards grazing. At normal incidence the lobe is round, and one width
/// is all that is fitted. The columns are independent of each other, so the result does not depend on the number of
/// threads.
///
/// # Errors
/// [`FitError::Stopped`] when the observer says so.
pub fn fit_along_path(
    stage: &EntryStage<'_>,
    form: Form,
    observer: Observer<'_>,
) -> Result<Vec<EntryFit>, FitError> {
    let total = stage.lattice.nodes.len();
    let widths = stage.axes.last().map_or(1, |axis| axis.len);
    let done = AtomicUsize::new(0);
    let points = DiskPoints::new(stage.settings.samples, [0.5, 0.5]);
    let fit = |lobe: &mut Lobe, index: usize, start: &Point| {
        let node = &stage.lattice.nodes[index];
        let pattern = stage.lattice.ties[index].pattern;
        stage.brdf.sample_lobe(node.wo(), node.widths()?, &points, lobe);
        let fitted = fit_form(lobe, stage.objective, form, pattern, start, stage.settings.iterations);
        let done = done.fetch_add(1, Ordering::Relaxed) + 1;
        let report = Progress { stage: ENTRIES, done, total, tv: None };
        if observer(report) { Ok(fitted) } else { Err(FitError::Stopped) }
    };

    let mut first = Vec::with_capacity(widths);
    let mut start = form.identity();
    let mut lobe = Lobe::default();
    for column in (0..widths).rev() {
        let fitted = fit(&mut lobe, column, &start)?;
        start = fitted.0;
        first.push(fitted);
    }
    first.reverse();
    let columns: Result<Vec<Vec<EntryFit>>, FitError> = first
        .into_par_iter()
        .enumerate()
        .map_init(Lobe::default, |lobe, (column, (mut start, at_normal))| {
            let mut fitted = vec![at_normal];
            for index in (column + widths..total).step_by(widths) {
                let (end, entry) = fit(lobe, index, &start)?;
                start = end;
                fitted.push(entry);
            }
            Ok(fitted)
        })
        .collect();
    let columns = columns?;
    Ok((0..total).map(|index| columns[index % widths][index / widths]).collect())
}

/// Lowers the objective in a restricted form, for a lobe seen from φ = 0: the parameters, and the fit. A lobe of
/// [`Pattern::Round`] keeps equal widths and no shear.
pub fn fit_form(
    lobe: &Lobe,
    objective: Objective,
    form: Form,
    pattern: Pattern,
    start: &Point,
    max_iterations: usize,
) -> (Point, EntryFit) {
    let goal = objective.towards(lobe);
    let round = pattern == Pattern::Round;
    let mean = if round { DVec3::Z } else { mean_direction(lobe) };
    let parameters = |p: &Point| if round { form.round(p[0]) } else { *p };
    let dimension = if round { 1 } else { form.dimension() };
    let mut evaluations = 0;
    let value = |p: &Point| {
        evaluations += 1;
        goal.value(form.matrix(&parameters(p), mean)) / goal.unit()
    };
    let Minimum { point, value, iterations, stop } =
        nelder_mead::minimise(value, start, dimension, SIMPLEX, max_iterations);
    let point = parameters(&point);
    let m = gauge::signed(gauge::scaled(gauge::right_handed(form.matrix(&point, mean))), pattern);
    let tv = total_variation(lobe, m);
    (point, EntryFit { m, tv, value: value * goal.unit(), iterations, evaluations, stop })
}
