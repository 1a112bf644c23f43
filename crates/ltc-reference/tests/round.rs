//! Lobes over ellipses, spheres and cylinders: textbook form factors, Monte Carlo, and planted errors.

mod common;

use std::f64::consts::PI;

use glam::{DVec3, dvec3};
use ltc_reference::{
    AboveHorizon, CosineLobe, CylinderShape, Lobe, LtcLobe, PolygonOptions, ReferenceError, SplitMix64,
    Tolerance, integrate_cylinder, integrate_ellipse, integrate_polygon, integrate_sphere_light,
};

const TOLERANCE: Tolerance = Tolerance { absolute: 1e-10, relative: 0.0, max_evaluations: 20_000_000 };
const ONE_SIDED: PolygonOptions = PolygonOptions { two_sided: false, tolerance: TOLERANCE };
const TWO_SIDED: PolygonOptions = PolygonOptions { two_sided: true, tolerance: TOLERANCE };

fn ellipse(lobe: &impl Lobe, [centre, u, v]: [DVec3; 3], options: PolygonOptions) -> f64 {
    integrate_ellipse(lobe, centre, u, v, options).expect("the oracle converges on valid input").value
}

fn sphere(lobe: &impl Lobe, centre: DVec3, radius: f64) -> f64 {
    integrate_sphere_light(lobe, centre, radius, TOLERANCE)
        .expect("the oracle converges on valid input")
        .value
}

fn cylinder(lobe: &impl Lobe, shape: CylinderShape) -> f64 {
    integrate_cylinder(lobe, shape, TOLERANCE).expect("the oracle converges on valid input").value
}

#[test]
fn textbook_factor_of_a_parallel_disk() {
    for (r, d) in [(1.0_f64, 1.0_f64), (1e-3, 1.0), (1e3, 1.0), (1.0, 1e-7)] {
        let exact = r * r / (r * r + d * d);
        let disk = [dvec3(0.0, 0.0, d), DVec3::Y * r, DVec3::X * r];
        let value = ellipse(&CosineLobe, disk, ONE_SIDED);
        assert!((value - exact).abs() < 1e-9, "{r} {d}: {value} {exact}");
        // From behind it is dark, and in any conjugate axes the same.
        assert_eq!(ellipse(&CosineLobe, [disk[0], disk[2], disk[1]], ONE_SIDED), 0.0);
        let turned = [disk[0], (disk[1] + disk[2]) * 0.5_f64.sqrt(), (disk[2] - disk[1]) * 0.5_f64.sqrt()];
        assert!((ellipse(&CosineLobe, turned, ONE_SIDED) - exact).abs() < 1e-9);
    }
    // Negative control: a disk larger by a thousandth, a lobe without its cosine.
    let larger = [DVec3::Z, DVec3::Y * 1.001, DVec3::X * 1.001];
    assert!((ellipse(&CosineLobe, larger, ONE_SIDED) - 0.5).abs() > 1e-4);
    let flat = ellipse(&|_: DVec3| 1.0 / PI, [DVec3::Z, DVec3::Y, DVec3::X], ONE_SIDED);
    assert!((flat - 0.5).abs() > 1e-2, "{flat}");
}

#[test]
fn solid_angles() {
    let one = |_: DVec3| 1.0;
    // A cap's is 2π (1 − cos σ).
    for (d, r) in [(2.0_f64, 1.0_f64), (1.001, 1.0), (1e3, 1.0)] {
        let exact = 2.0 * PI * (r / d).powi(2) / (1.0 + (1.0 - (r / d).powi(2)).sqrt());
        let value = sphere(&one, dvec3(0.6, 0.0, -0.8) * d, r);
        assert!((value - exact).abs() < 1e-9, "{d} {r}: {value} {exact}");
    }
    assert!((sphere(&one, DVec3::X * 0.3, 1.0) - 4.0 * PI).abs() < 1e-8);
    // A long tube with the shading point beside its middle fills a lune of angle 2 asin(r/d), less its ends.
    let ends = [dvec3(2.0, 0.0, -1e5), dvec3(2.0, 0.0, 1e5)];
    let tube = cylinder(&one, CylinderShape { ends, radius: 1.0, caps: false });
    assert!((tube - 4.0 * 0.5_f64.asin()).abs() < 1e-4, "{tube}");
    // A closed solid and all that is beside it: a cylinder's silhouette does not depend on which end comes first.
    let mut random = SplitMix64::new(3);
    for _ in 0..10 {
        let mut direction = || ltc_reference::sphere_direction(random.next_2d());
        let (p, q) = (direction() * 3.0, direction() * 2.0);
        let forth = cylinder(&one, CylinderShape { ends: [p, q], radius: 0.3, caps: true });
        let back = cylinder(&one, CylinderShape { ends: [q, p], radius: 0.3, caps: true });
        assert!((forth - back).abs() < 1e-9, "{forth} {back}");
    }
}

