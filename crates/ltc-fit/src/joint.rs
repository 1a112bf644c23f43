//! The table as the unknown: all entries refined together, over queries between them.

use glam::DMat3;
use ltc_core::{Ltc, points::SplitMix64};
use ltc_table::{
    Axis, Folded, Precision, Query,
    lookup::{Corner, corners},
};
use rayon::prelude::*;

use crate::{
    Brdf, DiskPoints, FitError, Lattice, Layout, Lobe, Observer, Progress, draw, progress::JOINT, regular,
    total_variation_gradient,
};

/// Settings of [`refine`].
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointSettings {
    /// Steps of stochastic gradient descent; 0 leaves the entries as they were fitted alone.
    pub steps: usize,
    /// Random queries in each step.
    pub queries: usize,
    /// Samples of the lobe at each query.
    pub samples: usize,
    /// Length of the first steps, relative to each lobe's width; falls to zero along a cosine.
    pub learning_rate: f64,
    /// Seed of the queries.
    pub seed: u64,
    /// What is interpolated between entries.
    #[serde(default, skip_serializing_if = "Layout::is_matrix")]
    pub layout: Layout,
}

/// A query's place in the table and how its lookup depends on the entries.
struct Place {
    query: Folded,
    corners: Vec<Corner>,
}

/// Minimises the mean total variation over random queries, `E TV(p, interpolated M)`, by Adam in the coordinates
/// `M = M₀ (exp(diag Δ) + offdiag Δ)` of every entry that owns itself, `M₀` its start. Patterns and ties hold exactly at
/// every step, and det M stays above 0.
///
/// Sums are taken in the order of the queries, so that the result does not depend on the number of threads.
///
/// # Errors
/// [`FitError::Stopped`] when the observer says so.
pub fn refine(
    brdf: &dyn Brdf,
    axes: &[Axis],
    lattice: &Lattice,
    start: &[DMat3],
    settings: JointSettings,
    observer: Observer<'_>,
) -> Result<Vec<DMat3>, FitError> {
    let mut refinement = Refinement::new(brdf, axes, lattice, start.to_vec(), settings);
    while !refinement.is_done() {
        if !observer(refinement.step()?) {
            return Err(FitError::Stopped);
        }
    }
    Ok(refinement.finish())
}

/// What a [`Refinement`] knows between two steps: with it and the start, it goes on as if it had never stopped.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointState {
    /// Steps done.
    pub steps: usize,
    /// Seed of the queries still to come.
    pub seed: u64,
    /// `Δ` of each entry that owns itself, column-major.
    pub delta: Vec<[f64; 9]>,
    /// Adam's mean of its gradients.
    pub mean: Vec<[f64; 9]>,
    /// Adam's mean of their squares.
    pub square: Vec<[f64; 9]>,
    /// The running mean of the total variation, and its weight.
    pub average: [f64; 2],
}

/// [`refine`], step by step.
pub struct Refinement<'a> {
    brdf: &'a dyn Brdf,
    axes: &'a [Axis],
    settings: JointSettings,
    unknowns: Unknowns<'a>,
    rng: SplitMix64,
    average: RunningMean,
    steps: usize,
}

impl<'a> Refinement<'a> {
    /// Before the first step.
    pub fn new(
        brdf: &'a dyn Brdf,
        axes: &'a [Axis],
        lattice: &'a Lattice,
        start: Vec<DMat3>,
        settings: JointSettings,
    ) -> Self {
        let (unknowns, rng) = (Unknowns::new(lattice, start), SplitMix64::new(settings.seed));
        Self { brdf, axes, settings, unknowns, rng, average: RunningMean::default(), steps: 0 }
    }

    /// What it knows.
    pub fn state(&self) -> JointState {
        let Unknowns { delta, mean, square, .. } = &self.unknowns;
        let [delta, mean, square] = [delta, mean, square].map(Clone::clone);
        let average = [self.average.value, self.average.weight];
        JointState { steps: self.steps, seed: self.rng.seed(), delta, mean, square, average }
    }

    /// Goes on from a state of a refinement with the same start and settings; `false`, and nothing happens, when it is
    /// of another lattice.
    pub fn resume(&mut self, state: &JointState) -> bool {
        let owners = self.unknowns.owners.len();
        let fits = [&state.delta, &state.mean, &state.square].iter().all(|values| values.len() == owners);
        if !fits || state.steps > self.settings.steps {
            return false;
        }
        self.unknowns.delta.clone_from(&state.delta);
        self.unknowns.mean.clone_from(&state.mean);
        self.unknowns.square.clone_from(&state.square);
        self.unknowns.steps = state.steps as i32;
        self.rng = SplitMix64::new(state.seed);
        self.average = RunningMean { value: state.average[0], weight: state.average[1] };
        self.steps = state.steps;
        true
    }

