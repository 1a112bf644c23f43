//! The closed forms against the one-dimensional integrals that define them.

use glam::{DMat3, DVec3};
use ltc_core::{Horizon, Light, Line, LineCylinder, Sides, Strip};
use ltc_reference::{
    CosineLobe, Lobe, ThinCylinder, ThinStrip, Tolerance, integrate_line, integrate_strip_line, point_cap,
};

use crate::draw::{Cut, Draw, HORIZONS, ltc};

const TOLERANCE: f64 = 1e-9;

fn oracle_tolerance() -> Tolerance {
    Tolerance { relative: 1e-12, ..Tolerance::absolute(1e-11) }
}

/// The defining integral of a line, before it is clamped.
fn line_by_quadrature(lobe: &impl Lobe, [p0, p1]: [DVec3; 2], radius: f64) -> f64 {
    integrate_line(lobe, &ThinCylinder { p0, p1, radius }, oracle_tolerance()).expect("converges").value
}

fn line([p0, p1]: [DVec3; 2], radius: f64) -> Line<f64> {
    Line::new(p0, p1, radius).unwrap()
}

/// A matrix of one of several conditions, a light that its lobe sees more often than not, and the horizons to cut it by.
fn draw_case(draw: &mut Draw, case: usize) -> (DMat3, [DVec3; 2], Horizon) {
    let condition = [1.0, 3.0, 10.0, 100.0, 1000.0][case % 5];
    let matrix = if case.is_multiple_of(2) { draw.matrix(condition) } else { draw.lobe_matrix(condition) };
    let ends = if case.is_multiple_of(3) { draw.ends() } else { draw.aimed_ends(matrix) };
    (matrix, ends, HORIZONS[case / 10 % 4])
}

/// Counts cases that say something, and the worst of all.
#[derive(Default)]
struct Record {
    worst: f64,
    lit: usize,
    clamped: usize,
}

impl Record {
    fn add(&mut self, got: f64, unclamped: f64, case: &dyn std::fmt::Debug) {
        let expected = unclamped.clamp(0.0, 1.0);
        let difference = (got - expected).abs();
        assert!(difference < TOLERANCE, "{got} is not {expected}: {case:?}");
        self.worst = self.worst.max(difference);
        self.lit += usize::from(expected > 1e-3 && expected < 1.0);
        self.clamped += usize::from(unclamped > 1.0);
    }
}

#[test]
fn lines_match_equation_1_6() {
    let mut draw = Draw::new(1);
    let mut record = Record::default();
    for case in 0..4000 {
        let (matrix, ends, horizon) = draw_case(&mut draw, case);
        let radius = draw.log_range(1e-4, 1.0);
        let expected = line_by_quadrature(&Cut::new(matrix, horizon), ends, radius);
        let got = line(ends, radius).integrate_within(&ltc(matrix), horizon);
        record.add(got, expected, &(case, horizon, ends, radius));
    }
    println!("lines: worst {:.1e}", record.worst);
    assert!(record.lit > 1000 && record.clamped > 20, "too few: {} {}", record.lit, record.clamped);
}

#[test]
fn strips_match_equation_1_35_corrected() {
    let mut draw = Draw::new(2);
    let mut record = Record::default();
    for case in 0..4000 {
        let (matrix, [p0, p1], horizon) = draw_case(&mut draw, case);
        let width = draw.log_range(1e-4, 1.0);
        let normal = draw.across(p1 - p0);
        let two_sided = case % 7 < 3;
        let sides = if two_sided { Sides::Two } else { Sides::One };
        let strip = Strip::<f64>::new(p0, p1, width, normal * 3.0, sides).unwrap();
        let light = ThinStrip { p0, p1, width, normal, two_sided };
        let expected = integrate_strip_line(&Cut::new(matrix, horizon), &light, oracle_tolerance());
        let got = strip.integrate_within(&ltc(matrix), horizon);
        record.add(got, expected.expect("converges").value, &(case, horizon, light));
    }
    println!("strips: worst {:.1e}", record.worst);
    assert!(record.lit > 600 && record.clamped > 5, "too few: {} {}", record.lit, record.clamped);
}

