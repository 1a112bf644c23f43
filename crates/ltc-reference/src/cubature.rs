//! Adaptive two-dimensional cubature over a set of unit squares.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use crate::error::ReferenceError;
use crate::quadrature::{Estimate, GaussLegendre, Tolerance};

/// Boxes are halved before anything is measured while they hold more seeds than this.
const SEEDS_PER_BOX: usize = 4;
/// And while two or more seeds fill less than this fraction of the box along either axis: then the peak is narrower
/// than the spacing of the nodes.
const FILLED: f64 = 0.125;
/// But sides shorter than this are not halved for the sake of seeds: several may coincide.
const MIN_SEEDED_SIDE: f64 = 1e-9;
/// How far the difference of two rules is trusted. For smooth integrands it exceeds the better rule's error by orders of
/// magnitude; along a kink both rules are wrong by about as much and their difference can be smaller than the error.
const SAFETY: f64 = 3.0;
/// An error below this fraction of the value is rounding.
const ROUNDING: f64 = 1e-14;
/// Sides shorter than this are not halved any more: f64 has no points left in between.
const MIN_SIDE: f64 = 1e-13;

/// The sum of `∫∫ f(piece, u, v) du dv` over the unit squares `piece = 0 .. seeds.len()`.
///
/// Each box compares three products of Gauss rules, 7×7 against 5×7 and 7×5: the differences are its error and
/// tell along which axis to halve it. The worst box of all pieces is halved next, until the sum of the errors meets
/// the tolerance, and once more until a sixteenth of it, to see that the value stays.
///
/// `seeds[piece]` are points where the integrand's mass is. Boxes are first halved until each holds at most four of them,
/// and those not in one spot, so that a narrow peak cannot slip between the nodes. Seeds only place the boxes; wrong
/// ones cost time, not accuracy.
///
/// Kinks and jumps converge, but where one cuts off the mere corner of a box every node can lie on its flat side; what is
/// lost so is not in the error. Cut the pieces along known kinks, or start from small pieces.
///
/// # Errors
/// [`ReferenceError::NonFiniteIntegrand`], [`ReferenceError::NotConverged`].
pub fn integrate_squares(
    f: impl Fn(usize, f64, f64) -> f64,
    seeds: &[Vec<[f64; 2]>],
    tolerance: Tolerance,
) -> Result<Estimate, ReferenceError> {
    let rules = Rules::new();
    let mut heap = BinaryHeap::new();
    for (piece, seeds) in seeds.iter().enumerate() {
        seeded_boxes(piece, seeds, &mut |square| {
            heap.push(rules.measure(&f, square)?);
            Ok(())
        })?;
    }
    refine(&f, &rules, heap, tolerance)
}

/// Halves the worst box until the tolerance is met, and then until a sixteenth of it is met, without the value moving by
/// more than the tolerance.
///
/// The second stage is for integrands whose mass hides along the borders of boxes, such as the tails of a narrow lobe:
/// there both rules can be wrong by the same amount. Such mass shows up as the tolerance tightens.
fn refine(
    f: &impl Fn(usize, f64, f64) -> f64,
    rules: &Rules,
    mut heap: BinaryHeap<Measured>,
    tolerance: Tolerance,
) -> Result<Estimate, ReferenceError> {
    let mut evaluations = heap.len() * Rules::EVALUATIONS;
    let mut previous_stage: Option<f64> = None;
    let mut strictness = 1.0;
    // Running sums drift; they are made anew whenever they say that the work is done, and now and then.
    let (mut value, mut error) = sums(&heap);
    let mut since_sum = 0;
    loop {
        if tolerance.met(value, strictness * error) || since_sum > 4096 {
            (value, error) = sums(&heap);
            since_sum = 0;
        }
        if tolerance.met(value, strictness * error) {
            let moved = previous_stage.map_or(f64::INFINITY, |previous| (value - previous).abs());
            if tolerance.met(value, moved) || error <= ROUNDING * value.abs() {
                let moved = if moved.is_finite() { moved } else { 0.0 };
                return Ok(Estimate { value, error: error.max(moved), evaluations });
            }
            previous_stage = Some(value);
            strictness *= 16.0;
            continue;
        }
        let best = Estimate { value, error, evaluations };
        let Some(worst) = heap.pop() else { return Ok(best) };
        let halves = worst.square.halves(worst.along_u);
        let Some(halves) = halves.filter(|_| evaluations < tolerance.max_evaluations) else {
            return Err(ReferenceError::NotConverged { best });
        };
        value -= worst.value;
        error -= worst.error;
        for half in halves {
            let measured = rules.measure(f, half)?;
            value += measured.value;
            error += measured.error;
            heap.push(measured);
        }
        evaluations += 2 * Rules::EVALUATIONS;
        since_sum += 1;
    }
}

