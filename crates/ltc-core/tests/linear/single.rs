//! f32 against f64 on the same numbers.

use glam::{DMat3, DVec3, Mat3, Vec3};
use ltc_core::{Light, Line, LineCylinder, Ltc, Sides, Strip};

use crate::draw::{Draw, HORIZONS};

/// One scene in both precisions: f32 numbers, and the same widened.
struct Both {
    narrow: Ltc<f32>,
    wide: Ltc<f64>,
    ends: [Vec3; 2],
    width: f32,
}

impl Both {
    fn new(matrix: DMat3, ends: [DVec3; 2], width: f64) -> Self {
        let m: Mat3 = matrix.as_mat3();
        let (narrow, wide) = (Ltc::<f32>::new(m).unwrap(), Ltc::<f64>::new(m.as_dmat3()).unwrap());
        Self { narrow, wide, ends: ends.map(DVec3::as_vec3), width: width as f32 }
    }

    /// The largest difference of all lights and horizons; and the largest value.
    fn difference(&self, normal: DVec3) -> (f64, f64) {
        let ([a, b], n) = (self.ends, normal.as_vec3());
        let (wide_a, wide_b, width) = (a.as_dvec3(), b.as_dvec3(), f64::from(self.width));
        let line = Line::<f32>::new(a, b, self.width).unwrap();
        let wide_line = Line::<f64>::new(wide_a, wide_b, width).unwrap();
        let capped = LineCylinder::<f32>::new(a, b, self.width).unwrap().with_caps(true);
        let wide_capped = LineCylinder::<f64>::new(wide_a, wide_b, width).unwrap().with_caps(true);
        let strip = Strip::<f32>::new(a, b, self.width, n, Sides::Two);
        let wide_strip = Strip::<f64>::new(wide_a, wide_b, width, n.as_dvec3(), Sides::Two);
        let (mut worst, mut largest) = (0.0f64, 0.0f64);
        let mut compare = |narrow: f32, wide: f64| {
            worst = worst.max((f64::from(narrow) - wide).abs());
            largest = largest.max(wide);
        };
        for h in HORIZONS {
            compare(line.integrate_within(&self.narrow, h), wide_line.integrate_within(&self.wide, h));
            compare(capped.integrate_within(&self.narrow, h), wide_capped.integrate_within(&self.wide, h));
            if let (Ok(strip), Ok(wide_strip)) = (&strip, &wide_strip) {
                compare(strip.integrate_within(&self.narrow, h), wide_strip.integrate_within(&self.wide, h));
            }
        }
        (worst, largest)
    }
}

/// Distance of the segment's nearest point.
fn nearest([a, b]: [DVec3; 2]) -> f64 {
    let t = (-a.dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
    (a + (b - a) * t).length()
}

fn bound(condition: f64) -> f64 {
    1e-4 * (condition / 100.0).max(1.0)
}

/// Lights no thicker than they are distant (beyond, the error grows with the square of that ratio). Ends up to 1e3 times nearer or farther than the line is long, lines passing the point as near as that.
#[test]
fn f32_stays_within_its_bound() {
    let mut draw = Draw::new(5);
    for condition in [1.0, 10.0, 100.0, 1e3, 1e4, 1e5] {
        let (mut worst, mut bright) = (0.0f64, 0);
        for case in 0..20_000 {
            let matrix = if case % 2 == 0 { draw.matrix(condition) } else { draw.lobe_matrix(condition) };
            let scale = draw.log_range(1e-6, 1e6);
            let along = draw.direction();
            let ends = match case % 3 {
                // Far or near, anyhow.
                0 => {
                    let aimed = if case % 2 == 0 { draw.direction() } else { draw.aim(matrix) };
                    let centre = aimed * draw.log_range(1e-3, 1e3);
                    [centre - along * 0.5, centre + along * 0.5]
                }
                // Passing close by.
                1 => {
                    let foot = draw.across(along) * draw.log_range(1e-3, 1.0);
                    [foot - along * draw.unit(), foot + along * draw.unit()]
                }
                // Nearly on a ray.
                _ => {
                    let foot = draw.across(along) * draw.log_range(1e-3, 1.0);
                    let start = draw.log_range(1e-3, 1.0);
                    [foot + along * start, foot + along * (start + draw.unit())]
                }
            };
            let ends = ends.map(|p| p * scale);
            let width = nearest(ends) * draw.log_range(1e-4, 1.0);
            let normal = draw.direction();
            let (difference, largest) = Both::new(matrix, ends, width).difference(normal);
            worst = worst.max(difference);
            bright += usize::from(largest > 0.01);
            assert!(
                difference < bound(condition),
                "case {case}, condition {condition}: {difference:e}, {matrix:?} {ends:?} {width}"
            );
        }
        println!(
            "condition {condition:e}: worst {worst:.2e}, bound {:.0e}, bright {bright}",
            bound(condition)
        );
        assert!(bright > 1000, "too few cases say anything: {bright}");
    }
}