    /// Whether no step is left.
    pub fn is_done(&self) -> bool {
        self.steps >= self.settings.steps
    }

    /// Takes one step.
    ///
    /// # Errors
    /// None for valid axes and settings.
    pub fn step(&mut self) -> Result<Progress, FitError> {
        let Self { brdf, axes, settings, unknowns, rng, average, steps } = self;
        let isotropic = axes.len() == 2;
        let queries = draw::training(rng, settings.queries, isotropic);
        let points = DiskPoints::new(settings.samples, [rng.unit(), rng.unit()]);
        let m = unknowns.matrices();
        let layout = settings.layout;
        let stored: Vec<DMat3> = m.iter().map(|m| layout.stored(*m)).collect();
        let gradients: Result<Vec<_>, FitError> = queries
            .par_iter()
            .with_min_len(16)
            .map_init(Lobe::default, |lobe, query| {
                query_gradient(*brdf, axes, layout, &stored, query, &points, lobe)
            })
            .collect();
        let mut by_entry = vec![DMat3::ZERO; m.len()];
        for (place, value, gradient) in gradients? {
            average.add(value);
            for corner in &place.corners {
                by_entry[corner.index] += gradient * (corner.weight / settings.queries as f64);
            }
        }
        for (m, gradient) in m.iter().zip(&mut by_entry) {
            *gradient = layout.by_matrix(*m, *gradient);
        }
        if layout.is_matrix() {
            regular::push_apart(axes, &m, rng.bits(), 1.0 / settings.queries as f64, &mut by_entry);
        }
        let progress = *steps as f64 / settings.steps as f64;
        let rate = settings.learning_rate * 0.5 * (1.0 + (core::f64::consts::PI * progress).cos());
        unknowns.step(&by_entry, rate);
        *steps += 1;
        let tv = Some(average.value());
        Ok(Progress { stage: JOINT, done: *steps, total: settings.steps, tv })
    }

    /// The refined matrices.
    pub fn finish(mut self) -> Vec<DMat3> {
        self.unknowns.keep_exportable(self.settings.layout);
        self.unknowns.matrices()
    }
}

fn query_gradient(
    brdf: &dyn Brdf,
    axes: &[Axis],
    layout: Layout,
    stored: &[DMat3],
    query: &Query,
    points: &DiskPoints,
    lobe: &mut Lobe,
) -> Result<(Place, f64, DMat3), FitError> {
    let place = locate(axes, query)?;
    let interpolated = layout.matrix(interpolate(stored, &place.corners));
    let folded = &place.query;
    let alpha = ltc_core::Alpha::new(folded.alpha, folded.alpha * folded.lambda)?;
    brdf.sample_lobe(crate::direction(folded.theta, folded.phi), alpha, points, lobe);
    let (value, gradient) = total_variation_gradient(lobe, interpolated);
    // A matrix of the wrong handedness may have a good lobe, but leads away from where all others are.
    let usable = interpolated.determinant() > 0.0 && gradient.is_finite();
    let gradient = if usable { gradient } else { regular::volume_gradient(interpolated) * -1.0 };
    Ok((place, value, layout.by_stored(interpolated, gradient)))
}

pub(crate) fn interpolate(m: &[DMat3], corners: &[Corner]) -> DMat3 {
    corners.iter().fold(DMat3::ZERO, |sum, corner| sum + m[corner.index] * corner.weight)
}

fn locate(axes: &[Axis], query: &Query) -> Result<Place, FitError> {
    let mut folded = query.fold()?;
    if axes.len() == 2 {
        // An isotropic table holds the lobe of φ = 0 and turns it.
        folded.phi = 0.0;
    }
    Ok(Place { query: folded, corners: query_corners(axes, &folded) })
}

/// The entries around a query, and their weights in its lookup.
pub(crate) fn query_corners(axes: &[Axis], query: &Folded) -> Vec<Corner> {
    let Folded { theta, phi, alpha, lambda, .. } = *query;
    if axes.len() == 2 {
        corners(axes, [theta, alpha]).collect()
    } else {
        corners(axes, [theta, phi, alpha, lambda]).collect()
    }
}

/// The owners' `Δ` and what Adam remembers of them.
struct Unknowns<'a> {
    lattice: &'a Lattice,
    owners: Vec<usize>,
    start: Vec<DMat3>,
    delta: Vec<[f64; 9]>,
    mean: Vec<[f64; 9]>,
    square: Vec<[f64; 9]>,
    steps: i32,
}

impl<'a> Unknowns<'a> {
    fn new(lattice: &'a Lattice, start: Vec<DMat3>) -> Self {
        let owners = lattice.owners();
        let zero = vec![[0.0; 9]; owners.len()];
        Self { lattice, owners, start, delta: zero.clone(), mean: zero.clone(), square: zero, steps: 0 }
    }

