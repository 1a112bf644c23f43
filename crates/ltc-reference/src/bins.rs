//! Bins of the unit square: how many samples a density lets expect, and how many there are.

use crate::error::ReferenceError;
use crate::quadrature::GaussLegendre;
use crate::special::incomplete_gamma;

/// A box is quartered while its two quadratures differ by more than this many expected samples.
const BOX_TOLERANCE: f64 = 0.01;
/// The same where the density's support ends: errors of boxes along such a border are as often up as down, if it does not
/// run along the boxes, and those of a bin then stay below some two samples.
const BORDER_TOLERANCE: f64 = 0.05;
/// How often a bin is quartered at most.
const MAX_DEPTH: u32 = 12;
/// How far inside of a box its corners are looked at, in sides: on the border of a chart a density may be 0.
const CORNER: f64 = 1e-6;
/// So many samples tell the quadrature where the density's peaks are.
const HINTS: usize = 256;
/// Boxes with more of them are quartered, whatever the quadratures say.
const HINTS_PER_BOX: usize = 2;
/// How often a bin is quartered at least where expectation and count differ. A sliver of support along a border, which all
/// nodes missed at first, is then found if it is wider than 1/300 of the bin.
const SECOND_LOOK_DEPTH: u32 = 4;
/// How many standard deviations of a count are a difference.
const SECOND_LOOK_SIGMAS: f64 = 3.0;

/// One bin, or several that were pooled.
#[derive(Clone, Copy, Default)]
pub(crate) struct Bin {
    pub expected: f64,
    pub observed: f64,
}

impl Bin {
    /// The probability of as many samples or more where fewer are expected than χ² can judge: the tail of Poisson's
    /// distribution, `P(X ≥ k) = P(k, λ)`, with λ at least the quadrature's error.
    pub fn poisson_tail(&self, least: f64) -> f64 {
        if self.observed > 0.0 { incomplete_gamma(self.observed, self.expected.max(least)).0 } else { 1.0 }
    }
}

/// Bins pooled by ascending expectation until each has `min_expected`, and what is left if that is not reached by all
/// together. What is observed plays no part in the choice.
pub(crate) fn pool(mut bins: Vec<Bin>, min_expected: f64) -> (Vec<Bin>, Bin) {
    bins.sort_by(|a, b| a.expected.total_cmp(&b.expected));
    let mut pooled: Vec<Bin> = Vec::new();
    let mut current = Bin::default();
    for bin in bins {
        current.expected += bin.expected;
        current.observed += bin.observed;
        if current.expected >= min_expected && current.expected > 0.0 {
            pooled.push(current);
            current = Bin::default();
        }
    }
    if let Some(last) = pooled.last_mut() {
        last.expected += current.expected;
        last.observed += current.observed;
        current = Bin::default();
    }
    (pooled, current)
}

/// `columns × rows` equal bins with the integral of the density over each, times `samples`, and with the `points` in it.
///
/// Bins where both differ much are integrated again, more closely: that makes their expectation better, whichever way it
/// moves, and spares the others the cost.
pub(crate) fn counted(
    density: &dyn Fn([f64; 2]) -> f64,
    bins: [usize; 2],
    samples: f64,
    points: &[[f64; 2]],
) -> Result<Vec<Bin>, ReferenceError> {
    let [columns, rows] = bins.map(|n| n.max(1));
    let mut bins = vec![Bin::default(); columns * rows];
    for [u, v] in points {
        let index = |x: f64, n: usize| ((x * n as f64) as usize).min(n - 1);
        bins[index(*u, columns) * rows + index(*v, rows)].observed += 1.0;
    }
    let cubature = Cubature { density, rule: GaussLegendre::new(5), samples };
    let hints = &points[..points.len().min(HINTS)];
    let side = [1.0 / columns as f64, 1.0 / rows as f64];
    for (i, bin) in bins.iter_mut().enumerate() {
        let corner = [(i / rows) as f64 * side[0], (i % rows) as f64 * side[1]];
        let square = Square { corner, side, depth: 0 };
        bin.expected = cubature.bin(square, hints, 0)?;
        if (bin.observed - bin.expected).abs() > SECOND_LOOK_SIGMAS * bin.expected.max(1.0).sqrt() {
            bin.expected = cubature.bin(square, hints, SECOND_LOOK_DEPTH)?;
        }
    }
    Ok(bins)
}

