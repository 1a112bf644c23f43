//! The oracle of the stability sweeps against surface quadrature, and a short run of the sweeps against the bounds.

#![expect(clippy::unwrap_used, reason = "a test fails by a panic")]

use glam::{DMat3, DVec3};
use ltc_benches::stability::{Bound, Case, Form, Outcome, Sweep, oracle};
use ltc_core::{AnyLight, Sides, points::SplitMix64};
use ltc_reference::{
    AboveHorizon, CylinderShape, LtcLobe, PolygonOptions, ThinCylinder, ThinStrip, Tolerance,
    integrate_cylinder, integrate_ellipse, integrate_line, integrate_polygon, integrate_sphere_light,
    integrate_strip_line,
};

const TOLERANCE: Tolerance = Tolerance { absolute: 1e-10, relative: 0.0, max_evaluations: 4_000_000 };

/// The same over the light's surface.
fn by_surface(case: &Case) -> f64 {
    let lobe = AboveHorizon(LtcLobe::new(DMat3::from_cols_array(&case.m).transpose()).unwrap());
    let v = |p: &[f64; 3]| DVec3::from_array(*p);
    let two_sided = PolygonOptions { two_sided: true, tolerance: TOLERANCE };
    let estimate = match &case.light {
        AnyLight::Polygon { vertices, .. } => {
            let vertices: Vec<DVec3> = vertices.iter().map(v).collect();
            integrate_polygon(&lobe, &vertices, two_sided)
        }
        AnyLight::Line { p0, p1, radius } => {
            integrate_line(&lobe, &ThinCylinder { p0: v(p0), p1: v(p1), radius: *radius }, TOLERANCE)
        }
        AnyLight::Strip { p0, p1, width, normal, .. } => {
            let axis = (v(p1) - v(p0)).normalize_or_zero();
            let normal = v(normal) - axis * axis.dot(v(normal));
            let strip = ThinStrip { p0: v(p0), p1: v(p1), width: *width, normal, two_sided: true };
            integrate_strip_line(&lobe, &strip, TOLERANCE)
        }
        AnyLight::Cylinder { p0, p1, radius, caps } => {
            let shape = CylinderShape { ends: [v(p0), v(p1)], radius: *radius, caps: *caps };
            integrate_cylinder(&lobe, shape, TOLERANCE)
        }
        AnyLight::Disk { center, normal, radius, .. } => {
            let (x, y) = v(normal).normalize_or(DVec3::Z).any_orthonormal_pair();
            integrate_ellipse(&lobe, v(center), x * *radius, y * *radius, two_sided)
        }
        AnyLight::Ellipse { center, axis_u, axis_v, .. } => {
            integrate_ellipse(&lobe, v(center), v(axis_u), v(axis_v), two_sided)
        }
        AnyLight::Sphere { center, radius } => integrate_sphere_light(&lobe, v(center), *radius, TOLERANCE),
    };
    estimate.unwrap().value.min(1.0)
}

fn cases(form: Form) -> Vec<Case> {
    let mut rng = SplitMix64::new(3);
    let mut cases = Vec::new();
    for (sweep, value, count) in [
        (Sweep::Scale, 1.0, 12),
        (Sweep::Distance, 0.1, 6),
        (Sweep::Elevation, 1.0, 4),
        (Sweep::Farness, 10.0, 4),
    ] {
        cases.extend((0..count).map(|_| sweep.case(value, form, &mut rng)));
    }
    cases
}

#[test]
fn the_oracle_agrees_with_quadrature_over_surfaces() {
    for form in Form::ALL {
        let (mut lit, mut worst) = (0, 0.0_f64);
        for case in cases(form) {
            let (value, expected) = (oracle(&case), by_surface(&case));
            lit += usize::from(expected > 1e-3 && expected < 0.999);
            worst = worst.max((value - expected).abs());
            assert!((value - expected).abs() < 2e-9, "{}: {value}, not {expected}: {case:?}", form.name());
        }
        assert!(lit >= 8, "{}: only {lit} lights tell anything", form.name());
    }
}

