//! Nelder and Mead's simplex, for comparison with the papers' fits.

use crate::bfgs::{MAX_DIMENSION, Minimum, Point, Stop};

/// The simplex stops when its values differ by less than this part of their size.
const TOLERANCE: f64 = 1e-6;

/// Minimises a function of the first `dimension` variables from `start` by reflecting, expanding (×2), contracting
/// (×½) and shrinking (×½) a simplex whose edges are `size` long at first (Nelder & Mead 1965). No gradients; values that are not finite
/// count as infinitely bad.
///
/// Its stop is [`Stop::Converged`] when the values at the corners are equal to 1e-6, which need not be at a minimum: that is what the
/// method is like.
pub fn minimise(
    mut value: impl FnMut(&Point) -> f64,
    start: &Point,
    dimension: usize,
    size: f64,
    max_iterations: usize,
) -> Minimum {
    let mut value = |point: &Point| Some(value(point)).filter(|v| v.is_finite()).unwrap_or(f64::INFINITY);
    let dimension = dimension.min(MAX_DIMENSION);
    let mut corners: Vec<(Point, f64)> = (0..=dimension)
        .map(|i| {
            let mut point = *start;
            if i > 0 {
                point[i - 1] += size;
            }
            (point, value(&point))
        })
        .collect();
    for iterations in 0..max_iterations {
        corners.sort_by(|a, b| a.1.total_cmp(&b.1));
        let (best, worst) = (corners[0], corners[dimension]);
        let flat = 2.0 * (worst.1 - best.1) <= TOLERANCE * (worst.1.abs() + best.1.abs());
        if flat || dimension == 0 {
            return Minimum { point: best.0, value: best.1, iterations, stop: Stop::Converged };
        }
        step(&mut corners, &mut value);
    }
    corners.sort_by(|a, b| a.1.total_cmp(&b.1));
    let (point, value) = corners[0];
    Minimum { point, value, iterations: max_iterations, stop: Stop::Iterations }
}

/// Replaces the worst of the sorted corners, or shrinks all towards the best.
fn step(corners: &mut [(Point, f64)], value: &mut impl FnMut(&Point) -> f64) {
    let last = corners.len() - 1;
    let (best, second_worst, worst) = (corners[0], corners[last - 1], corners[last]);
    let centre = mean(&corners[..last]);
    let mut along = |t: f64| {
        let point = between(&centre, &worst.0, t);
        (point, value(&point))
    };
    let reflected = along(-1.0);
    if reflected.1 < best.1 {
        let expanded = along(-2.0);
        corners[last] = if expanded.1 < reflected.1 { expanded } else { reflected };
    } else if reflected.1 < second_worst.1 {
        corners[last] = reflected;
    } else {
        let contracted = along(if reflected.1 < worst.1 { -0.5 } else { 0.5 });
        if contracted.1 < reflected.1.min(worst.1) {
            corners[last] = contracted;
        } else {
            for corner in &mut corners[1..] {
                let point = between(&best.0, &corner.0, 0.5);
                *corner = (point, value(&point));
            }
        }
    }
}

/// `a + t (b − a)`.
fn between(a: &Point, b: &Point, t: f64) -> Point {
    core::array::from_fn(|i| a[i] + t * (b[i] - a[i]))
}

fn mean(corners: &[(Point, f64)]) -> Point {
    core::array::from_fn(|i| corners.iter().map(|(point, _)| point[i]).sum::<f64>() / corners.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_the_valley_of_rosenbrock() {
        let rosenbrock = |p: &Point| (1.0 - p[0]).powi(2) + 100.0 * (p[1] - p[0] * p[0]).powi(2);
        let mut start = [0.0; MAX_DIMENSION];
        (start[0], start[1], start[2]) = (-1.2, 1.0, 7.0);
        let minimum = minimise(rosenbrock, &start, 2, 0.5, 500);
        assert_eq!(minimum.stop, Stop::Converged);
        assert!(minimum.value < 1e-5, "{minimum:?}");
        assert_eq!(minimum.point[2], 7.0, "variables past the dimension stay");
        let cut_short = minimise(rosenbrock, &start, 2, 0.5, 10);
        assert_eq!((cut_short.stop, cut_short.iterations), (Stop::Iterations, 10));
        assert!(cut_short.value < rosenbrock(&start));
    }

    #[test]
    fn seven_variables_and_a_forbidden_region() {
        let bowl = |p: &Point| {
            let sum = p.iter().enumerate().map(|(i, x)| (i + 1) as f64 * (x - 0.3).powi(2)).sum::<f64>();
            if p[0] > 0.5 { f64::NAN } else { 1.0 + sum }
        };
        let minimum = minimise(bowl, &[0.0; MAX_DIMENSION], 7, 0.2, 2000);
        assert!(minimum.value < 1.0 + 1e-4, "{minimum:?}");
    }

    #[test]
    fn nothing_to_do_and_nothing_allowed() {
        assert_eq!(minimise(|_| 2.0, &[1.0; MAX_DIMENSION], 0, 0.1, 5).value, 2.0);
        let nowhere = minimise(|_| f64::NAN, &[1.0; MAX_DIMENSION], 3, 0.1, 5);
        assert_eq!(nowhere.value, f64::INFINITY);
    }
}
