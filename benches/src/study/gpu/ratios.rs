//! What is asked of one form beside another, turn by turn: what slows the device down falls on both.

use super::super::timer::quotients;
use super::super::{Interval, Record};
use super::bench::{Bench, Measure};
use super::{LEAST, YARDSTICK};

/// A ratio's name, what is above and what is below, and what it may be.
type Asked = (&'static str, &'static str, &'static str, Option<f64>);

const RATIOS: &[Asked] = &[
    // The workspace's own demands; the 2022 paper has 0.610 ms over 0.160 ms for the first, the 2017 chapter 0.72 for the second.
    (
        "anisotropic_over_isotropic_lookup",
        "compute/lookup/anisotropic/texture_f32",
        "compute/lookup/isotropic/texture_f32",
        Some(1.5),
    ),
    // Materials whose widths do not change from pixel to pixel.
    (
        "anisotropic_baked_over_isotropic_lookup",
        "compute/lookup/anisotropic_baked/texture_f32",
        "compute/lookup/isotropic/texture_f32",
        Some(1.5),
    ),
    // Materials whose widths do: all but their ratio is interpolated by the texture unit, as the isotropic table is.
    (
        "anisotropic_refined_over_isotropic_lookup",
        "compute/lookup/anisotropic/refined_f32",
        "compute/lookup/isotropic/filtered_f32",
        Some(1.5),
    ),
    (
        "anisotropic_refined_over_isotropic_lookup_f16",
        "compute/lookup/anisotropic/refined_f16",
        "compute/lookup/isotropic/filtered_f16",
        Some(1.5),
    ),
    ("line_over_quad", "compute/integral/line/exact", "compute/integral/quad/exact", Some(0.5)),
    ("quad_over_published", "compute/integral/quad/exact", "compute/integral/quad/published_2016", Some(1.0)),
    ("lean_line_over_lean_quad", "compute/integral/line/lean", "compute/integral/quad/lean", Some(0.5)),
    (
        "lean_quad_over_published",
        "compute/integral/quad/lean",
        "compute/integral/quad/published_2016",
        Some(1.0),
    ),
    // What explains them. A software driver does not jump over branches that no pixel takes: lean lights are what is left of the
    // careful ones on hardware where neighbours go the same way.
    (
        "anisotropic_over_isotropic_lookup_f16",
        "compute/lookup/anisotropic/texture_f16",
        "compute/lookup/isotropic/texture_f16",
        None,
    ),
    (
        "anisotropic_over_isotropic_lookup_buffer",
        "compute/lookup/anisotropic/buffer_f32",
        "compute/lookup/isotropic/buffer_f32",
        None,
    ),
    (
        "anisotropic_over_isotropic_lookup_filtered",
        "compute/lookup/anisotropic/filtered_f16",
        "compute/lookup/isotropic/filtered_f16",
        None,
    ),
    (
        "anisotropic_baked_over_isotropic_lookup_filtered",
        "compute/lookup/anisotropic_baked/filtered_f16",
        "compute/lookup/isotropic/filtered_f16",
        None,
    ),
    (
        "published_anisotropic_over_published_isotropic_lookup",
        "compute/lookup/anisotropic/published_2022",
        "compute/lookup/isotropic/published_2016",
        None,
    ),
    (
        "anisotropic_lookup_over_published",
        "compute/lookup/anisotropic/texture_f32",
        "compute/lookup/anisotropic/published_2022",
        None,
    ),
    (
        "filtered_anisotropic_lookup_over_published",
        "compute/lookup/anisotropic/filtered_f16",
        "compute/lookup/anisotropic/published_2022",
        None,
    ),
    (
        "isotropic_lookup_over_published",
        "compute/lookup/isotropic/texture_f32",
        "compute/lookup/isotropic/published_2016",
        None,
    ),
    (
        "filtered_isotropic_lookup_over_published",
        "compute/lookup/isotropic/filtered_f16",
        "compute/lookup/isotropic/published_2016",
        None,
    ),
    (
        "isotropic_through_anisotropic",
        "compute/lookup/isotropic_through_anisotropic/texture_f32",
        "compute/lookup/isotropic/texture_f32",
        None,
    ),
    (
        "scattered_over_smooth_lookup",
        "compute/lookup/anisotropic_scattered/texture_f32",
        "compute/lookup/anisotropic/texture_f32",
        None,
    ),
    (
        "arithmetic_of_isotropic_lookup",
        "compute/lookup/isotropic/arithmetic_alone",
        "compute/lookup/isotropic/buffer_f32",
        None,
    ),
    (
        "arithmetic_of_anisotropic_lookup",
        "compute/lookup/anisotropic/arithmetic_alone",
        "compute/lookup/anisotropic/buffer_f32",
        None,
    ),
    ("lean_line_over_published", "compute/integral/line/lean", "compute/integral/line/published_2017", None),
    ("line_over_published", "compute/integral/line/exact", "compute/integral/line/published_2017", None),
    (
        "quad_of_one_horizon_over_published",
        "compute/integral/quad/cosine_horizon_alone",
        "compute/integral/quad/published_2016",
        None,
    ),
    ("proxy_over_quad", "compute/integral/quad/published_proxy", "compute/integral/quad/exact", None),
    (
        "rational_over_exact_edges",
        "compute/integral/quad/rational_edges",
        "compute/integral/quad/exact",
        None,
    ),
    ("horizons_of_quad", "compute/integral/quad/exact", "compute/integral/quad/no_horizon", None),
    (
        "all_kinds_present_over_one",
        "compute/integral/quad/all_kinds_present",
        "compute/integral/quad/exact",
        None,
    ),
    ("fragment_over_compute_quad", "fragment/integral/quad/exact", "compute/integral/quad/exact", None),
    (
        "fragment_over_compute_lookup",
        "fragment/lookup/isotropic/texture_f32",
        "compute/lookup/isotropic/texture_f32",
        None,
    ),
    (
        "shade_over_published_isotropic",
        "compute/shade/isotropic/01_lights",
        "compute/shade/published_2016/01_lights",
        None,
    ),
    (
        "shade_over_published_anisotropic",
        "compute/shade/anisotropic/01_lights",
        "compute/shade/published_2022/01_lights",
        None,
    ),
];

/// Every ratio whose forms were timed, and how far times over the number of lights are from a straight line.
pub fn records(bench: &Bench<'_>, samples: &[Vec<f64>], picture: &str) -> Vec<Record> {
    let times = |name: &str| Some(bench.measure(name)?.nanoseconds(samples));
    let mut records: Vec<Record> = RATIOS
        .iter()
        .filter_map(|(name, above, below, asked)| {
            let of_turns = times(above)?.iter().zip(&times(below)?).map(|(a, b)| a / b).collect();
            let record = Record::new(format!("ratio/gpu/{picture}/{name}"), "ratio");
            Some(record.ratio(Interval::of(of_turns)?, *asked))
        })
        .collect();
    records.extend(linear(bench, samples, picture));
    records
}

/// A straight line through the times over the numbers of lights.
fn linear(bench: &Bench<'_>, samples: &[Vec<f64>], picture: &str) -> Vec<Record> {
    let counted: Vec<(f64, usize)> = bench
        .forms
        .iter()
        .filter_map(|form| {
            let count = form.name.strip_prefix("compute/shade/isotropic/")?.strip_suffix("_lights")?;
            let Measure::Frame(place) = form.measure else { return None };
            Some((count.parse().ok()?, place))
        })
        .collect();
    let turns = counted.iter().map(|(_, place)| samples[*place].len()).min().unwrap_or(0);
    let lines: Vec<Line> = (0..turns)
        .filter_map(|turn| {
            let points: Vec<(f64, f64)> =
                counted.iter().map(|(n, place)| (*n, samples[*place][turn])).collect();
            Line::through(&points)
        })
        .collect();
    let id = |what: &str| format!("gpu/{picture}/compute/shade/isotropic/{what}");
    let of = |value: fn(&Line) -> f64| -> Vec<f64> { lines.iter().map(value).collect() };
    let yardstick = bench.measure(YARDSTICK).map(|measure| measure.nanoseconds(samples));
    let timed = |what: &str, per: &str, times: Vec<f64>| {
        let relative = yardstick.as_ref().and_then(|yardstick| quotients(&times, yardstick));
        Some(Record::new(id(what), per).timed(Interval::of(times)?).relative(relative))
    };
    let worst = Interval::of(of(|line| 1.0 + line.worst)).map(|worst| {
        Record::new(format!("ratio/gpu/{picture}/lights_over_straight_line"), "ratio").ratio(worst, None)
    });
    [
        timed("each_light", "light of a frame", of(|line| line.slope)),
        timed("without_lights", "frame", of(|line| line.intercept)),
        worst,
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// A straight line through points, so that squares of relative deviations are least.
struct Line {
    slope: f64,
    intercept: f64,
    /// The largest relative deviation of a point.
    worst: f64,
}

impl Line {
    /// `None` for fewer than two numbers of lights, or times that are not positive.
    fn through(points: &[(f64, f64)]) -> Option<Self> {
        if points.iter().any(|(_, y)| y.is_nan() || *y <= 0.0) {
            return None;
        }
        let sum = |f: fn(f64) -> f64| points.iter().map(|(x, y)| f(*x) / (y * y)).sum::<f64>();
        let (s, sx, sxx) = (sum(|_| 1.0), sum(|x| x), sum(|x| x * x));
        let (sy, sxy) = points.iter().fold((0.0, 0.0), |(sy, sxy), (x, y)| (sy + 1.0 / y, sxy + x / y));
        let determinant = s * sxx - sx * sx;
        if points.len() < 2 || determinant <= 1e-12 * s * sxx {
            return None;
        }
        let (slope, intercept) = ((s * sxy - sx * sy) / determinant, (sxx * sy - sx * sxy) / determinant);
        let worst = points.iter().map(|(x, y)| ((intercept + slope * x) / y - 1.0).abs()).fold(0.0, f64::max);
        Some(Self { slope: slope.max(LEAST), intercept: intercept.max(LEAST), worst })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_found_and_a_bend_is_seen() {
        let counts = [1.0, 2.0, 4.0, 8.0, 16.0, 64.0];
        let straight: Vec<_> = counts.iter().map(|n| (*n, 30.0 + 7.0 * n)).collect();
        let line = Line::through(&straight).unwrap();
        assert!(
            (line.slope - 7.0).abs() < 1e-9 && (line.intercept - 30.0).abs() < 1e-9 && line.worst < 1e-12
        );
        let bent: Vec<_> = counts.iter().map(|n| (*n, 30.0 + 7.0 * n + 0.05 * n * n)).collect();
        assert!(Line::through(&bent).unwrap().worst > 0.05);
        assert!(Line::through(&[(1.0, 2.0)]).is_none() && Line::through(&[(1.0, 2.0), (1.0, 3.0)]).is_none());
    }

    #[test]
    fn names_of_ratios_are_their_own() {
        let mut names: Vec<&str> = RATIOS.iter().map(|(name, ..)| *name).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), RATIOS.len());
    }
}
