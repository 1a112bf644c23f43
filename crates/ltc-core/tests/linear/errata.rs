//! The errata of the 2017 chapter: each printed formula is wrong, each corrected one right.
//!
//! Listing 1.5 types `p2` as `float`: that is for a compiler to find.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::{DVec3, dvec3};
use ltc_core::{Light, Line, LineCylinder, Sides, Strip};
use ltc_reference::{
    CosineLobe, Lobe, ThinCylinder, ThinStrip, Tolerance, integrate_1d, integrate_cap,
    integrate_cylinder_wall, integrate_line, integrate_strip_area, point_cap,
};

const P0: DVec3 = dvec3(-0.4, 0.3, 1.1);
const P1: DVec3 = dvec3(0.9, 0.7, 0.6);

fn tolerance() -> Tolerance {
    Tolerance { relative: 1e-8, ..Tolerance::absolute(1e-13) }
}

fn tangent() -> DVec3 {
    (P1 - P0).normalize_or_zero()
}

/// The unit vector from the shading point to the line's nearest point.
fn towards_line() -> DVec3 {
    (P0 - tangent() * P0.dot(tangent())).normalize_or_zero()
}

/// Eq. 1.6 over the unit length as it stands: Gauss-Legendre in l.
fn i_line() -> f64 {
    let f = |l: f64| {
        let p = P0 + tangent() * l;
        let w = p / p.length();
        CosineLobe.density(w) * 2.0 * w.cross(tangent()).length() / p.length_squared()
    };
    integrate_1d(f, 0.0, (P1 - P0).length(), tolerance()).expect("smooth").value
}

/// `I_line` of eq. 1.21, with the functions of eq. 1.22 and 1.23 given.
fn by_antiderivatives(fpo: impl Fn(f64, f64) -> f64, fwt: impl Fn(f64, f64) -> f64) -> f64 {
    let (l0, l1) = (P0.dot(tangent()), P1.dot(tangent()));
    let foot = P0 - tangent() * l0;
    let d = foot.length();
    ((fpo(d, l1) - fpo(d, l0)) * foot.z + (fwt(d, l1) - fwt(d, l0)) * tangent().z) / PI
}

#[test]
fn equations_1_21_to_1_23_are_right_and_what_the_line_computes() {
    let fpo = |d: f64, l: f64| l / (d * (d * d + l * l)) + (l / d).atan() / (d * d);
    let fwt = |d: f64, l: f64| l * l / (d * (d * d + l * l));
    let corrected = by_antiderivatives(fpo, fwt);
    assert!((corrected - i_line()).abs() < 1e-12);
    let radius = 0.01;
    let light = Line::<f64>::new(P0, P1, radius).unwrap();
    assert!((light.irradiance() - radius * corrected).abs() < 1e-14);
}

#[test]
fn listing_1_6_prints_the_digit_one_for_the_letter_l() {
    let printed = by_antiderivatives(
        |d, l| 1.0 / (d * (d * d + 1.0 * 1.0)) + (l / d).atan() / (d * d),
        |d, l| l * l / (d * (d * d + 1.0 * 1.0)),
    );
    assert!((printed - i_line()).abs() > 0.05 * i_line(), "{printed}");
    // Only the numerator mended is still wrong.
    let half = by_antiderivatives(
        |d, l| l / (d * (d * d + 1.0 * 1.0)) + (l / d).atan() / (d * d),
        |d, l| l * l / (d * (d * d + 1.0 * 1.0)),
    );
    assert!((half - i_line()).abs() > 0.01 * i_line(), "{half}");
}

fn thin_strip(normal: DVec3, width: f64) -> f64 {
    let light = ThinStrip { p0: P0, p1: P1, width, normal, two_sided: true };
    integrate_strip_area(&CosineLobe, &light, tolerance()).expect("converges").value / width
}

#[test]
fn equation_1_35_takes_the_wrong_vector() {
    let (u, across) = (towards_line(), P0.cross(P1).normalize_or_zero());
    for angle in [0.0, 0.4, 1.0, 1.5] {
        let normal = -u * f64::cos(angle) + across * f64::sin(angle);
        let truth = thin_strip(normal, 1e-4);
        // The strip's width is half of it on either side: I_line counts a cylinder's diameter.
        let printed = 0.5 * across.dot(normal).abs() * i_line();
        let corrected = 0.5 * normal.dot(u).abs() * i_line();
        assert!((corrected - truth).abs() < 1e-7, "{angle}: {corrected} {truth}");
        assert!((printed - truth).abs() > 0.05 * i_line(), "{angle}: {printed} {truth}");
        // The same factor by the width axis b instead of the normal.
        let b = tangent().cross(normal);
        assert!((across.dot(b).abs() - normal.dot(u).abs()).abs() < 1e-12);
        let light = Strip::<f64>::new(P0, P1, 1e-4, normal, Sides::Two).unwrap();
        assert!((light.irradiance() - 1e-4 * corrected).abs() < 1e-13);
    }
    // It vanishes for a strip that faces the point.
    assert!(across.dot(-u).abs() < 1e-12 && thin_strip(-u, 1e-4) > 0.2 * i_line());
}

#[test]
fn listing_1_11_would_make_a_strip_twice_as_bright() {
    let truth = thin_strip(-towards_line(), 1e-4);
    assert!((i_line() / truth - 2.0).abs() < 1e-6, "{}", i_line() / truth);
}

