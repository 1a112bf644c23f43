//! The warm-start path of the blog on fitting: each entry of an isotropic table starts where its neighbour ended.

use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DMat3;
use ltc_table::Axis;
use rayon::prelude::*;

use crate::{
    Brdf, DiskPoints, FitError, Lattice, Lobe, Objective, Observer, Pattern, Progress,
    bfgs::{Minimum, Point},
    entries::EntrySettings,
    form::{Form, mean_direction},
    gauge, nelder_mead,
};

/// Edge of the first simplex, in units of the parameters.
const SIMPLEX: f64 = 0.05;

/// Fits the entries of a table over θ and α in a restricted form by Nelder and Mead's simplex.
///
/// As the blog has it: along normal incidence from the roughest entry, which starts at the identity, to the smoothest; then from each of
/// these, at constant roughness, towards grazing. At normal incidence the lobe is round, and one width is all that is
/// fitted. The columns are independent of each other, so the result does not depend on the number of threads.
///
/// # Errors
/// [`FitError::Stopped`] when the observer says so.
pub fn fit_along_path(
    brdf: &dyn Brdf,
    axes: &[Axis],
    lattice: &Lattice,
    objective: Objective,
    form: Form,
    settings: EntrySettings,
    observer: Observer<'_>,
) -> Result<Vec<DMat3>, FitError> {
    let total = lattice.nodes.len();
    let widths = axes.last().map_or(1, |axis| axis.len);
    let done = AtomicUsize::new(0);
    let walk = Walk {
        brdf,
        lattice,
        points: DiskPoints::new(settings.samples, [0.5, 0.5]),
        objective,
        form,
        settings,
    };
    let fit = |lobe: &mut Lobe, index: usize, start: &Point| {
        let fitted = walk.fit(lobe, index, start)?;
        let done = done.fetch_add(1, Ordering::Relaxed) + 1;
        let report = Progress { stage: "entries", done, total, tv: None };
        if observer(report) { Ok(fitted) } else { Err(FitError::Stopped) }
    };

    let mut first = vec![(Point::default(), DMat3::IDENTITY); widths];
    let mut start = form.identity();
    let mut lobe = Lobe::default();
    for column in (0..widths).rev() {
        first[column] = fit(&mut lobe, column, &start)?;
        start = first[column].0;
    }
    let columns: Result<Vec<Vec<DMat3>>, FitError> = first
        .into_par_iter()
        .enumerate()
        .map_init(Lobe::default, |lobe, (column, (mut start, m))| {
            let mut fitted = vec![m];
            for index in (column + widths..total).step_by(widths) {
                let (next, m) = fit(lobe, index, &start)?;
                start = next;
                fitted.push(m);
            }
            Ok(fitted)
        })
        .collect();
    let columns = columns?;
    Ok((0..total).map(|index| columns[index % widths][index / widths]).collect())
}

/// What all entries of the path share.
struct Walk<'a> {
    brdf: &'a dyn Brdf,
    lattice: &'a Lattice,
    points: DiskPoints,
    objective: Objective,
    form: Form,
    settings: EntrySettings,
}

impl Walk<'_> {
    /// The parameters of an entry, and its matrix with the last column of unit length.
    fn fit(&self, lobe: &mut Lobe, index: usize, start: &Point) -> Result<(Point, DMat3), FitError> {
        let node = &self.lattice.nodes[index];
        let pattern = self.lattice.ties[index].pattern;
        self.brdf.sample_lobe(node.wo(), node.widths()?, &self.points, lobe);
        let minimum = fit_form(lobe, self.objective, self.form, pattern, start, self.settings.iterations);
        let m = self.form.matrix(&minimum.point, mean_of(lobe, pattern));
        Ok((minimum.point, gauge::scaled(gauge::right_handed(m))))
    }
}

/// Lowers the objective in a restricted form, for a lobe seen from φ = 0. A lobe of [`Pattern::Round`] keeps equal widths
/// and no shear.
pub fn fit_form(
    lobe: &Lobe,
    objective: Objective,
    form: Form,
    pattern: Pattern,
    start: &Point,
    max_iterations: usize,
) -> Minimum {
    let goal = objective.towards(lobe);
    let mean = mean_of(lobe, pattern);
    if pattern == Pattern::Round {
        let value = |p: &Point| goal.value(form.matrix(&form.round(p[0]), mean)) / goal.unit();
        let minimum = nelder_mead::minimise(value, start, 1, SIMPLEX, max_iterations);
        return Minimum {
            point: form.round(minimum.point[0]),
            value: minimum.value * goal.unit(),
            ..minimum
        };
    }
    let value = |p: &Point| goal.value(form.matrix(p, mean)) / goal.unit();
    let minimum = nelder_mead::minimise(value, start, form.dimension(), SIMPLEX, max_iterations);
    Minimum { value: minimum.value * goal.unit(), ..minimum }
}

fn mean_of(lobe: &Lobe, pattern: Pattern) -> glam::DVec3 {
    if pattern == Pattern::Round { glam::DVec3::Z } else { mean_direction(lobe) }
}
