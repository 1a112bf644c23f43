//! Degenerate and extreme configurations, each with its defined answer.

use glam::{DMat3, DVec3, Mat3, Vec3, dvec3, vec3};
use ltc_core::points::SplitMix64;
use ltc_core::{Horizon, InputError, Light, Line, LineCylinder, Ltc, Sides, Strip};

use crate::draw::{HORIZONS, ltc};

fn lobe() -> Ltc<f64> {
    ltc(DMat3::from_cols(dvec3(0.4, 0.1, 0.0), dvec3(0.0, 0.3, -0.1), dvec3(0.3, 0.2, 0.9)))
}

/// The value of an open line, after seeing that caps and horizons do not change it.
fn dark(p0: DVec3, p1: DVec3, radius: f64) {
    for horizon in HORIZONS {
        let light = LineCylinder::<f64>::new(p0, p1, radius).unwrap();
        assert_eq!(light.integrate_within(&lobe(), horizon), 0.0, "{p0} {p1} {radius} {horizon:?}");
        for sides in [Sides::One, Sides::Two] {
            if let Ok(strip) = Strip::<f64>::new(p0, p1, radius, dvec3(0.3, -0.8, 0.2), sides) {
                assert_eq!(strip.integrate_within(&lobe(), horizon), 0.0, "{p0} {p1} {radius} {horizon:?}");
            }
        }
    }
}

fn line(p0: DVec3, p1: DVec3, radius: f64) -> f64 {
    Line::<f64>::new(p0, p1, radius).unwrap().integrate(&lobe())
}

const A: DVec3 = dvec3(-0.5, 0.2, 1.0);
const B: DVec3 = dvec3(0.7, 0.4, 0.8);

#[test]
fn zero_length_zero_radius() {
    dark(A, A, 0.1);
    dark(DVec3::ZERO, DVec3::ZERO, 0.1);
    dark(A, B, 0.0);
}

#[test]
fn ends_on_one_ray_and_line_through_the_shading_point() {
    dark(A, A * 2.0, 0.1);
    dark(A * 0.25, A * 4.0, 1e6);
    dark(A, -A, 0.1);
    dark(A * 2.0, A * -0.5, 1e-9);
    dark(DVec3::ZERO, A, 0.1);
}

#[test]
fn a_line_that_points_at_the_shading_point_shows_its_cap_alone() {
    let light = LineCylinder::<f64>::new(A, A * 2.0, 0.1).unwrap();
    assert_eq!(light.integrate(&lobe()), 0.0);
    let expected = 0.01 * std::f64::consts::PI * lobe().density(A / A.length()) / A.length_squared();
    assert!((light.with_caps(true).integrate(&lobe()) - expected).abs() < 1e-15);
}

#[test]
fn in_the_horizon_and_below_it() {
    let flat = |p: DVec3| p * dvec3(1.0, 1.0, 0.0);
    for horizon in [Horizon::BOTH, Horizon::SURFACE] {
        for (p0, p1) in [(flat(A), flat(B)), (flat(A), -B), (-A, -B), (-A, flat(B))] {
            let light = Line::<f64>::new(p0, p1, 0.1).unwrap();
            assert_eq!(light.integrate_within(&lobe(), horizon), 0.0, "{p0} {p1}");
            let closed = LineCylinder::<f64>::new(p0 - DVec3::Z, p1 - DVec3::Z, 0.1).unwrap().with_caps(true);
            assert_eq!(closed.integrate_within(&lobe(), horizon), 0.0);
        }
    }
    // Where the surface does not cut, the lobe does: here it leaks.
    let wide = ltc(DMat3::from_rotation_y(1.2));
    let light = Line::<f64>::new(dvec3(1.0, -1.0, -0.3), dvec3(1.0, 1.0, -0.3), 0.1).unwrap();
    assert!(light.integrate_within(&wide, Horizon::COSINE) > 0.01);
    assert_eq!(light.integrate(&wide), 0.0);
}