/// Sum of the values and of the errors of all boxes.
fn sums(heap: &BinaryHeap<Measured>) -> (f64, f64) {
    heap.iter().fold((0.0, 0.0), |(value, error), m| (value + m.value, error + m.error))
}

/// Calls `visit` with the boxes of one piece, small where the seeds are.
fn seeded_boxes(
    piece: usize,
    seeds: &[[f64; 2]],
    visit: &mut impl FnMut(Square) -> Result<(), ReferenceError>,
) -> Result<(), ReferenceError> {
    let whole = Square { piece, u0: 0.0, v0: 0.0, du: 1.0, dv: 1.0 };
    let mut stack = vec![(whole, seeds.to_vec())];
    while let Some((square, seeds)) = stack.pop() {
        let halves = seeded_axis(&square, &seeds).and_then(|along_u| square.halves(along_u));
        let Some([first, second]) = halves else {
            visit(square)?;
            continue;
        };
        let (inside, outside) = seeds.into_iter().partition(|&[u, v]| u < first.u_end() && v < first.v_end());
        stack.push((first, inside));
        stack.push((second, outside));
    }
    Ok(())
}

/// Along which axis (true: u) the box is to be halved for its seeds, if at all.
fn seeded_axis(square: &Square, seeds: &[[f64; 2]]) -> Option<bool> {
    if seeds.len() < 2 || square.du.max(square.dv) < MIN_SEEDED_SIDE {
        return None;
    }
    let filled = |axis: usize, side: f64| {
        let (low, high) =
            seeds.iter().fold((f64::MAX, f64::MIN), |(a, b), s| (a.min(s[axis]), b.max(s[axis])));
        if side < MIN_SEEDED_SIDE { 1.0 } else { (high - low) / side }
    };
    let (along_u, along_v) = (filled(0, square.du), filled(1, square.dv));
    // While the seeds fill neither axis, the longer side goes first: a thin slab would hide the peak along its length.
    if along_u.max(along_v) < FILLED {
        return Some(square.du >= square.dv);
    }
    (seeds.len() > SEEDS_PER_BOX || along_u.min(along_v) < FILLED).then_some(along_u <= along_v)
}

/// A box of one piece.
#[derive(Clone, Copy)]
struct Square {
    piece: usize,
    u0: f64,
    v0: f64,
    du: f64,
    dv: f64,
}

impl Square {
    fn u_end(&self) -> f64 {
        self.u0 + self.du
    }

    fn v_end(&self) -> f64 {
        self.v0 + self.dv
    }

    /// The two halves, or `None` when the box is as small as f64 allows.
    fn halves(self, along_u: bool) -> Option<[Self; 2]> {
        // A box that is at the limit in the wanted direction is halved in the other.
        let along_u = if self.du < MIN_SIDE { false } else { along_u || self.dv < MIN_SIDE };
        if self.du.max(self.dv) < MIN_SIDE {
            return None;
        }
        let mut halves = [self; 2];
        for (i, half) in halves.iter_mut().enumerate() {
            if along_u {
                half.du *= 0.5;
                half.u0 += i as f64 * half.du;
            } else {
                half.dv *= 0.5;
                half.v0 += i as f64 * half.dv;
            }
        }
        Some(halves)
    }
}

/// A box with its integral; ordered by its error.
struct Measured {
    square: Square,
    value: f64,
    error: f64,
    along_u: bool,
}

impl Ord for Measured {
    fn cmp(&self, other: &Self) -> Ordering {
        self.error.total_cmp(&other.error)
    }
}