/// Lambert's sphere above the horizon: (r/d)² cos θ; half of one on the horizon by symmetry less than half.
#[test]
fn horizons_cut_spheres() {
    let above = sphere(&CosineLobe, dvec3(0.0, 3.0, 4.0), 2.0);
    assert!((above - 0.16 * 0.8).abs() < 1e-10, "{above}");
    let (high, low) =
        (sphere(&CosineLobe, dvec3(2.0, 0.0, 0.3), 1.0), sphere(&CosineLobe, dvec3(2.0, 0.0, -0.3), 1.0));
    // Cutting forgotten, the signed cosine would give ±(r/d)² cos θ: their difference is what both parts have in common.
    let signed = 0.3 / dvec3(2.0, 0.0, 0.3).length().powi(3);
    assert!((high - low - signed).abs() < 1e-9, "{high} {low} {signed}");
    // Negative control: without the cut the value is another one.
    let uncut = sphere(&|w: DVec3| w.z / PI, dvec3(2.0, 0.0, 0.3), 1.0);
    assert!((uncut - high).abs() > 1e-3);
}

/// Distance along the ray to the first hit of a solid cylinder or sphere-like shape, by marching: no formula in common.
fn hits(w: DVec3, inside: impl Fn(DVec3) -> bool) -> bool {
    (1..4000).any(|i| inside(w * (f64::from(i) * 0.0015)))
}

#[test]
fn samples_of_the_lobe_hit_the_lights_as_often_as_integrated() {
    let mut random = SplitMix64::new(17);
    let mut told_apart = 0;
    for case in 0..12 {
        let ltc = common::ltc(&mut random, 6.0);
        let mut directions = (0..1000).map(|_| ltc.sample(random.next_2d()));
        let Some(towards) = directions.find(|w| w.z > 0.3) else { continue };
        let frame = common::rotation(&mut random);
        let lobe = AboveHorizon(ltc);
        let centre = towards * 2.0;
        let (radius, half) = (0.5, 0.6);
        let in_cylinder = |p: DVec3| {
            let offset = p - centre;
            let height = offset.dot(frame.z_axis);
            height.abs() < half && (offset - frame.z_axis * height).length() < radius
        };
        let in_sphere = |p: DVec3| p.distance(centre) < radius;
        // A thin box of an ellipse: 0.002 thick, thinner than its area shows.
        let in_disk = |p: DVec3| {
            let offset = p - centre;
            let (x, y) = (offset.dot(frame.x_axis) / 0.8, offset.dot(frame.y_axis) / 0.5);
            offset.dot(frame.z_axis).abs() < 1e-3 && x * x + y * y < 1.0
        };
        let n = 4000;
        let count = |inside: &dyn Fn(DVec3) -> bool, random: &mut SplitMix64| {
            let hit = |_: &i32| {
                let w = ltc.sample(random.next_2d());
                w.z > 0.0 && hits(w, inside)
            };
            (0..n).filter(hit).count() as f64 / f64::from(n)
        };
        let ends = [centre - frame.z_axis * half, centre + frame.z_axis * half];
        let shape = CylinderShape { ends, radius, caps: true };
        let axes = [centre, frame.x_axis * 0.8, frame.y_axis * 0.5];
        let (value, fraction) = match case % 3 {
            0 => (cylinder(&lobe, shape), count(&in_cylinder, &mut random)),
            1 => (sphere(&lobe, centre, radius), count(&in_sphere, &mut random)),
            _ => (ellipse(&lobe, axes, TWO_SIDED), count(&in_disk, &mut random)),
        };
        let sigma = (value * (1.0 - value) / f64::from(n)).sqrt().max(1.0 / f64::from(n));
        assert!((value - fraction).abs() < 5.0 * sigma + 5e-3, "{case}: {value} {fraction} ± {sigma}");
        let transposed = LtcLobe::new(ltc.target_from_cosine().transpose()).expect("still invertible");
        let wrong = match case % 3 {
            0 => cylinder(&AboveHorizon(transposed), shape),
            1 => sphere(&AboveHorizon(transposed), centre, radius),
            _ => ellipse(&AboveHorizon(transposed), axes, TWO_SIDED),
        };
        told_apart += usize::from((wrong - fraction).abs() > 5.0 * sigma + 5e-3);
    }
    assert!(told_apart > 5, "the transposed matrix must be told apart: {told_apart}");
}