/// Eq. 1.2 over R for one radius, literally: over all of the wall, with what `front` makes of −ω_p · ω_n.
fn wall_per_radius(radius: f64, front: impl Fn(f64) -> f64 + Copy) -> f64 {
    let (e1, e2) = tangent().any_orthonormal_pair();
    let ring = |l: f64| {
        let f = |phi: f64| {
            let normal = e1 * phi.cos() + e2 * phi.sin();
            let p = P0 + tangent() * l + normal * radius;
            CosineLobe.density(p / p.length()) * front(-p.dot(normal) / p.length()) / p.length_squared()
        };
        // Cut near where the front ends.
        let towards = (-towards_line()).dot(e2).atan2((-towards_line()).dot(e1));
        let tolerance = Tolerance::absolute(1e-7);
        let quarter = |k: f64| {
            integrate_1d(f, towards + k * FRAC_PI_2, towards + (k + 1.0) * FRAC_PI_2, tolerance)
                .expect("bounded")
                .value
        };
        (-2..2).map(|k| quarter(f64::from(k))).sum::<f64>()
    };
    integrate_1d(ring, 0.0, (P1 - P0).length(), Tolerance::absolute(1e-5)).expect("smooth").value
}

/// New: MATHS.md did not have this one.
#[test]
fn equation_1_2_counts_the_far_side_of_the_cylinder_too() {
    let radius = 1e-3;
    let printed = wall_per_radius(radius, f64::abs);
    let corrected = wall_per_radius(radius, |x| x.max(0.0));
    assert!((printed / i_line() - 2.0).abs() < 1e-2, "{}", printed / i_line());
    // Eq. 1.9 holds with max(0, ·), as Listing 1.2 has it.
    assert!((corrected / i_line() - 1.0).abs() < 1e-2, "{}", corrected / i_line());
    let light = ThinCylinder { p0: P0, p1: P1, radius };
    let oracle = integrate_cylinder_wall(&CosineLobe, &light, tolerance()).expect("converges").value / radius;
    assert!((corrected - oracle).abs() < 1e-4, "{corrected} {oracle}");
}

#[test]
fn equation_1_29_lights_caps_from_behind() {
    // The point sees this cylinder from between its end planes: neither cap shows.
    let radius = 0.05;
    let seen: f64 = [(P0, tangent()), (P1, -tangent())]
        .map(|(p, inward)| {
            integrate_cap(&CosineLobe, p, inward, radius, tolerance()).expect("converges").value
        })
        .iter()
        .sum();
    assert_eq!(seen, 0.0);
    let printed = |p: DVec3| {
        PI * radius * radius * CosineLobe.density(p / p.length()) * (p.dot(tangent()) / p.length()).abs()
            / p.length_squared()
    };
    assert!(printed(P0) + printed(P1) > 5e-4, "{}", printed(P0) + printed(P1));
    let light = LineCylinder::<f64>::new(P0, P1, radius).unwrap();
    assert_eq!(light.with_caps(true).irradiance(), light.irradiance());
}

/// New: "we simply add I_disk1 + I_disk2 to I_line of Equation 1.6" must read R · I_line (eq. 1.10), as the caps are in
/// units of R² and I_line is per R.
#[test]
fn the_text_of_section_1_5_3_adds_caps_to_a_line_without_its_radius() {
    let (p0, p1, radius) = (P1, P1 + (P1 - P0), 0.01);
    let light = ThinCylinder { p0, p1, radius };
    let wall = integrate_cylinder_wall(&CosineLobe, &light, tolerance()).expect("converges").value;
    let cap = integrate_cap(&CosineLobe, p0, p1 - p0, radius, tolerance()).expect("converges").value;
    let per_radius = integrate_line(&CosineLobe, &light, tolerance()).expect("converges").value / radius;
    let points = point_cap(&CosineLobe, p0, p1 - p0, radius);
    let (printed, corrected) = (per_radius + points, radius * per_radius + points);
    assert!((corrected - wall - cap).abs() < 0.02 * (wall + cap), "{corrected} {wall} {cap}");
    assert!(printed > 50.0 * (wall + cap), "{printed} {wall} {cap}");
    let closed = LineCylinder::<f64>::new(p0, p1, radius).unwrap().with_caps(true);
    assert!((closed.irradiance() - corrected).abs() < 1e-12);
}

/// Listings 1.2, 1.4 and 1.8 place samples at j/(n − 1) and weigh each by 1/n.
#[test]
fn the_numerical_listings_weigh_their_ends_too_much() {
    let length = (P1 - P0).length();
    let f = |l: f64| {
        let p = P0 + tangent() * l;
        let w = p / p.length();
        2.0 * CosineLobe.density(w) * w.cross(tangent()).length() / p.length_squared()
    };
    let n = 100;
    let printed: f64 =
        (0..n).map(|j| f(length * f64::from(j) / f64::from(n - 1))).sum::<f64>() * length / f64::from(n);
    let corrected: f64 =
        (0..n).map(|j| f(length * (f64::from(j) + 0.5) / f64::from(n))).sum::<f64>() * length / f64::from(n);
    assert!((printed / i_line() - 1.0).abs() > 1e-3, "{printed}");
    assert!((corrected / i_line() - 1.0).abs() < 1e-4, "{corrected}");
}