/// From inside a sphere or a closed cylinder everything above the surface is seen.
#[test]
fn the_oracle_sees_solids_from_inside() {
    let m = DMat3::from_rotation_y(0.9) * DMat3::from_diagonal(DVec3::new(0.4, 0.3, 1.0));
    let sphere = Case::new(m, AnyLight::Sphere { center: [0.1, 0.2, 0.1], radius: 1.0 }, false);
    let (p0, p1) = ([-1.0, 0.0, -0.2], [1.0, 0.1, 0.3]);
    let cylinder = |caps| Case::new(m, AnyLight::Cylinder { p0, p1, radius: 0.5, caps }, false);
    for case in [sphere, cylinder(true)] {
        let expected = by_surface(&case);
        assert!(expected > 0.5 && expected < 1.0 && (oracle(&case) - expected).abs() < 2e-9, "{case:?}");
    }
    assert_eq!(oracle(&cylinder(false)), 0.0);
}

/// Rounding bends a rectangle, here so that the point is between its two halves. Its outline then crosses itself, with next to
/// nothing inside.
#[test]
fn the_oracle_does_not_take_a_crossed_outline_for_everything() {
    let vertices = vec![
        [1.619157075881958, 0.9043021202087402, 0.9729084968566895],
        [2.0175654888153076, -0.3850133717060089, 2.449030637741089],
        [0.6272194981575012, -1.47629976272583, 1.8711062669754028],
        [0.22881099581718445, -0.18698422610759735, 0.39498427510261536],
    ];
    let case = Case::new(DMat3::IDENTITY, AnyLight::Polygon { vertices, sides: Sides::Two }, false);
    assert!(oracle(&case) < 1e-6, "{}", oracle(&case));
    // The control: right under a light everything is it.
    let vertices = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| [x, y, 1e-7]).to_vec();
    let case = Case::new(DMat3::IDENTITY, AnyLight::Polygon { vertices, sides: Sides::Two }, false);
    assert!(oracle(&case) > 1.0 - 1e-6);
}

/// The control: errors of a few parts in 1e8, planted in the light or in the lobe, are seen.
#[test]
fn the_oracle_tells_a_light_from_a_slightly_other_one() {
    for form in Form::ALL {
        let case = cases(form).into_iter().find(|c| (0.05..0.9).contains(&oracle(c))).unwrap();
        let value = oracle(&case);
        let mut other = case.clone();
        other.m[8] *= 1.0 + 1e-7;
        assert!((oracle(&other) - value).abs() > 1e-9, "{}", form.name());
    }
}

/// A few cases of each of those that the page is made of.
#[test]
fn every_light_keeps_its_bounds_over_every_sweep() {
    for form in Form::ALL {
        let bound = Bound::of(form);
        for sweep in Sweep::ALL {
            let mut brightest = 0.0_f64;
            for value in sweep.values() {
                let outcome = Outcome::of(sweep, value, form, 10);
                brightest = brightest.max(outcome.brightest);
                let name = format!("{}, {} {value:e}", form.name(), sweep.name());
                assert!(outcome.f32_share <= 1.0, "{name}: {outcome:?}");
                assert!(outcome.f64_max <= bound.f64_at_most, "{name}: {outcome:?}");
            }
            assert!(brightest > 1e-6, "{}, {}: all dark", form.name(), sweep.name());
        }
    }
}

/// The control: a value that is off by little more than its bound breaks it.
#[test]
fn a_bound_can_be_broken() {
    let case = cases(Form::Disk).into_iter().find(|c| (0.05..0.9).contains(&oracle(c))).unwrap();
    let AnyLight::Disk { center, normal, radius, .. } = case.light.clone() else { unreachable!() };
    let off = AnyLight::Disk { center, normal, radius: radius * 1.01, sides: Sides::Two };
    let wrong = Case { light: off, ..case.clone() };
    let error = (wrong.fraction::<f64>().unwrap() - oracle(&case)).abs();
    assert!(error > Bound::of(Form::Disk).at(case.condition()), "{error:e}");
}