#[test]
fn strips_behind_and_edge_on() {
    let towards = {
        let axis = (B - A).normalize_or_zero();
        -(A - axis * A.dot(axis)).normalize_or_zero()
    };
    let strip = |normal, sides| Strip::<f64>::new(A, B, 0.1, normal, sides).unwrap().integrate(&lobe());
    assert!(strip(towards, Sides::One) > 0.01);
    assert_eq!(strip(-towards, Sides::One), 0.0);
    assert_eq!(strip(-towards, Sides::Two), strip(towards, Sides::One));
    for sides in [Sides::One, Sides::Two] {
        assert_eq!(strip(A.cross(B), sides), 0.0);
        // A normal that is a thousand times as long along the line as across loses three digits.
        assert!(strip(A.cross(B) * -1e-3 + (B - A), sides) < 1e-13);
    }
}

#[test]
fn a_thick_line_is_clamped_and_one_around_the_shading_point_is_bright() {
    for radius in [10.0, 1e10, 1e300] {
        assert_eq!(line(A, B, radius), 1.0);
    }
    // Closer than its radius, in front of the lobe: the line's formula without bound, hence 1; behind the horizon 0.
    for d in [1e-3, 1e-8, 1e-100] {
        assert_eq!(line(dvec3(-1.0, 0.0, d), dvec3(1.0, 0.0, d), 0.01), 1.0, "{d}");
        assert_eq!(line(dvec3(-1.0, 0.0, -d), dvec3(1.0, 0.0, -d), 0.01), 0.0, "{d}");
    }
}

/// A line of finite radius-to-distance ratio keeps its value as it comes nearer, for as long as it is much longer than distant.
#[test]
fn closeness_alone_does_not_matter() {
    let value = |d: f64| line(dvec3(-1.0, 0.1 * d, d), dvec3(1.0, 0.1 * d, d), 0.1 * d);
    let limit = value(1e-9);
    assert!(limit > 0.05 && limit < 1.0);
    for d in [1e-6, 1e-12, 1e-30, 1e-100, 1e-200] {
        assert!((value(d) - limit).abs() < 1e-5, "{d}: {} {limit}", value(d));
    }
    let value = |d: f32| {
        let light = Line::<f32>::new(vec3(-1.0, 0.1 * d, d), vec3(1.0, 0.1 * d, d), 0.1 * d).unwrap();
        let m = lobe().target_from_base().as_mat3();
        f64::from(light.integrate(&Ltc::<f32>::new(m).unwrap()))
    };
    for d in [1e-6, 1e-12, 1e-20, 1e-30] {
        assert!((value(d) - limit).abs() < 1e-5, "{d}: {} {limit}", value(d));
    }
}

#[test]
fn scales_from_1e_minus_30_to_1e30_in_single_precision() {
    let m = lobe().target_from_base().as_mat3();
    let lobe = Ltc::<f32>::new(m).unwrap();
    let value = |scale: f32| {
        let light = Line::<f32>::new(A.as_vec3() * scale, B.as_vec3() * scale, 0.05 * scale).unwrap();
        light.integrate(&lobe)
    };
    for scale in [1e-36, 1e-30, 1e-6, 1e6, 1e30, 1e38] {
        assert!((value(scale) - value(1.0)).abs() < 1e-6, "{scale}");
    }
}

#[test]
fn view_parallel_to_the_normal_gives_a_lobe_like_any_other() {
    let upright = ltc(DMat3::from_diagonal(dvec3(0.2, 0.2, 1.0)));
    let light = |angle: f64| {
        let turn = DMat3::from_rotation_z(angle);
        Line::<f64>::new(turn * A, turn * B, 0.01).unwrap().integrate(&upright)
    };
    assert!(light(0.0) > 0.0 && (light(0.0) - light(2.0)).abs() < 1e-14);
}

