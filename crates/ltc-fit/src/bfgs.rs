//! Quasi-Newton minimisation of a function of a few variables.

/// Most variables there can be.
pub const MAX_DIMENSION: usize = 7;

/// A point or a gradient; entries past the dimension are 0.
pub type Point = [f64; MAX_DIMENSION];

/// Why the minimiser stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Stop {
    /// No step along the descent direction lowers the value any more.
    Converged,
    /// The number of iterations ran out.
    Iterations,
}

/// A local minimum and how it was reached.
#[derive(Clone, Copy, Debug)]
pub struct Minimum {
    /// Where.
    pub point: Point,
    /// The value there.
    pub value: f64,
    /// Iterations done.
    pub iterations: usize,
    /// Why no more.
    pub stop: Stop,
}

/// Longest step, in units of the variables: these are relative changes of a lobe.
const MAX_STEP: f64 = 0.5;
/// A decrease below this is none.
const MIN_DECREASE: f64 = 1e-9;

/// BFGS with a backtracking line search from the origin, for functions with a kink here and there.
///
/// `value_and_gradient` may return a non-finite value where the point is not allowed.
pub fn minimise(
    mut value_and_gradient: impl FnMut(&Point) -> (f64, Point),
    max_iterations: usize,
) -> Minimum {
    let mut point = [0.0; MAX_DIMENSION];
    let (mut value, mut gradient) = value_and_gradient(&point);
    let mut inverse_hessian = Metric::scaled(0.2);
    let mut fresh = true;
    for iterations in 0..max_iterations {
        let direction = inverse_hessian.descent(&gradient);
        let Some((next, next_value, next_gradient)) =
            line_search(&mut value_and_gradient, &point, value, &gradient, direction)
        else {
            if fresh {
                return Minimum { point, value, iterations, stop: Stop::Converged };
            }
            // The curvature gathered so far misleads, as it does across a kink: try steepest descent once.
            inverse_hessian = Metric::scaled(0.02);
            fresh = true;
            continue;
        };
        inverse_hessian.update(&difference(&next, &point), &difference(&next_gradient, &gradient));
        fresh = false;
        (point, value, gradient) = (next, next_value, next_gradient);
    }
    Minimum { point, value, iterations: max_iterations, stop: Stop::Iterations }
}

fn line_search(
    value_and_gradient: &mut impl FnMut(&Point) -> (f64, Point),
    point: &Point,
    value: f64,
    gradient: &Point,
    direction: Point,
) -> Option<(Point, f64, Point)> {
    let slope = dot(gradient, &direction);
    if slope >= 0.0 || !slope.is_finite() {
        return None;
    }
    let longest = direction.iter().fold(0.0_f64, |m, d| m.max(d.abs()));
    let mut step = (MAX_STEP / longest).min(1.0);
    for _ in 0..12 {
        let mut next = *point;
        for (x, d) in next.iter_mut().zip(direction) {
            *x += step * d;
        }
        let (next_value, next_gradient) = value_and_gradient(&next);
        let wanted = (1e-4 * step * -slope).max(MIN_DECREASE);
        if next_value.is_finite() && value - next_value >= wanted {
            return Some((next, next_value, next_gradient));
        }
        step *= 0.4;
    }
    None
}

/// The inverse Hessian.
struct Metric([Point; MAX_DIMENSION]);

impl Metric {
    fn scaled(scale: f64) -> Self {
        let mut rows = [[0.0; MAX_DIMENSION]; MAX_DIMENSION];
        for (i, row) in rows.iter_mut().enumerate() {
            row[i] = scale;
        }
        Self(rows)
    }

    fn apply(&self, v: &Point) -> Point {
        self.0.map(|row| dot(&row, v))
    }

    fn descent(&self, gradient: &Point) -> Point {
        self.apply(gradient).map(|x| -x)
    }

    /// `H ← (I − s yᵀ/ys) H (I − y sᵀ/ys) + s sᵀ/ys`, left out where the curvature `yᵀs` is not positive.
    fn update(&mut self, s: &Point, y: &Point) {
        let ys = dot(y, s);
        if ys <= 1e-12 * (dot(s, s) * dot(y, y)).sqrt() {
            return;
        }
        let hy = self.apply(y);
        let scale = (1.0 + dot(y, &hy) / ys) / ys;
        for i in 0..MAX_DIMENSION {
            for j in 0..MAX_DIMENSION {
                self.0[i][j] += scale * s[i] * s[j] - (hy[i] * s[j] + s[i] * hy[j]) / ys;
            }
        }
    }
}

fn dot(a: &Point, b: &Point) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

fn difference(a: &Point, b: &Point) -> Point {
    core::array::from_fn(|i| a[i] - b[i])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_the_valley_of_rosenbrock() {
        let minimum = minimise(
            |p| {
                let (x, y) = (p[0] - 1.0 + 1.0, p[1]);
                let (a, b) = (1.0 - x, y - x * x);
                let mut g = [0.0; MAX_DIMENSION];
                g[0] = -2.0 * a - 40.0 * x * b;
                g[1] = 20.0 * b;
                (a * a + 10.0 * b * b, g)
            },
            200,
        );
        assert_eq!(minimum.stop, Stop::Converged);
        assert!(
            (minimum.point[0] - 1.0).abs() < 1e-3 && (minimum.point[1] - 1.0).abs() < 1e-3,
            "{minimum:?}"
        );
    }

    #[test]
    fn a_kink_and_a_forbidden_region_do_not_break_it() {
        let minimum = minimise(
            |p| {
                let mut g = [0.0; MAX_DIMENSION];
                g[0] = (p[0] - 0.3).signum();
                let value = if p[0] > 0.4 { f64::NAN } else { (p[0] - 0.3).abs() };
                (value, g)
            },
            100,
        );
        assert!((minimum.point[0] - 0.3).abs() < 1e-2, "{minimum:?}");
    }
}
