//! The line approximations against the true cylinder, cap and rectangle that they stand for (eq. 1.2, 1.29 and the
//! area of the strip, by two-dimensional quadrature): they converge, and err otherwise as documented.

use glam::{DMat3, DVec3, dvec3};
use ltc_core::{Horizon, Light, Line, LineCylinder, Sides, Strip};
use ltc_reference::{
    ThinCylinder, ThinStrip, Tolerance, integrate_cap, integrate_cylinder_wall, integrate_strip_area,
};

use crate::draw::{Cut, Draw, ltc};

fn tolerance() -> Tolerance {
    Tolerance { relative: 1e-7, ..Tolerance::absolute(1e-12) }
}

/// Radii and widths of lights about 1 away.
const WIDTHS: [f64; 3] = [1e-2, 1e-3, 1e-4];

/// A light above both horizons, so that nothing is cut and what is compared is smooth.
fn above(draw: &mut Draw) -> (DMat3, [DVec3; 2]) {
    loop {
        let matrix = draw.lobe_matrix(4.0);
        let ends = [draw.aim(matrix) * draw.range(0.7, 2.0), draw.aim(matrix) * draw.range(0.7, 2.0)];
        let row = ltc(matrix).cosine_from_target().row(2);
        let [a, b] = ends;
        let distance = (a - (b - a) * (a.dot(b - a) / (b - a).length_squared())).length();
        let clear = ends.iter().all(|p| p.z > 0.2 && row.dot(*p) > 0.2 * row.length());
        if clear && distance > 0.3 && (b - a).length() > 0.3 {
            return (matrix, ends);
        }
    }
}

/// Relative errors must fall in proportion to the width or faster: to a tenth over a decade, with slack for what the next
/// order adds, until the oracle's own error.
fn converges(errors: &[f64], case: &dyn std::fmt::Debug) {
    for pair in errors.windows(2) {
        assert!(pair[1] < 0.2 * pair[0] || pair[1] < 1e-6, "{errors:?}: {case:?}");
    }
}

#[test]
fn lines_are_the_limit_of_thin_cylinders() {
    let mut draw = Draw::new(11);
    for _ in 0..12 {
        let (matrix, [p0, p1]) = above(&mut draw);
        let lobe = Cut::new(matrix, Horizon::BOTH);
        let errors = WIDTHS.map(|radius| {
            let wall = integrate_cylinder_wall(&lobe, &ThinCylinder { p0, p1, radius }, tolerance());
            let line = Line::<f64>::new(p0, p1, radius).unwrap().integrate(&ltc(matrix));
            (wall.expect("converges").value - line).abs() / line
        });
        converges(&errors, &(matrix, p0, p1));
    }
}

#[test]
fn point_caps_are_the_limit_of_small_disks() {
    let mut draw = Draw::new(12);
    let mut seen = 0;
    for _ in 0..60 {
        let (matrix, [p0, p1]) = above(&mut draw);
        let lobe = Cut::new(matrix, Horizon::BOTH);
        let axis = p1 - p0;
        let errors = WIDTHS.map(|radius| {
            let capped = LineCylinder::<f64>::new(p0, p1, radius).unwrap().with_caps(true);
            let points = capped.integrate(&ltc(matrix)) - capped.with_caps(false).integrate(&ltc(matrix));
            let disks = [(p0, axis), (p1, -axis)].map(|(centre, inward)| {
                integrate_cap(&lobe, centre, inward, radius, tolerance()).expect("converges").value
            });
            let disks = disks[0] + disks[1];
            seen += usize::from(disks > 1e-6);
            if disks > 0.0 { (disks - points).abs() / disks } else { points }
        });
        // The difference of two integrals of some 1e-1 has ten digits left of it at best.
        converges(&errors, &(matrix, p0, p1));
    }
    assert!(seen > 30, "too few caps face the point: {seen}");
}

#[test]
fn strips_are_the_limit_of_thin_rectangles() {
    let mut draw = Draw::new(13);
    for case in 0..12 {
        let (matrix, [p0, p1]) = above(&mut draw);
        let lobe = Cut::new(matrix, Horizon::BOTH);
        // A third of them nearly faces the point, where the printed eq. 1.35 vanishes.
        let axis = (p1 - p0).normalize_or_zero();
        let facing = -(p0 - axis * p0.dot(axis)).normalize_or_zero();
        let normal = if case % 3 == 0 { facing } else { facing + axis.cross(facing) * draw.range(-2.0, 2.0) };
        let errors = WIDTHS.map(|width| {
            let light = ThinStrip { p0, p1, width, normal, two_sided: false };
            let area = integrate_strip_area(&lobe, &light, tolerance()).expect("converges").value;
            let strip = Strip::<f64>::new(p0, p1, width, normal, Sides::One).unwrap().integrate(&ltc(matrix));
            (area - strip).abs() / area
        });
        converges(&errors, &(matrix, p0, p1, normal));
    }
}

