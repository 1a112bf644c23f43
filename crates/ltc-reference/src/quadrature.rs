//! One-dimensional quadrature: Gauss-Legendre rules and an adaptive integrator.

use std::f64::consts::PI;

use crate::error::ReferenceError;

/// A value with the integrator's own estimate of its absolute error.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimate {
    /// The integral.
    pub value: f64,
    /// Estimated absolute error, ≥ 0. It compares two rules and is pessimistic for smooth integrands.
    pub error: f64,
    /// How often the integrand was evaluated.
    pub evaluations: usize,
}

/// When an adaptive integrator may stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Stop once the estimated error is at most this.
    pub absolute: f64,
    /// Or at most this fraction of the value.
    pub relative: f64,
    /// Give up after this many evaluations of the integrand.
    pub max_evaluations: usize,
}

impl Tolerance {
    /// An absolute tolerance with room for twenty million evaluations (under a second for the lobes of this crate).
    pub fn absolute(absolute: f64) -> Self {
        Self { absolute, relative: 0.0, max_evaluations: 20_000_000 }
    }

    /// Is an integral of `value` with `error` good enough?
    pub(crate) fn met(&self, value: f64, error: f64) -> bool {
        error <= self.absolute.max(self.relative * value.abs())
    }
}

impl Default for Tolerance {
    /// 1e-9 absolute.
    fn default() -> Self {
        Self::absolute(1e-9)
    }
}

/// Nodes and weights of a Gauss-Legendre rule on [-1, 1]: exact for polynomials of degree 2n - 1.
#[derive(Clone, Debug, PartialEq)]
pub struct GaussLegendre {
    /// (node, weight), nodes ascending.
    pub points: Vec<(f64, f64)>,
}

impl GaussLegendre {
    /// The rule with `n` nodes, n ≥ 1 (0 is taken as 1), by Newton's method on the Legendre polynomial.
    pub fn new(n: usize) -> Self {
        let n = n.max(1);
        let mut points: Vec<(f64, f64)> = (0..n)
            .map(|i| {
                let mut x = (PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
                for _ in 0..50 {
                    let (p, dp) = legendre(n, x);
                    let step = p / dp;
                    x -= step;
                    if step.abs() < 1e-16 {
                        break;
                    }
                }
                let (_, dp) = legendre(n, x);
                (x, 2.0 / ((1.0 - x * x) * dp * dp))
            })
            .collect();
        points.reverse();
        Self { points }
    }

    /// `∫_a^b f` with this rule.
    pub fn integrate(&self, a: f64, b: f64, mut f: impl FnMut(f64) -> f64) -> f64 {
        let (centre, half) = (0.5 * (a + b), 0.5 * (b - a));
        half * self.points.iter().map(|&(x, w)| w * f(centre + half * x)).sum::<f64>()
    }
}

/// Legendre polynomial of degree `n` ≥ 1 and its derivative at `x`, |x| < 1.
fn legendre(n: usize, x: f64) -> (f64, f64) {
    let (mut previous, mut current) = (1.0, x);
    for k in 2..=n {
        let k = k as f64;
        (previous, current) = (current, ((2.0 * k - 1.0) * x * current - (k - 1.0) * previous) / k);
    }
    (current, n as f64 * (x * current - previous) / (x * x - 1.0))
}

/// `∫_a^b f(x) dx`, adaptive: each interval compares the Gauss rules of 7 and 11 nodes and is halved while the sum of
/// the differences exceeds the tolerance. A peak much narrower than the spacing of the nodes can be missed: put a limit of
/// integration there.
///
/// # Errors
/// [`ReferenceError::NonFiniteInput`] for infinite or NaN limits, [`ReferenceError::NonFiniteIntegrand`],
/// [`ReferenceError::NotConverged`].
pub fn integrate_1d(
    mut f: impl FnMut(f64) -> f64,
    a: f64,
    b: f64,
    tolerance: Tolerance,
) -> Result<Estimate, ReferenceError> {
    if !(a.is_finite() && b.is_finite()) {
        return Err(ReferenceError::NonFiniteInput { what: "limit of integration" });
    }
    let (low, high) = (GaussLegendre::new(7), GaussLegendre::new(11));
    let mut evaluations = 0;
    let mut measure = |a: f64, b: f64| {
        evaluations += 18;
        let value = high.integrate(a, b, &mut f);
        let error = (value - low.integrate(a, b, &mut f)).abs();
        if error.is_finite() {
            Ok((Interval { a, b, value, error }, evaluations))
        } else {
            Err(ReferenceError::NonFiniteIntegrand { u: 0.5 * (a + b), v: 0.0 })
        }
    };
    let mut intervals = vec![measure(a, b)?.0];
    loop {
        let value = intervals.iter().map(|i| i.value).sum();
        let error = intervals.iter().map(|i| i.error).sum();
        let best = Estimate { value, error, evaluations: 18 * (2 * intervals.len() - 1) };
        if tolerance.met(value, error) {
            return Ok(best);
        }
        let worst = (0..intervals.len()).max_by(|&i, &j| intervals[i].error.total_cmp(&intervals[j].error));
        let Some(worst) = worst.map(|i| intervals.swap_remove(i)) else { return Ok(best) };
        let middle = 0.5 * (worst.a + worst.b);
        if best.evaluations >= tolerance.max_evaluations || middle <= worst.a.min(worst.b) {
            return Err(ReferenceError::NotConverged { best });
        }
        intervals.push(measure(worst.a, middle)?.0);
        intervals.push(measure(middle, worst.b)?.0);
    }
}

/// One interval of [`integrate_1d`].
struct Interval {
    a: f64,
    b: f64,
    value: f64,
    error: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gauss_rules_have_their_degree_and_not_more() {
        for n in 1..=20usize {
            let rule = GaussLegendre::new(n);
            for degree in 0..2 * n {
                let exact = (1.0 + (-1.0f64).powi(degree as i32)) / (degree as f64 + 1.0);
                let got = rule.integrate(-1.0, 1.0, |x| x.powi(degree as i32));
                assert!((got - exact).abs() < 1e-13, "n {n} degree {degree}: {got}");
            }
            // Negative control: one degree more is not exact. The defect shrinks like 4^-n.
            let exact = 2.0 / (2.0 * n as f64 + 1.0);
            let got = rule.integrate(-1.0, 1.0, |x| x.powi(2 * n as i32));
            assert!((got - exact).abs() > 0.5 * 4.0f64.powi(-(n as i32)), "n {n}");
        }
    }

