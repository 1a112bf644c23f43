//! The queries that tables are judged by, and those that they are fitted to.

use core::f64::consts::{FRAC_PI_2, TAU};

use ltc_core::points::SplitMix64;
use ltc_table::{Axis, Mapping, Query};

/// α < this counts as narrow in the statistics.
pub const NARROW_ALPHA: f64 = 0.14;

/// The standard draw, always off the grid: α half from U[0.01, 1], half from (U[0.1, 1])²; λ = α_y/α_x ~ U[0.05, 1], or 1
/// in the isotropic draw; θ ~ U[0°, 86°]; φ ~ U[0, 2π).
pub fn standard(count: usize, seed: u64, isotropic: bool) -> Vec<Query> {
    up_to(86.0, count, seed, isotropic)
}

/// How far θ goes in the draw that magnitude and Fresnel are judged by.
pub const ALBEDO_THETA_MAX_DEGREES: f64 = 89.0;

/// The standard draw with another end of θ.
pub fn up_to(theta_max_degrees: f64, count: usize, seed: u64, isotropic: bool) -> Vec<Query> {
    let mut rng = SplitMix64::new(seed);
    (0..count).map(|_| one(&mut rng, isotropic, 0.01, 0.05, theta_max_degrees)).collect()
}

/// Queries for fitting: the standard draw, reaching a little beyond it on all sides, with a few very thin lobes.
pub fn training(rng: &mut SplitMix64, count: usize, isotropic: bool) -> Vec<Query> {
    (0..count)
        .map(|_| {
            let mut query = one(rng, isotropic, 0.004, 0.03, 89.0);
            // A tenth goes to the thinnest lobes, half of it near grazing. They are where the largest errors are: few queries of
            // the draw come there, and its mean hardly feels them.
            if rng.unit() < 0.1 {
                let alpha = 0.004 * 15.0_f64.powf(rng.unit());
                let lambda = if isotropic { 1.0 } else { 0.03_f64.powf(rng.unit()) };
                (query.alpha_x, query.alpha_y) = (alpha, alpha * lambda);
                if rng.unit() < 0.5 {
                    query.theta = rng.range(75.0, 89.0).to_radians();
                }
            }
            query
        })
        .collect()
}

/// Queries for magnitude and Fresnel: the standard draw up to 89.5°, every fourth query near grazing and near α = 0, where both
/// change fastest. There α is even in its logarithm and θ crowds towards 89.5°. Another quarter of the anisotropic queries looks
/// along the smooth axis of thin lobes: within about λ of φ = 90° the width that the view sees falls from α to αλ.
pub fn grazing(rng: &mut SplitMix64, count: usize, isotropic: bool) -> Vec<Query> {
    (0..count)
        .map(|i| {
            let mut query = one(rng, isotropic, 0.008, 0.04, 89.5);
            if i % 4 == 3 {
                let alpha = 0.008 * 125.0_f64.powf(rng.unit());
                (query.alpha_x, query.alpha_y) = (alpha, alpha * query.alpha_y / query.alpha_x);
                query.theta = (89.5 - 35.0 * rng.unit().powi(2)).to_radians();
            }
            if i % 4 == 1 && !isotropic {
                query.phi = FRAC_PI_2 * (1.0 - rng.unit().powi(3));
                query.alpha_y = query.alpha_x * 0.045_f64.powf(rng.unit());
                query.theta = (89.2 - 25.0 * rng.unit().powf(1.5)).to_radians();
            }
            query
        })
        .collect()
}

/// Queries even over anisotropic axes, in the coordinates that their nodes are even in (θ of every other query: in itself), up to
/// 89.5°: what [`grazing`] leaves nearly empty, such as rough lobes seen along their smooth axis. None for other axes.
pub fn over(rng: &mut SplitMix64, count: usize, axes: &[Axis]) -> Vec<Query> {
    let [theta, phi, alpha, lambda] = axes else { return Vec::new() };
    let theta_max = 89.5_f64.to_radians().clamp(theta.domain[0], theta.domain[1]);
    let mut value = |axis: &Axis, mapping: Mapping, end: f64| {
        mapping.value(rng.range(mapping.coordinate(axis.domain[0]), mapping.coordinate(end)))
    };
    (0..count)
        .map(|i| {
            let views = if i % 2 == 0 { Mapping::Linear } else { theta.mapping };
            let [theta, phi] = [value(theta, views, theta_max), value(phi, phi.mapping, phi.domain[1])];
            let [alpha, lambda] = [alpha, lambda].map(|axis| value(axis, axis.mapping, axis.domain[1]));
            Query { theta, phi, alpha_x: alpha, alpha_y: alpha * lambda }
        })
        .collect()
}