    fn matrices(&self) -> Vec<DMat3> {
        let mut m = vec![DMat3::IDENTITY; self.start.len()];
        for (delta, &index) in self.delta.iter().zip(&self.owners) {
            m[index] = self.start[index] * factor(delta);
        }
        self.lattice.follow(&mut m);
        m
    }

    /// Takes entries back towards their start until they keep det M > 0 as half floats: the thinnest lobes' columns are so
    /// nearly parallel that rounding can turn them over.
    fn keep_exportable(&mut self, layout: Layout) {
        const MOST_STEPS: usize = 60;
        let followers = |owner: usize| self.lattice.ties.iter().filter(move |tie| tie.owner == owner);
        for (k, &index) in self.owners.iter().enumerate() {
            for _ in 0..MOST_STEPS {
                let m = self.start[index] * factor(&self.delta[k]);
                let survives = |m: DMat3| survives_half(m) && survives_half(layout.stored(m));
                if followers(index).all(|tie| survives(tie.follow(m))) {
                    break;
                }
                self.delta[k] = self.delta[k].map(|d| 0.93 * d);
            }
        }
    }

    /// Adam (Kingma & Ba 2015) on the owners, each gathering the gradients of those that follow it.
    fn step(&mut self, by_entry: &[DMat3], rate: f64) {
        const DECAY_MEAN: f64 = 0.9;
        const DECAY_SQUARE: f64 = 0.999;
        let mut gathered = vec![DMat3::ZERO; by_entry.len()];
        for (tie, gradient) in self.lattice.ties.iter().zip(by_entry) {
            gathered[tie.owner] += tie.pull_back(*gradient);
        }
        self.steps += 1;
        let (correct_mean, correct_square) =
            (1.0 - DECAY_MEAN.powi(self.steps), 1.0 - DECAY_SQUARE.powi(self.steps));
        for (k, &index) in self.owners.iter().enumerate() {
            let by_delta = self.start[index].transpose() * gathered[index];
            let gradient = self.lattice.ties[index].pattern.project(by_delta).to_cols_array();
            for (i, g) in gradient.into_iter().enumerate() {
                let g = if on_diagonal(i) { g * self.delta[k][i].exp() } else { g };
                let (mean, square) = (&mut self.mean[k][i], &mut self.square[k][i]);
                *mean = DECAY_MEAN * *mean + (1.0 - DECAY_MEAN) * g;
                *square = DECAY_SQUARE * *square + (1.0 - DECAY_SQUARE) * g * g;
                self.delta[k][i] -=
                    rate * (*mean / correct_mean) / ((*square / correct_square).sqrt() + 1e-8);
            }
            keep_regular(&mut self.delta[k]);
        }
    }
}

fn survives_half(m: DMat3) -> bool {
    let rounded = m.to_cols_array().map(|x| Precision::F16.round(x));
    Ltc::<f64>::new(DMat3::from_cols_array(&rounded)).is_ok()
}

/// Whether entry `i` of a column-major 3×3 matrix lies on its diagonal.
fn on_diagonal(i: usize) -> bool {
    i.is_multiple_of(4)
}

/// `exp(diag Δ) + offdiag Δ`: scales stay positive however far they are pushed.
fn factor(delta: &[f64; 9]) -> DMat3 {
    DMat3::from_cols_array(&core::array::from_fn(|i| if on_diagonal(i) { delta[i].exp() } else { delta[i] }))
}

/// Farthest that a logarithmic scale may go from its start.
const MAX_LOG_SCALE: f64 = 3.0;
/// Smallest determinant of [`factor`], relative to the product of its diagonal.
const MIN_DETERMINANT: f64 = 0.1;

/// Brings `Δ` back to where [`factor`] has a determinant well above 0.
fn keep_regular(delta: &mut [f64; 9]) {
    for i in [0, 4, 8] {
        delta[i] = delta[i].clamp(-MAX_LOG_SCALE, MAX_LOG_SCALE);
    }
    let product = (delta[0] + delta[4] + delta[8]).exp();
    while factor(delta).determinant() < MIN_DETERMINANT * product {
        for (i, d) in delta.iter_mut().enumerate() {
            if !on_diagonal(i) {
                *d *= 0.9;
            }
        }
    }
}

/// An exponential mean of the last few thousand values.
#[derive(Default)]
struct RunningMean {
    value: f64,
    weight: f64,
}

impl RunningMean {
    fn add(&mut self, value: f64) {
        const KEEP: f64 = 1.0 - 1.0 / 20_000.0;
        self.value = KEEP * self.value + (1.0 - KEEP) * value;
        self.weight = KEEP * self.weight + (1.0 - KEEP);
    }

    fn value(&self) -> f64 {
        self.value / self.weight.max(f64::MIN_POSITIVE)
    }
}