    #[test]
    fn adaptive_integral_keeps_its_tolerance_over_decades() {
        // A peak of width w at 0.3: ∫ w / (w² + (x-0.3)²) = atan(0.7/w) + atan(0.3/w).
        for w in [1.0, 1e-1, 1e-2, 1e-3] {
            let exact = (0.7f64 / w).atan() + (0.3f64 / w).atan();
            for absolute in [1e-3, 1e-6, 1e-11] {
                let f = |x: f64| w / (w * w + (x - 0.3).powi(2));
                let got = integrate_1d(f, 0.0, 1.0, Tolerance::absolute(absolute)).unwrap();
                assert!((got.value - exact).abs() <= absolute, "{w} {absolute} {got:?}");
            }
        }
    }

    #[test]
    fn a_peak_between_the_nodes_is_missed_unless_the_interval_ends_there() {
        let w = 1e-6;
        let f = |x: f64| w / (w * w + (x - 0.3).powi(2));
        let missed = integrate_1d(f, 0.0, 1.0, Tolerance::absolute(1e-3)).unwrap();
        assert!(missed.value < 0.1, "{missed:?}");
        let tolerance = Tolerance::absolute(1e-7);
        let left = integrate_1d(f, 0.0, 0.3, tolerance).unwrap();
        let right = integrate_1d(f, 0.3, 1.0, tolerance).unwrap();
        assert!((left.value + right.value - (0.7f64 / w).atan() - (0.3f64 / w).atan()).abs() < 2e-7);
    }

    #[test]
    fn non_finite_integrands_and_divergence_are_errors() {
        let nan = integrate_1d(|_| f64::NAN, 0.0, 1.0, Tolerance::default());
        assert!(matches!(nan, Err(ReferenceError::NonFiniteIntegrand { .. })));
        let limits = integrate_1d(|x| x, 0.0, f64::INFINITY, Tolerance::default());
        assert!(matches!(limits, Err(ReferenceError::NonFiniteInput { .. })));
        let tolerance = Tolerance { max_evaluations: 1000, ..Tolerance::default() };
        let divergent = integrate_1d(|x| 1.0 / x, 0.0, 1.0, tolerance);
        assert!(matches!(divergent, Err(ReferenceError::NotConverged { .. })), "{divergent:?}");
    }
}