/// Adaptive quadrature of a density that may jump, to a fraction of a sample.
struct Cubature<'a> {
    density: &'a dyn Fn([f64; 2]) -> f64,
    rule: GaussLegendre,
    samples: f64,
}

/// A first measure of a box.
#[derive(Clone, Copy, Default)]
struct Measure {
    /// The expected count.
    count: f64,
    /// Where the density is above 0 at some of its nodes and corners, and 0 at others: what the count were if the density had
    /// its largest value everywhere. 0 elsewhere.
    bound: f64,
}

impl Cubature<'_> {
    /// A box by the 5 × 5 rule.
    fn measure(&self, square: Square) -> Result<Measure, ReferenceError> {
        let ([u0, v0], [du, dv]) = (square.corner, square.side);
        let (mut least, mut most) = (f64::INFINITY, 0.0f64);
        let mut at = |u: f64, v: f64| {
            let density = (self.density)([u, v]);
            (least, most) = (least.min(density), most.max(density));
            density
        };
        let value = self.rule.integrate(u0, u0 + du, |u| self.rule.integrate(v0, v0 + dv, |v| at(u, v)));
        for [i, j] in [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]] {
            let inside = |x: f64| CORNER + x * (1.0 - 2.0 * CORNER);
            at(u0 + inside(i) * du, v0 + inside(j) * dv);
        }
        if value.is_finite() && least >= 0.0 && most.is_finite() {
            let bound = if least == 0.0 { self.samples * most * du * dv } else { 0.0 };
            Ok(Measure { count: self.samples * value, bound })
        } else {
            Err(ReferenceError::NonFiniteIntegrand { u: u0, v: v0 })
        }
    }

    /// The expected count of a bin, quartered `depth` times at least.
    fn bin(&self, square: Square, hints: &[[f64; 2]], depth: u32) -> Result<f64, ReferenceError> {
        self.refine(square, self.measure(square)?, hints, depth)
    }

    /// The expected count of a box of which `coarse` is a first measure.
    fn refine(
        &self,
        square: Square,
        coarse: Measure,
        hints: &[[f64; 2]],
        depth: u32,
    ) -> Result<f64, ReferenceError> {
        let inside: Vec<[f64; 2]> = hints.iter().copied().filter(|hint| square.contains(hint)).collect();
        let mut quarters = [(square, Measure::default()); 4];
        for (i, (quarter, measure)) in quarters.iter_mut().enumerate() {
            *quarter = square.quarter(i);
            *measure = self.measure(*quarter)?;
        }
        let fine = quarters.iter().map(|(_, measure)| measure.count).sum::<f64>();
        // Where the support ends between a corner and the first node, both measures are wrong alike, by up to an eighth.
        let bound = quarters.iter().map(|(_, measure)| measure.bound).sum::<f64>();
        let good = (fine - coarse.count).abs() <= BOX_TOLERANCE
            && 0.125 * bound <= BORDER_TOLERANCE
            && inside.len() <= HINTS_PER_BOX
            && square.depth >= depth;
        if good || square.depth >= MAX_DEPTH {
            return Ok(fine);
        }
        quarters.iter().map(|&(quarter, measure)| self.refine(quarter, measure, &inside, depth)).sum()
    }
}

/// A box of the unit square.
#[derive(Clone, Copy)]
struct Square {
    corner: [f64; 2],
    side: [f64; 2],
    depth: u32,
}

impl Square {
    /// One of its quarters, by number.
    fn quarter(self, i: usize) -> Self {
        let side = self.side.map(|s| 0.5 * s);
        let corner = [self.corner[0] + (i & 1) as f64 * side[0], self.corner[1] + (i >> 1) as f64 * side[1]];
        Self { corner, side, depth: self.depth + 1 }
    }

    fn contains(&self, point: &[f64; 2]) -> bool {
        (0..2)
            .all(|axis| point[axis] >= self.corner[axis] && point[axis] < self.corner[axis] + self.side[axis])
    }
}
