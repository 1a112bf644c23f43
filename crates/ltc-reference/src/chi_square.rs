//! Pearson's χ² test: does a sampler draw from the density that it claims?

use glam::DVec3;

use crate::bins::{Bin, counted, pool};
use crate::chart::Chart;
use crate::error::ReferenceError;
use crate::points::SplitMix64;
use crate::special::incomplete_gamma;

/// How far from 1 the length of a sampled direction may be: samplers in f32 are tested, too.
const UNIT_TOLERANCE: f64 = 1e-5;
/// How a χ² test is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChiSquareOptions {
    /// Number of samples n. A density that is wrong by a relative δ, `d² = ∫ δ² pdf`, is seen where `n d²` exceeds some
    /// six times `√(2 bins)`: with the defaults at d = 4 %, with ten times the samples at 1.4 %.
    pub samples: u32,
    /// Bins along u and v of the chart.
    pub bins: [usize; 2],
    /// Seed of the pseudo-random points. They are independent of each other: χ² is not valid for low-discrepancy points.
    pub seed: u64,
    /// Bins are pooled until each expects at least this many samples.
    pub min_expected: f64,
    /// How far above 1 the density's integral may be. A larger one is no density: `p_value` is then 0.
    pub mass_tolerance: f64,
    /// How many samples may lie where the density is 0. For samplers in f32, whose edges are rounded.
    pub allowed_stray: u32,
}

impl Default for ChiSquareOptions {
    /// 100,000 samples in 16 × 32 bins of at least 5 expected samples; none may stray.
    fn default() -> Self {
        Self {
            samples: 100_000,
            bins: [16, 32],
            seed: 1,
            min_expected: 5.0,
            mass_tolerance: 1e-4,
            allowed_stray: 0,
        }
    }
}

/// What a χ² test found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChiSquare {
    /// `Σ (observed - expected)² / expected` over the pooled bins.
    pub statistic: f64,
    /// Pooled bins less one.
    pub dof: usize,
    /// Probability that a right sampler does as badly as this or worse. 0 for what a right sampler never does: stray, or
    /// claim a density of more than unit mass. Also 0 where `dof` is 0: a test that compares nothing does not pass.
    pub p_value: f64,
    /// The density's integral over the chart.
    pub mass: f64,
    /// Samples outside of the chart, and samples that the sampler refused to make.
    pub outside: u32,
    /// Samples that lie where the density is 0.
    pub stray: u32,
}

/// Tests whether `sample` draws directions of density `pdf` (per steradian).
///
/// `sample` gets independent uniform points of [0, 1)² and returns a unit direction, or `None` for a sample that counts
/// as nothing. The directions are counted in bins that are equal in the coordinates of `chart`; the expected counts are
/// integrals of `pdf` by adaptive Gauss quadrature. A few samples tell it where to look closely, so that it finds narrow
/// peaks; they do not enter its values. Mass that `pdf` lacks over the chart (1 less its integral) is what is expected outside
/// of the chart or refused.
///
/// Choose the chart to fit the support: bins that are much larger than a light or a lobe see nothing, and a peak that the
/// quadrature overlooks makes the test fail, never pass. A narrow light takes [`crate::CapChart::cap`], a thin lobe
/// [`crate::TransformedChart`].
///
/// ```
/// use ltc_reference::{CapChart, ChiSquareOptions, ChiSquareSuite, chi_square, cosine_direction};
/// use std::f64::consts::PI;
///
/// let options = ChiSquareOptions::default();
/// let mut suite = ChiSquareSuite::new(0.01);
/// suite.add("cosine", chi_square(|u| Some(cosine_direction(u)), |w| w.z.max(0.0) / PI, &CapChart::hemisphere(), options)?);
/// assert!(suite.rejected().is_empty(), "{:?}", suite.rejected());
/// # Ok::<(), ltc_reference::ReferenceError>(())
/// ```
///
/// # Errors
/// [`ReferenceError::NonFiniteIntegrand`] for a NaN, infinite or negative density, [`ReferenceError::NonFiniteInput`] or
/// [`ReferenceError::NotUnit`] for a bad direction.
pub fn chi_square(
    mut sample: impl FnMut([f64; 2]) -> Option<DVec3>,
    pdf: impl Fn(DVec3) -> f64,
    chart: &impl Chart,
    options: ChiSquareOptions,
) -> Result<ChiSquare, ReferenceError> {
    let density = |uv: [f64; 2]| {
        let (w, solid_angle) = chart.direction(uv);
        pdf(w) * solid_angle
    };
    let mut draw = |u: [f64; 2]| match sample(u) {
        None => Ok(Drawn::Nothing),
        Some(w) if !w.is_finite() => Err(ReferenceError::NonFiniteInput { what: "sampled direction" }),
        Some(w) if (w.length() - 1.0).abs() > UNIT_TOLERANCE => {
            Err(ReferenceError::NotUnit { what: "sampled direction", length: w.length() })
        }
        Some(w) if pdf(w) > 0.0 => Ok(chart.place(w).map_or(Drawn::Nothing, Drawn::At)),
        Some(_) => Ok(Drawn::Stray),
    };
    test(&mut draw, &density, options)
}