impl PartialOrd for Measured {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Measured {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Measured {}

/// The two Gauss rules whose products measure a box.
struct Rules {
    high: GaussLegendre,
    low: GaussLegendre,
}

impl Rules {
    /// Evaluations per box.
    const EVALUATIONS: usize = 7 * 7 + 2 * 5 * 7;

    fn new() -> Self {
        Self { high: GaussLegendre::new(7), low: GaussLegendre::new(5) }
    }

    fn measure(
        &self,
        f: &impl Fn(usize, f64, f64) -> f64,
        square: Square,
    ) -> Result<Measured, ReferenceError> {
        let product = |in_u: &GaussLegendre, in_v: &GaussLegendre| {
            in_u.integrate(square.u0, square.u_end(), |u| {
                in_v.integrate(square.v0, square.v_end(), |v| f(square.piece, u, v))
            })
        };
        let value = product(&self.high, &self.high);
        let error_u = (value - product(&self.low, &self.high)).abs();
        let error_v = (value - product(&self.high, &self.low)).abs();
        let error = SAFETY * (error_u + error_v);
        if !error.is_finite() {
            let (u, v) = (square.u0 + 0.5 * square.du, square.v0 + 0.5 * square.dv);
            return Err(ReferenceError::NonFiniteIntegrand { u, v });
        }
        Ok(Measured { square, value, error, along_u: error_u >= error_v })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// `∫∫ w² / (w² + r²)² du dv` over all of the plane is π; nearly all of it lies in the unit square.
    fn peak(w: f64) -> impl Fn(usize, f64, f64) -> f64 {
        move |_, u, v| {
            let r2 = (u - 0.3117).powi(2) + (v - 0.6421).powi(2);
            w * w / (w * w + r2).powi(2)
        }
    }

    #[test]
    fn narrow_peaks_are_found_through_their_seeds() {
        for w in [1e-2, 1e-4, 1e-6] {
            let seeds: Vec<_> = (0..16).map(|i| [0.3117 + 1e-3 * w * i as f64, 0.6421]).collect();
            let got = integrate_squares(peak(w), &[seeds], Tolerance::absolute(1e-8)).unwrap();
            // Mass outside of the unit square is O(w²); the nearest side is 0.31 away.
            assert!((got.value - PI).abs() < 1e-8 + 60.0 * w * w, "{w}: {got:?}");
        }
    }

    #[test]
    fn without_seeds_a_narrow_peak_is_missed() {
        // Negative control for the seeds: this peak of mass π slips through.
        let got = integrate_squares(peak(1e-6), &[vec![]], Tolerance::absolute(1e-6)).unwrap();
        assert!(got.value < 1e-3, "{got:?}");
    }

    #[test]
    fn jumps_and_kinks_keep_the_tolerance() {
        let kink = |_: usize, u: f64, v: f64| (u + v - 0.7).abs();
        // ∫∫ (u + v - c) = 1 - c, and twice the negative part: 2 ∫∫_{u+v<c} (c - u - v) = 2 c³ / 6.
        let exact = (1.0 - 0.7) + 2.0 * 0.7f64.powi(3) / 6.0;
        let got = integrate_squares(kink, &[vec![]], Tolerance::absolute(1e-7)).unwrap();
        assert!((got.value - exact).abs() < 1e-7, "{got:?} {exact}");
        let jump = |_: usize, u: f64, v: f64| if u < 0.7 * v { 1.0 } else { 0.0 };
        let got = integrate_squares(jump, &[vec![]], Tolerance::absolute(1e-3)).unwrap();
        assert!((got.value - 0.35).abs() < 1e-3, "{got:?}");
    }

    #[test]
    fn bad_integrands_are_errors() {
        let nan = integrate_squares(|_, _, _| f64::NAN, &[vec![]], Tolerance::default());
        assert!(matches!(nan, Err(ReferenceError::NonFiniteIntegrand { .. })));
        let tolerance = Tolerance { max_evaluations: 10_000, ..Tolerance::absolute(1e-9) };
        let divergent = integrate_squares(|_, u, _| 1.0 / u, &[vec![]], tolerance);
        assert!(matches!(divergent, Err(ReferenceError::NotConverged { .. })));
        let empty = integrate_squares(|_, _, _| 1.0, &[], Tolerance::default()).unwrap();
        assert_eq!(empty.value, 0.0);
    }
}