/// Whether a query belongs to the draw that magnitude and Fresnel are judged by, or is just beyond its ends.
pub(crate) fn is_judged(query: &Query) -> bool {
    let (alpha, lambda) = (query.alpha_x, query.alpha_y / query.alpha_x);
    alpha >= 0.0095 && lambda >= 0.048 && query.theta <= (ALBEDO_THETA_MAX_DEGREES + 0.1).to_radians()
}

fn one(
    rng: &mut SplitMix64,
    isotropic: bool,
    alpha_min: f64,
    lambda_min: f64,
    theta_max_degrees: f64,
) -> Query {
    let even = rng.unit() < 0.5;
    let alpha = if even { rng.range(alpha_min, 1.0) } else { rng.range(alpha_min.sqrt(), 1.0).powi(2) };
    let lambda = rng.range(lambda_min, 1.0);
    let theta = rng.range(0.0, theta_max_degrees.to_radians());
    let phi = rng.range(0.0, TAU);
    let lambda = if isotropic { 1.0 } else { lambda };
    Query { theta, phi, alpha_x: alpha, alpha_y: alpha * lambda }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn queries_over_the_axes_are_even_in_their_coordinates() {
        let axes = crate::FitSpec::preset("ggx-anisotropic-closed-form").unwrap().axes;
        let queries = over(&mut SplitMix64::new(1), 20_000, &axes);
        assert_eq!(queries.len(), 20_000);
        assert!(queries.iter().all(|q| q.validate().is_ok() && q.theta <= 89.51_f64.to_radians()));
        // Each of seven cells holds a seventh; a standard deviation is √(20,000/7 · 6/7) = 49.
        for (axis, value) in [
            (&axes[1], (|q| q.phi) as fn(&Query) -> f64),
            (&axes[2], |q| q.alpha_x),
            (&axes[3], |q| q.alpha_y / q.alpha_x),
        ] {
            let mut counts = [0_i32; 7];
            queries.iter().for_each(|q| counts[axis.locate(value(q)).0] += 1);
            assert!(counts.iter().all(|count| (count - 2857).abs() < 250), "{:?}: {counts:?}", axis.quantity);
        }
        let below = |odd: usize| queries.iter().skip(odd).step_by(2).filter(|q| q.theta < 0.7).count() as f64;
        assert!((below(0) / 1e4 - 0.7 / 89.5_f64.to_radians()).abs() < 0.02);
        assert!((below(1) / 1e4 - 0.35_f64.tan() / 44.75_f64.to_radians().tan()).abs() < 0.02);
        assert!(over(&mut SplitMix64::new(1), 9, &axes[..2]).is_empty());
    }

    #[test]
    fn the_draw_covers_what_it_says() {
        let queries = standard(20_000, 1, false);
        let mean = |f: &dyn Fn(&Query) -> f64| queries.iter().map(f).sum::<f64>() / 20_000.0;
        // E α = ½·0.505 + ½·E U² with U ~ U[0.1, 1]: (1 − 0.001)/(3·0.9).
        assert!((mean(&|q| q.alpha_x) - 0.5 * (0.505 + 0.37)).abs() < 5e-3);
        assert!((mean(&|q| q.alpha_y / q.alpha_x) - 0.525).abs() < 5e-3);
        assert!((mean(&|q| q.theta.to_degrees()) - 43.0).abs() < 0.5);
        assert!((mean(&|q| q.phi) - TAU / 2.0).abs() < 0.03);
        assert!(queries.iter().all(|q| q.validate().is_ok() && q.alpha_x >= 0.01 && q.alpha_y <= q.alpha_x));
        assert!(standard(10, 1, true).iter().all(|q| q.alpha_x == q.alpha_y));
        assert_ne!(standard(1, 1, false), standard(1, 2, false));
    }
}