/// [`chi_square`] for points of the unit square, `density` per unit area: for samplers of textures and surfaces.
///
/// # Errors
/// As [`chi_square`]; points with a NaN or infinite coordinate are [`ReferenceError::NonFiniteInput`].
pub fn chi_square_unit(
    mut sample: impl FnMut([f64; 2]) -> Option<[f64; 2]>,
    density: impl Fn([f64; 2]) -> f64,
    options: ChiSquareOptions,
) -> Result<ChiSquare, ReferenceError> {
    let mut draw = |u: [f64; 2]| match sample(u) {
        None => Ok(Drawn::Nothing),
        Some(uv) if !uv.iter().all(|x| x.is_finite()) => {
            Err(ReferenceError::NonFiniteInput { what: "sampled point" })
        }
        Some(uv) if uv.iter().any(|x| !(0.0..=1.0).contains(x)) => Ok(Drawn::Nothing),
        Some(uv) if density(uv) > 0.0 => Ok(Drawn::At(uv)),
        Some(_) => Ok(Drawn::Stray),
    };
    test(&mut draw, &density, options)
}

/// What became of one sample.
enum Drawn {
    /// It lies in the chart.
    At([f64; 2]),
    /// It lies outside, or was refused.
    Nothing,
    /// It lies where the density is 0.
    Stray,
}

/// Not generic, so that it is compiled once, with this crate's optimisation.
fn test(
    draw: &mut dyn FnMut([f64; 2]) -> Result<Drawn, ReferenceError>,
    density: &dyn Fn([f64; 2]) -> f64,
    options: ChiSquareOptions,
) -> Result<ChiSquare, ReferenceError> {
    let samples = f64::from(options.samples);
    let (mut outside, mut stray, mut points) = (0, 0, Vec::new());
    let mut random = SplitMix64::new(options.seed);
    for _ in 0..options.samples {
        match draw(random.next_2d())? {
            Drawn::At(uv) => points.push(uv),
            Drawn::Nothing => outside += 1,
            Drawn::Stray => stray += 1,
        }
    }
    let bins = counted(density, options.bins, samples, &points)?;
    let mass = bins.iter().map(|bin| bin.expected).sum::<f64>() / samples.max(1.0);
    let outside_bin = Bin { expected: samples * (1.0 - mass), observed: f64::from(outside) };
    // What is outside is never pooled with what is inside: a peak that the quadrature overlooked would hide there.
    let (mut pooled, rest) = pool(bins, options.min_expected);
    let mut rare = vec![rest];
    if outside_bin.expected >= options.min_expected {
        pooled.push(outside_bin);
    } else {
        rare.push(outside_bin);
    }
    let p_rare = rare.iter().map(|bin| bin.poisson_tail(1e-5 * samples)).fold(1.0, f64::min);
    let statistic =
        pooled.iter().map(|bin| (bin.observed - bin.expected).powi(2) / bin.expected).sum::<f64>();
    let dof = pooled.len().saturating_sub(1);
    let p_counts = incomplete_gamma(0.5 * dof as f64, 0.5 * statistic).1;
    let impossible = stray > options.allowed_stray || mass > 1.0 + options.mass_tolerance || dof == 0;
    let p_value = match (impossible, p_rare < 1.0) {
        (true, _) => 0.0,
        (false, true) => (2.0 * p_counts.min(p_rare)).min(1.0),
        (false, false) => p_counts,
    };
    Ok(ChiSquare { statistic, dof, p_value, mass, outside, stray })
}

/// Several χ² tests that shall hold together: each is held to a level so small that all right samplers pass with
/// probability `1 - level`.
#[derive(Clone, Debug, PartialEq)]
pub struct ChiSquareSuite {
    level: f64,
    tests: Vec<(String, ChiSquare)>,
}

impl ChiSquareSuite {
    /// An empty suite with the probability `level` of rejecting any of its tests by chance; 0.01 is usual.
    pub fn new(level: f64) -> Self {
        Self { level, tests: Vec::new() }
    }

    /// Adds a test's outcome.
    pub fn add(&mut self, name: impl Into<String>, outcome: ChiSquare) {
        self.tests.push((name.into(), outcome));
    }

    /// How many tests there are.
    pub fn len(&self) -> usize {
        self.tests.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.tests.is_empty()
    }

    /// The level of each test, `1 - (1 - level)^(1/m)` for m tests (Šidák's correction).
    pub fn threshold(&self) -> f64 {
        sidak(self.level, self.tests.len())
    }

    /// The tests whose p-value lies below the threshold, in the order in which they were added.
    pub fn rejected(&self) -> Vec<(&str, &ChiSquare)> {
        let threshold = self.threshold();
        let below = self.tests.iter().filter(|(_, outcome)| outcome.p_value < threshold);
        below.map(|(name, outcome)| (name.as_str(), outcome)).collect()
    }
}

/// The level of each of `tests` independent tests at which all hold with probability `1 - level`.
pub fn sidak(level: f64, tests: usize) -> f64 {
    -((-level).ln_1p() / tests.max(1) as f64).exp_m1()
}