#[test]
fn capped_lines_match_equations_1_6_and_1_33() {
    let mut draw = Draw::new(3);
    let mut record = Record::default();
    let mut capped = 0;
    for case in 0..2000 {
        let (matrix, ends, horizon) = draw_case(&mut draw, case);
        let radius = draw.log_range(1e-3, 0.3);
        let axis = ends[1] - ends[0];
        // A cap that the horizon cuts is no point: it has a test of its own.
        if horizon.surface && ends.iter().any(|p| p.z.abs() < radius) {
            continue;
        }
        let lobe = Cut::new(matrix, horizon);
        let wall = line_by_quadrature(&lobe, ends, radius);
        let caps = point_cap(&lobe, ends[0], axis, radius) + point_cap(&lobe, ends[1], -axis, radius);
        let light = LineCylinder::<f64>::new(ends[0], ends[1], radius).unwrap();
        let got = light.with_caps(true).integrate_within(&ltc(matrix), horizon);
        record.add(got, wall + caps, &(case, horizon, ends, radius));
        let open = light.integrate_within(&ltc(matrix), horizon);
        record.add(open, wall, &(case, horizon, ends, radius));
        capped += usize::from(caps > 1e-3);
    }
    assert!(capped > 100, "too few caps say anything: {capped}");
}

#[test]
fn irradiance_is_the_diffuse_integral() {
    let mut draw = Draw::new(4);
    for _ in 0..500 {
        let ends = draw.ends();
        let radius = draw.log_range(1e-3, 1.0);
        let expected = line_by_quadrature(&CosineLobe, ends, radius).clamp(0.0, 1.0);
        let got = line(ends, radius).irradiance();
        assert!((got - expected).abs() < TOLERANCE, "{ends:?} {radius}: {got} {expected}");
    }
}

/// Lines that pass the shading point at a millionth of their length, lie on a ray but for as little, are 1e6 lengths away, or
/// are 1e5 times as long as they are distant or thick.
#[test]
fn extreme_lines_match_too() {
    let mut draw = Draw::new(5);
    let mut record = Record::default();
    for case in 0..3000 {
        let matrix = draw.lobe_matrix([1.0, 10.0, 100.0][case % 3]);
        let along = if case % 2 == 0 { draw.direction() } else { draw.aim(matrix) };
        let across = draw.across(along);
        let near = draw.log_range(1e-6, 1e-2);
        let (ends, radius) = match case % 4 {
            0 => (
                [across * near - along * draw.unit(), across * near + along * draw.unit()],
                near * draw.unit(),
            ),
            1 => (
                [across * near + along * 0.1, across * near + along * draw.range(0.2, 1.0)],
                draw.range(1.0, 1e4),
            ),
            2 => {
                let centre = along * draw.log_range(1e3, 1e6);
                ([centre - across * draw.unit(), centre + across * draw.unit()], draw.range(1.0, 1e6))
            }
            _ => {
                ([across - along * draw.log_range(1.0, 1e5), across + along * draw.log_range(1.0, 1e5)], 0.5)
            }
        };
        let scale = draw.log_range(1e-6, 1e6);
        let expected = line_by_quadrature(&Cut::new(matrix, Horizon::BOTH), ends, radius);
        // What nearly cancels in the input is at the mercy of its own rounding when scaled: powers of two round nothing.
        let scale = 2.0f64.powi(scale.log2() as i32);
        let got = line(ends.map(|p| p * scale), radius * scale).integrate(&ltc(matrix));
        record.add(got, expected, &(case, ends, radius));
    }
    println!("extreme: worst {:.1e}, lit {}, clamped {}", record.worst, record.lit, record.clamped);
    assert!(record.lit > 800, "too few: {}", record.lit);
}
