//! Lobes over lines, thin cylinders and strips: against the formulas as they are printed, other routes, and samples.

mod common;

use glam::{DMat3, DVec3, dvec3};
use ltc_reference::{
    AboveHorizon, CosineLobe, GaussLegendre, Lobe, LtcLobe, PolygonOptions, ReferenceError, SplitMix64,
    ThinCylinder, ThinStrip, Tolerance, integrate_cap, integrate_cylinder_wall, integrate_line,
    integrate_polygon, integrate_strip_area, integrate_strip_line, sphere_direction,
};

fn value(result: Result<ltc_reference::Estimate, ReferenceError>) -> f64 {
    result.expect("the oracle converges on valid input").value
}

/// A cylinder about 1 away from the origin, which is outside of it, anywhere.
fn cylinder(random: &mut SplitMix64) -> ThinCylinder {
    let towards = sphere_direction(random.next_2d());
    cylinder_at(random, towards)
}

/// The same with one end in a direction.
fn cylinder_at(random: &mut SplitMix64, p0: DVec3) -> ThinCylinder {
    loop {
        let axis = sphere_direction(random.next_2d());
        let p1 = p0 + axis * common::log_uniform(random, 0.1, 3.0);
        let radius = common::log_uniform(random, 0.01, 0.3);
        let distance = (p0 - axis * p0.dot(axis)).length();
        if distance > 1.2 * radius {
            return ThinCylinder { p0, p1, radius };
        }
    }
}

/// A lobe that is smooth all over the sphere.
fn smooth(w: DVec3) -> f64 {
    (1.0 + 0.5 * w.z + w.x * w.y).powi(2)
}

#[test]
fn lines_are_equation_1_6_as_printed() {
    let mut random = SplitMix64::new(1);
    let rule = GaussLegendre::new(400);
    let mut planted = 0.0f64;
    for _ in 0..50 {
        let light = cylinder(&mut random);
        let axis = (light.p1 - light.p0).normalize_or_zero();
        let printed = |sine_power: i32| {
            let integrand = |l: f64| {
                let p = light.p0 + l * axis;
                let w = p / p.length();
                smooth(w) * 2.0 * w.cross(axis).length().powi(sine_power) / p.length_squared()
            };
            light.radius * rule.integrate(0.0, (light.p1 - light.p0).length(), integrand)
        };
        let got = value(integrate_line(&smooth, &light, Tolerance::absolute(1e-11)));
        assert!((got - printed(1)).abs() < 1e-8, "{light:?}: {got} {}", printed(1));
        // Negative control: the other definition of a linear light, without the sine (footnote 1 of the chapter).
        planted = planted.max((got - printed(0)).abs());
    }
    assert!(planted > 0.1, "{planted}");
}

#[test]
fn walls_are_equation_1_2_over_the_front() {
    let mut random = SplitMix64::new(2);
    let (along, around) = (GaussLegendre::new(200), 20_000);
    for _ in 0..4 {
        let light = cylinder(&mut random);
        let axis = (light.p1 - light.p0).normalize_or_zero();
        let (e1, e2) = axis.any_orthonormal_pair();
        let mut front = 0.0;
        for i in 0..around {
            let phi = std::f64::consts::TAU * f64::from(i) / f64::from(around);
            let normal = e1 * phi.cos() + e2 * phi.sin();
            let start = light.p0 + normal * light.radius;
            if start.dot(normal) < 0.0 {
                front += along.integrate(0.0, (light.p1 - light.p0).length(), |l| {
                    let p = start + axis * l;
                    smooth(p / p.length()) * -p.dot(normal) / p.length().powi(3)
                });
            }
        }
        let printed = light.radius * front * std::f64::consts::TAU / f64::from(around);
        let got = value(integrate_cylinder_wall(&smooth, &light, Tolerance::absolute(1e-9)));
        assert!((got - printed).abs() < 1e-6, "{light:?}: {got} {printed}");
    }
}

#[test]
fn strips_are_polygons() {
    let mut random = SplitMix64::new(3);
    let (mut lit, mut planted) = (0, 0.0f64);
    for case in 0..40 {
        let ltc = common::ltc(&mut random, 10.0);
        let towards = ltc.sample(random.next_2d());
        let ThinCylinder { p0, p1, radius } = cylinder_at(&mut random, towards);
        let axis = (p1 - p0).normalize_or_zero();
        let normal = axis.cross(sphere_direction(random.next_2d())).normalize_or_zero();
        let (width, two_sided) = (2.0 * radius, case % 2 == 0);
        let across = normal.cross(axis) * radius;
        // Counter-clockwise seen from where the normal points to.
        let corners = [p0 - across, p1 - across, p1 + across, p0 + across];
        let options = PolygonOptions { two_sided, tolerance: Tolerance::absolute(1e-8) };
        let light = ThinStrip { p0, p1, width, normal: normal * 3.0, two_sided };
        let tolerance = Tolerance::absolute(1e-8);
        let polygon = value(integrate_polygon(&AboveHorizon(ltc), &corners, options));
        let got = value(integrate_strip_area(&AboveHorizon(ltc), &light, tolerance));
        assert!((got - polygon).abs() < 1e-6, "{case}: {got} {polygon} {light:?}");
        lit += usize::from(polygon > 1e-3);
        // Negative control: the transposed matrix is another lobe.
        let transposed = LtcLobe::new(ltc.target_from_cosine().transpose()).expect("invertible");
        let wrong = value(integrate_strip_area(&AboveHorizon(transposed), &light, tolerance));
        planted = planted.max((wrong - polygon).abs());
    }
    assert!(lit > 8 && planted > 0.01, "{lit} {planted}");
}