#[test]
fn what_is_no_light_is_refused() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let p = dvec3(0.0, bad, 1.0);
        for error in [
            Line::<f64>::new(p, B, 0.1).unwrap_err(),
            Line::<f64>::new(A, p, 0.1).unwrap_err(),
            Line::<f64>::new(A, B, bad).unwrap_err(),
            LineCylinder::<f64>::new(A, p, 0.1).unwrap_err(),
            Strip::<f64>::new(A, p, 0.1, DVec3::Z, Sides::One).unwrap_err(),
            Strip::<f64>::new(A, B, bad, DVec3::Z, Sides::One).unwrap_err(),
            Strip::<f64>::new(A, B, 0.1, p, Sides::One).unwrap_err(),
        ] {
            assert!(matches!(error, InputError::NotFinite { .. }), "{error}");
        }
    }
    let negative = Line::<f64>::new(A, B, -0.1).unwrap_err();
    assert!(matches!(negative, InputError::OutOfRange { name: "radius", .. }), "{negative}");
    let negative = Strip::<f64>::new(A, B, -0.1, DVec3::Z, Sides::One).unwrap_err();
    assert!(matches!(negative, InputError::OutOfRange { name: "width", .. }), "{negative}");
    for normal in [DVec3::ZERO, B - A, (A - B) * 1e-9] {
        let error = Strip::<f64>::new(A, B, 0.1, normal, Sides::One).unwrap_err();
        assert!(matches!(error, InputError::Degenerate { .. }), "{normal}: {error}");
    }
}

/// Numbers at the limits of f32, and such as make products cancel.
fn awkward(random: &mut SplitMix64) -> f32 {
    const SPECIAL: [f32; 16] = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        1e-38,
        -1e-38,
        1e-45,
        3e38,
        -3e38,
        1e19,
        1e-19,
        0.5,
        1.0 + f32::EPSILON,
        1e-7,
        1e6,
        -1e-6,
    ];
    match random.bits() % 4 {
        0 => SPECIAL[(random.bits() % 16) as usize],
        1 => 10f32.powf(random.range(-38.0, 38.0) as f32),
        _ => random.range(-1.0, 1.0) as f32,
    }
}

#[test]
fn no_input_makes_a_nan_or_leaves_the_unit_interval() {
    let mut random = SplitMix64::new(99);
    let (mut lit, mut lobes) = (0, 0);
    for case in 0..200_000 {
        let r = &mut random;
        let mut vector = || vec3(awkward(r), awkward(r), awkward(r));
        let (p0, mut p1, normal) = (vector(), vector(), vector());
        if case % 5 == 0 {
            p1 = p0 * [2.0, -1.0, 1.0, 3.0, -1e-3][case / 5 % 5];
        }
        let m = Mat3::from_cols(vector(), vector(), vector());
        let Ok(lobe) = Ltc::<f32>::new(m) else { continue };
        let width = awkward(r).abs();
        let narrow = all_values(p0, p1, width, normal, &lobe);
        let wide = Ltc::<f64>::new(m.as_dmat3()).unwrap();
        let wide = all_values_f64(p0.as_dvec3(), p1.as_dvec3(), f64::from(width), normal.as_dvec3(), &wide);
        for value in narrow.into_iter().map(f64::from).chain(wide) {
            assert!((0.0..=1.0).contains(&value), "{case}: {value} {p0} {p1} {width} {normal} {m:?}");
            lit += usize::from(value > 0.0);
        }
        lobes += 1;
    }
    assert!(lit > 50_000 && lobes > 30_000, "{lit} {lobes}");
}

fn all_values(p0: Vec3, p1: Vec3, width: f32, normal: Vec3, lobe: &Ltc<f32>) -> Vec<f32> {
    let lines = LineCylinder::<f32>::new(p0, p1, width).into_iter().flat_map(|l| [l, l.with_caps(true)]);
    let mut values: Vec<f32> =
        lines.flat_map(|light| HORIZONS.map(|h| light.integrate_within(lobe, h))).collect();
    let strips = Strip::<f32>::new(p0, p1, width, normal, Sides::Two).into_iter();
    values.extend(strips.flat_map(|light| HORIZONS.map(|h| light.integrate_within(lobe, h))));
    values
}

fn all_values_f64(p0: DVec3, p1: DVec3, width: f64, normal: DVec3, lobe: &Ltc<f64>) -> Vec<f64> {
    let lines = LineCylinder::<f64>::new(p0, p1, width).into_iter().flat_map(|l| [l, l.with_caps(true)]);
    let mut values: Vec<f64> =
        lines.flat_map(|light| HORIZONS.map(|h| light.integrate_within(lobe, h))).collect();
    let strips = Strip::<f64>::new(p0, p1, width, normal, Sides::Two).into_iter();
    values.extend(strips.flat_map(|light| HORIZONS.map(|h| light.integrate_within(lobe, h))));
    values
}