/// The crate's other area integral: a polygon of 1024 corners with the ellipse's area.
#[test]
fn an_ellipse_is_the_limit_of_polygons() {
    let mut random = SplitMix64::new(23);
    for _ in 0..6 {
        let lobe = AboveHorizon(common::ltc(&mut random, 20.0));
        let frame = common::rotation(&mut random);
        let centre = ltc_reference::sphere_direction(random.next_2d()) * 1.5;
        let (u, v) = (frame.x_axis, frame.y_axis * 0.4);
        let n = 1024;
        let step = std::f64::consts::TAU / f64::from(n);
        let fit = (step / step.sin()).sqrt();
        let corners: Vec<DVec3> = (0..n)
            .map(|i| (f64::from(i) * step).sin_cos())
            .map(|(sin, cos)| centre + (u * cos + v * sin) * fit)
            .collect();
        let options = PolygonOptions { two_sided: true, tolerance: Tolerance::absolute(1e-6) };
        let polygon = integrate_polygon(&lobe, &corners, options).expect("the oracle converges").value;
        let value = ellipse(&lobe, [centre, u, v], TWO_SIDED);
        assert!((polygon - value).abs() < 2e-4, "{polygon} {value}");
    }
}

#[test]
fn degenerate_lights_give_zero_and_invalid_ones_an_error() {
    assert_eq!(ellipse(&CosineLobe, [DVec3::Z, DVec3::X, DVec3::X], TWO_SIDED), 0.0);
    assert_eq!(ellipse(&CosineLobe, [DVec3::X, DVec3::X, DVec3::Z], TWO_SIDED), 0.0);
    assert_eq!(sphere(&CosineLobe, DVec3::Z, 0.0), 0.0);
    let ends = [DVec3::Z, DVec3::Z * 2.0];
    for shape in [
        CylinderShape { ends, radius: 0.0, caps: true },
        CylinderShape { ends: [DVec3::Z; 2], radius: 1.0, caps: true },
        // In line with a tube, and inside of one.
        CylinderShape { ends, radius: 0.5, caps: false },
        CylinderShape { ends: [-DVec3::Z, DVec3::Z], radius: 0.5, caps: false },
    ] {
        assert_eq!(cylinder(&CosineLobe, shape), 0.0, "{shape:?}");
    }
    let closed = CylinderShape { ends: [-DVec3::Z, DVec3::Z], radius: 0.5, caps: true };
    assert!((cylinder(&CosineLobe, closed) - 1.0).abs() < 1e-8);
    let bad = dvec3(0.0, f64::NAN, 1.0);
    let refused = [
        integrate_ellipse(&CosineLobe, bad, DVec3::X, DVec3::Y, ONE_SIDED),
        integrate_sphere_light(&CosineLobe, bad, 1.0, TOLERANCE),
        integrate_cylinder(&CosineLobe, CylinderShape { ends: [bad, DVec3::Z], ..closed }, TOLERANCE),
    ];
    for result in refused {
        assert!(matches!(result, Err(ReferenceError::NonFiniteInput { .. })), "{result:?}");
    }
}