/// Whether a ray from the origin meets a cylinder: its wall, or, if closed, the cap that faces the origin.
fn hits(light: &ThinCylinder, closed: bool, w: DVec3) -> bool {
    let axis = (light.p1 - light.p0).normalize_or_zero();
    let across = |v: DVec3| v - axis * v.dot(axis);
    let (d, foot) = (across(w), across(light.p0));
    let within =
        |p: DVec3| (0.0..=1.0).contains(&((p - light.p0).dot(axis) / (light.p1 - light.p0).length()));
    let (a, b, c) = (d.length_squared(), d.dot(foot), foot.length_squared() - light.radius.powi(2));
    let discriminant = b * b - a * c;
    let wall = discriminant > 0.0 && {
        let t = (b - discriminant.sqrt()) / a;
        t > 0.0 && within(w * t)
    };
    let cap = |centre: DVec3| {
        let t = centre.dot(axis) / w.dot(axis);
        t > 0.0 && (w * t - centre).length() < light.radius
    };
    wall || closed && (light.p0.dot(axis) > 0.0 && cap(light.p0) || light.p1.dot(axis) < 0.0 && cap(light.p1))
}

#[test]
fn samples_of_the_lobe_hit_cylinders_as_often_as_integrated() {
    let mut random = SplitMix64::new(4);
    let (mut capped, mut told_apart) = (0, 0);
    for case in 0..60 {
        let ltc = common::ltc(&mut random, 5.0);
        let towards = ltc.sample(random.next_2d());
        let light = cylinder_at(&mut random, towards);
        let light = ThinCylinder { radius: light.radius.max(0.1), ..light };
        let axis = light.p1 - light.p0;
        let tolerance = Tolerance::absolute(1e-5);
        let wall = value(integrate_cylinder_wall(&ltc, &light, tolerance));
        let caps = [(light.p0, axis), (light.p1, -axis)]
            .map(|(centre, inward)| value(integrate_cap(&ltc, centre, inward, light.radius, tolerance)));
        let closed = wall + caps[0] + caps[1];
        let n = 40_000;
        let count = |closed| (0..n).filter(|_| hits(&light, closed, ltc.sample(random.next_2d()))).count();
        let [open_hits, closed_hits] = [false, true].map(count).map(|hits| hits as f64 / f64::from(n));
        let sigma = |p: f64| (p * (1.0 - p) / f64::from(n)).sqrt().max(1.0 / f64::from(n));
        assert!((wall - open_hits).abs() < 5.0 * sigma(wall), "{case}: {wall} {open_hits} {light:?}");
        assert!(
            (closed - closed_hits).abs() < 5.0 * sigma(closed),
            "{case}: {closed} {closed_hits} {light:?}"
        );
        capped += usize::from(closed - wall > 10.0 * sigma(closed));
        // Negative control: a quarter more radius.
        let thick = ThinCylinder { radius: 1.25 * light.radius, ..light };
        told_apart += usize::from(
            (value(integrate_cylinder_wall(&ltc, &thick, tolerance)) - open_hits).abs() > 5.0 * sigma(wall),
        );
    }
    assert!(capped > 5 && told_apart > 15, "{capped} {told_apart}");
}

#[test]
fn the_tolerance_is_kept_over_decades() {
    let mut random = SplitMix64::new(5);
    for _ in 0..20 {
        let ltc = common::ltc(&mut random, 100.0);
        let light = cylinder(&mut random);
        let line = |tolerance| value(integrate_line(&ltc, &light, Tolerance::absolute(tolerance)));
        let wall = |tolerance| value(integrate_cylinder_wall(&ltc, &light, Tolerance::absolute(tolerance)));
        let (exact_line, exact_wall) = (line(1e-13), wall(1e-9));
        for tolerance in [1e-4, 1e-6, 1e-8] {
            assert!((line(tolerance) - exact_line).abs() <= tolerance, "{tolerance} {light:?}");
            assert!((wall(tolerance) - exact_wall).abs() <= tolerance + 1e-9, "{tolerance} {light:?}");
        }
    }
}

