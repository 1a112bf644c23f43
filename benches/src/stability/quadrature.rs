//! Adaptive Gauss–Legendre quadrature in numbers of 31 digits.

use std::sync::LazyLock;

use crate::double_double::DoubleDouble as D;

const NODES: usize = 20;
/// Halvings of one panel: far more than any light needs.
const DEPTH: u32 = 100;

/// Nodes in [−1, 1] and their weights: roots of the Legendre polynomial by Newton's method.
static RULE: LazyLock<Vec<(D, D)>> = LazyLock::new(|| {
    (0..NODES)
        .map(|i| {
            let guess = (core::f64::consts::PI * (i as f64 + 0.75) / (NODES as f64 + 0.5)).cos();
            let mut x = D::from(guess);
            let mut slope = D::ONE;
            for _ in 0..8 {
                let (value, derivative) = legendre(x);
                x = x - value / derivative;
                slope = derivative;
            }
            (x, D::from(2.0) / ((D::ONE - x * x) * slope * slope))
        })
        .collect()
});

/// The polynomial of degree `NODES` and its derivative.
fn legendre(x: D) -> (D, D) {
    let (mut before, mut value) = (D::ONE, x);
    for k in 2..=NODES {
        let (k, less) = (D::from(k as f64), D::from(k as f64 - 1.0));
        let next = ((k + less) * x * value - less * before) / k;
        (before, value) = (value, next);
    }
    let n = D::from(NODES as f64);
    (value, n * (x * value - before) / (x * x - D::ONE))
}

fn panel(f: &impl Fn(D) -> D, a: D, b: D) -> D {
    let half: D = 0.5.into();
    let (middle, reach) = ((a + b) * half, (b - a) * half);
    let mut sum = D::ZERO;
    for (x, weight) in RULE.iter() {
        sum += f(middle + *x * reach) * *weight;
    }
    sum * reach
}

/// `∫ f ds` between the first and the last of `knots`, cut at all of them, to `tolerance` a panel: far better than that, since
/// what is compared with it is the error before a last halving.
pub(super) fn integrate(f: impl Fn(D) -> D, knots: &[D], tolerance: f64) -> D {
    let mut total = D::ZERO;
    for pair in knots.windows(2) {
        let mut open = vec![(pair[0], pair[1], panel(&f, pair[0], pair[1]), 0)];
        while let Some((a, b, whole, depth)) = open.pop() {
            let middle = (a + b) * 0.5.into();
            let (left, right) = (panel(&f, a, middle), panel(&f, middle, b));
            let error = (left + right - whole).to_f64().abs();
            // A sum beyond the tolerance's 1e28-fold cannot be told better.
            let floor = 1e-28 * (left.to_f64().abs() + right.to_f64().abs());
            if error <= tolerance.max(floor) || depth >= DEPTH {
                total += left + right;
            } else {
                open.extend([(a, middle, left, depth + 1), (middle, b, right, depth + 1)]);
            }
        }
    }
    total
}

/// Where positive `f` has local minima on [from, to], ends included, in order: the places to cut at, so that no peak of 1/f hides
/// between nodes.
pub(super) fn knots(f: impl Fn(f64) -> f64, [from, to]: [D; 2]) -> Vec<D> {
    const SAMPLES: usize = 48;
    let (low, high) = (from.to_f64(), to.to_f64());
    let at = |i: usize| low + (high - low) * i as f64 / SAMPLES as f64;
    let values: Vec<f64> = (0..=SAMPLES).map(|i| f(at(i))).collect();
    let mut knots = vec![from];
    for i in 1..SAMPLES {
        if values[i] <= values[i - 1] && values[i] < values[i + 1] {
            knots.push(minimum(&f, at(i - 1), at(i + 1)).into());
        }
    }
    // Minima beside an end.
    for (i, j) in [(0, 1), (SAMPLES - 1, SAMPLES)] {
        let inner = minimum(&f, at(i), at(j));
        if f(inner) < values[i].min(values[j]) {
            knots.push(inner.into());
        }
    }
    knots.retain(|s| *s == from || (*s > from && *s < to));
    knots.push(to);
    knots.sort_by(|a, b| a.to_f64().total_cmp(&b.to_f64()));
    knots
}

/// By golden section.
fn minimum(f: impl Fn(f64) -> f64, mut a: f64, mut b: f64) -> f64 {
    const RATIO: f64 = 0.618_033_988_749_895;
    let (mut c, mut d) = (b - RATIO * (b - a), a + RATIO * (b - a));
    let (mut at_c, mut at_d) = (f(c), f(d));
    for _ in 0..60 {
        if at_c < at_d {
            (b, d, at_d) = (d, c, at_c);
            c = b - RATIO * (b - a);
            at_c = f(c);
        } else {
            (a, c, at_c) = (c, d, at_d);
            d = a + RATIO * (b - a);
            at_d = f(d);
        }
    }
    0.5 * (a + b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_and_a_sharp_peak_are_integrated_to_the_last_digits() {
        let power = |x: D| (0..39).fold(D::ONE, |p, _| p * x);
        let value = integrate(power, &[D::ZERO, D::ONE], 1e-15);
        assert!((value - D::ONE / 40.0.into()).to_f64().abs() < 1e-29, "{value}");
        // ∫ e / (e² + x²) dx from −1 to 1 = π − 2 atan e, for e = 1e-9
        let e: D = 1e-9.into();
        let value = integrate(|x| e / (e * e + x * x), &[-D::ONE, D::ZERO, D::ONE], 1e-18);
        let series = e - e * e * e / 3.0.into();
        assert!((value - (D::PI - series * 2.0.into())).to_f64().abs() < 1e-24, "{value}");
    }

    #[test]
    fn minima_are_found() {
        let found = knots(|x| (x - 0.123) * (x - 0.123) + 1e-12, [D::ZERO, D::ONE]);
        assert!(found.len() == 3 && (found[1].to_f64() - 0.123).abs() < 1e-6, "{found:?}");
        assert_eq!(knots(|x| x, [D::ZERO, D::ONE]).len(), 2);
    }
}
