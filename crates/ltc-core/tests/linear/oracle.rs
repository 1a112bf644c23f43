//! The closed forms against the one-dimensional integrals that define them.

use glam::{DMat3, DVec3, dvec3};
use ltc_core::{Horizon, Light, Line, LineCylinder, Matrix, Sides, Strip};
use ltc_reference::{ThinCylinder, ThinStrip, Tolerance, integrate_line, integrate_strip_line, point_cap};

use crate::draw::{Cut, Draw, HORIZONS, ltc};

const TOLERANCE: f64 = 1e-9;

fn oracle_tolerance() -> Tolerance {
    Tolerance::absolute(1e-11)
}

/// The defining integral of a line, clamped as eq. 1.11 says.
fn line_by_quadrature(matrix: DMat3, horizon: Horizon, [p0, p1]: [DVec3; 2], radius: f64) -> f64 {
    let lobe = Cut::new(matrix, horizon);
    let light = ThinCylinder { p0, p1, radius };
    integrate_line(&lobe, &light, oracle_tolerance()).expect("converges").value.clamp(0.0, 1.0)
}

fn line(matrix: DMat3, horizon: Horizon, [p0, p1]: [DVec3; 2], radius: f64) -> f64 {
    Line::<f64>::new(p0, p1, radius).unwrap().integrate_within(&ltc(matrix), horizon)
}

#[test]
fn lines_match_their_defining_integral_to_1e9() {
    let mut draw = Draw::new(1);
    let (mut worst, mut seen, mut unclamped) = (0.0f64, 0, 0);
    for case in 0..4000 {
        let condition = [1.0, 3.0, 10.0, 100.0, 1000.0][case % 5];
        let matrix = if case % 2 == 0 { draw.matrix(condition) } else { draw.lobe_matrix(condition) };
        let ends = draw.ends();
        let radius = draw.log_range(1e-4, 1.0);
        let horizon = HORIZONS[case / 10 % 4];
        let expected = line_by_quadrature(matrix, horizon, ends, radius);
        let got = line(matrix, horizon, ends, radius);
        assert!((got - expected).abs() < TOLERANCE, "{case} {horizon:?}: {got} {expected} {ends:?} {radius}");
        worst = worst.max((got - expected).abs());
        seen += usize::from(expected > 1e-4);
        unclamped += usize::from(expected > 1e-4 && expected < 1.0);
    }
    println!("worst {worst:e}, seen {seen}, unclamped {unclamped}");
    assert!(seen > 1000 && unclamped > 800, "too few cases say anything: {seen} {unclamped}");
}