#[test]
fn the_horizon_cuts() {
    // A vertical line, its lower half below the ground: the cosine sees the upper half alone.
    let half = |low: f64| {
        let light = ThinCylinder { p0: dvec3(1.0, 0.0, low), p1: dvec3(1.0, 0.0, 1.0), radius: 0.1 };
        value(integrate_line(&CosineLobe, &light, Tolerance::absolute(1e-12)))
    };
    // R (2/π) ∫ z / (1 + z²)² dz from 0 to 1.
    let exact = 0.1 * 2.0 / std::f64::consts::PI * 0.25;
    assert!((half(0.0) - exact).abs() < 1e-12 && (half(-1.0) - exact).abs() < 1e-12);
    // Negative control: the same lobe without a horizon.
    let light = ThinCylinder { p0: dvec3(1.0, 0.0, -1.0), p1: dvec3(1.0, 0.0, 1.0), radius: 0.1 };
    let everywhere = |w: DVec3| w.z.abs() / std::f64::consts::PI;
    let both = value(integrate_line(&everywhere, &light, Tolerance::absolute(1e-9)));
    assert!((both - 2.0 * exact).abs() < 1e-8, "{both}");
}

#[test]
fn degenerate_lights_give_zero_and_invalid_ones_an_error() {
    let tolerance = Tolerance::default();
    let (a, b) = (dvec3(0.3, 0.1, 1.0), dvec3(0.5, -0.4, 2.0));
    for (p0, p1, radius) in
        [(a, a, 0.1), (a, b, 0.0), (a, b, -0.1), (DVec3::Z, 2.0 * DVec3::Z, 0.1), (-a, -b, 0.1)]
    {
        let light = ThinCylinder { p0, p1, radius };
        assert_eq!(value(integrate_line(&CosineLobe, &light, tolerance)), 0.0, "{light:?}");
        assert_eq!(value(integrate_cylinder_wall(&CosineLobe, &light, tolerance)), 0.0, "{light:?}");
        let light =
            ThinStrip { p0, p1, width: radius, normal: a.cross(dvec3(0.3, 0.9, 0.1)), two_sided: true };
        assert_eq!(value(integrate_strip_line(&CosineLobe, &light, tolerance)), 0.0, "{light:?}");
    }
    // From behind, and from inside.
    let strip = ThinStrip {
        p0: dvec3(-1.0, 0.0, 1.0),
        p1: dvec3(1.0, 0.0, 1.0),
        width: 0.1,
        normal: DVec3::Z,
        two_sided: false,
    };
    assert_eq!(value(integrate_strip_line(&CosineLobe, &strip, tolerance)), 0.0);
    assert_eq!(value(integrate_strip_area(&CosineLobe, &strip, tolerance)), 0.0);
    assert_eq!(value(integrate_cap(&CosineLobe, a, -b, 0.1, tolerance)), 0.0);
    let around = ThinCylinder { p0: dvec3(-1.0, 0.0, 0.1), p1: dvec3(1.0, 0.0, 0.1), radius: 0.2 };
    assert_eq!(value(integrate_cylinder_wall(&CosineLobe, &around, tolerance)), 0.0);
    for bad in [f64::NAN, f64::INFINITY] {
        let light = ThinCylinder { p0: a, p1: b, radius: bad };
        let got = integrate_line(&CosineLobe, &light, tolerance);
        assert!(matches!(got, Err(ReferenceError::NonFiniteInput { .. })), "{got:?}");
        let got = integrate_cap(&CosineLobe, a * bad, b, 0.1, tolerance);
        assert!(matches!(got, Err(ReferenceError::NonFiniteInput { .. })), "{got:?}");
        let got = integrate_strip_area(&CosineLobe, &ThinStrip { width: bad, ..strip }, tolerance);
        assert!(matches!(got, Err(ReferenceError::NonFiniteInput { .. })), "{got:?}");
        let light = ThinCylinder { p0: a, p1: b, radius: 0.1 };
        for got in [
            integrate_line(&|_: DVec3| bad, &light, tolerance),
            integrate_cylinder_wall(&|_: DVec3| bad, &light, tolerance),
        ] {
            assert!(matches!(got, Err(ReferenceError::NonFiniteIntegrand { .. })), "{got:?}");
        }
    }
    let identity = LtcLobe::new(DMat3::IDENTITY).expect("invertible");
    let hopeless = Tolerance { max_evaluations: 20, ..Tolerance::absolute(1e-15) };
    let ragged = |w: DVec3| identity.density(w) * f64::from((40.0 * w.x).sin() > 0.0);
    let got = integrate_line(&ragged, &ThinCylinder { p0: a, p1: -b + DVec3::Z, radius: 0.1 }, hopeless);
    assert!(matches!(got, Err(ReferenceError::NotConverged { .. })), "{got:?}");
}