/// The largest error of lines that are as thick as `ratio` times their distance, against the true wall, over random lights
/// in the lobe.
fn largest_error(condition: f64, ratio: f64) -> f64 {
    let mut draw = Draw::new(21);
    let mut worst = 0.0f64;
    for _ in 0..25 {
        let matrix = if condition == 1.0 { DMat3::IDENTITY } else { draw.lobe_matrix(condition) };
        let foot = draw.aim(matrix);
        let along = draw.across(foot);
        let (p0, p1) = (foot - along * draw.range(0.0, 2.0), foot + along * draw.range(0.2, 2.0));
        let lobe = Cut::new(matrix, Horizon::BOTH);
        let light = ThinCylinder { p0, p1, radius: ratio };
        let wall = integrate_cylinder_wall(&lobe, &light, Tolerance::absolute(0.02 * ratio * ratio));
        let line = Line::<f64>::new(p0, p1, ratio).unwrap().integrate(&ltc(matrix));
        worst = worst.max((wall.expect("converges").value - line).abs());
    }
    worst
}

/// The table in the documentation of [`Line`], a part of it.
#[test]
fn thick_lines_err_as_documented() {
    let documented = [
        (1.0, 0.01, 4e-5),
        (1.0, 0.1, 4e-3),
        (1.0, 0.3, 4e-2),
        (1.0, 0.9, 0.5),
        (3.0, 0.01, 2e-4),
        (3.0, 0.1, 2e-2),
        (3.0, 0.3, 0.3),
        (10.0, 0.01, 5e-4),
        (10.0, 0.03, 2e-2),
        (10.0, 0.1, 0.3),
    ];
    for (condition, ratio, bound) in documented {
        let worst = largest_error(condition, ratio);
        println!("lobe 1/{condition}, r/d {ratio}: {worst:.1e}");
        assert!(worst < bound && worst > 0.1 * bound, "lobe 1/{condition}, r/d {ratio}: {worst} {bound}");
    }
}

/// The largest error of caps with a radius of `ratio` times their distance, against the true disk, over random caps in the lobe
/// that face the point within 60°.
fn largest_cap_error(condition: f64, ratio: f64) -> f64 {
    let mut draw = Draw::new(22);
    let mut worst = 0.0f64;
    for _ in 0..60 {
        let matrix = if condition == 1.0 { DMat3::IDENTITY } else { draw.lobe_matrix(condition) };
        let p0 = draw.aim(matrix);
        let axis = p0 + draw.across(p0) * draw.range(0.0, 3.0f64.sqrt());
        let lobe = Cut::new(matrix, Horizon::BOTH);
        let disk = integrate_cap(&lobe, p0, axis, ratio, Tolerance::absolute(0.01 * ratio * ratio));
        // Along the line of sight the wall adds nothing.
        let wall = LineCylinder::<f64>::new(p0, p0 + axis, ratio).unwrap();
        let points = wall.with_caps(true).integrate(&ltc(matrix)) - wall.integrate(&ltc(matrix));
        if wall.with_caps(true).integrate(&ltc(matrix)) < 1.0 {
            worst = worst.max((disk.expect("converges").value - points).abs());
        }
    }
    worst
}

/// The table in the documentation of [`LineCylinder`].
#[test]
fn point_caps_err_as_documented() {
    let documented = [
        (1.0, 0.1, 2e-4),
        (1.0, 0.3, 1e-2),
        (3.0, 0.1, 5e-3),
        (3.0, 0.3, 0.2),
        (10.0, 0.1, 0.2),
        (10.0, 0.3, 0.5),
    ];
    for (condition, ratio, bound) in documented {
        let worst = largest_cap_error(condition, ratio);
        println!("cap, lobe 1/{condition}, r/d {ratio}: {worst:.1e}");
        assert!(worst < bound && worst > 0.1 * bound, "lobe 1/{condition}, r/d {ratio}: {worst} {bound}");
    }
}

/// A lobe that goes on below the horizon sees a small cap rise as the disk that it is.
#[test]
fn caps_rise_above_the_horizon_as_disks() {
    let matrix = DMat3::from_rotation_y(1.0);
    let lobe = Cut::new(matrix, Horizon::BOTH);
    let (radius, axis) = (0.01, dvec3(1.0, 0.3, 0.4));
    let whole = LineCylinder::<f64>::new(dvec3(1.0, 0.1, 0.1), dvec3(1.0, 0.1, 0.1) + axis, radius).unwrap();
    let whole = whole.with_caps(true).integrate(&ltc(matrix)) - whole.integrate(&ltc(matrix));
    for step in -11..=11 {
        let p0 = dvec3(1.0, 0.1, 0.1 * radius * f64::from(step));
        let light = LineCylinder::<f64>::new(p0, p0 + axis, radius).unwrap();
        let cap = light.with_caps(true).integrate(&ltc(matrix)) - light.integrate(&ltc(matrix));
        let disk =
            integrate_cap(&lobe, p0, axis, radius, Tolerance::absolute(1e-10)).expect("converges").value;
        assert!((cap - disk).abs() < 0.03 * whole, "{step}: {cap} {disk} {whole}");
    }
}
