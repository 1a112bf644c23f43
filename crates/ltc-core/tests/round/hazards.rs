//! The hazards of MATHS.md that concern round lights, by name, each with its defined answer in both precisions.

use glam::{DMat3, DVec3, Vec3, dvec3};
use ltc_core::{Cylinder, Disk, Ellipse, Horizon, InputError, Ltc, Sides, Sphere};

use super::support::{HORIZONS, Random, Shape, shape};

/// A lobe that is neither round nor upright.
fn tilted() -> DMat3 {
    DMat3::from_cols_array(&[0.5, 0.02, 0.1, 0.05, 0.2, 0.03, -0.4, -0.15, 0.8])
}

/// The same with the entries that f32 has.
fn tilted_f32() -> DMat3 {
    tilted().as_mat3().as_dmat3()
}

/// Both precisions.
fn values(light: &Shape, m: DMat3) -> [f64; 2] {
    [light.exact(m, Horizon::BOTH), light.single(m, Horizon::BOTH)]
}

fn assert_dark(light: &Shape) {
    for m in [DMat3::IDENTITY, tilted()] {
        assert_eq!(values(light, m), [0.0; 2], "{light:?}");
    }
}

/// Where the cone is round, the cubic has a double root and the arcs' artanh and arctan an argument of 0.
#[test]
fn disk_cubic_with_coincident_roots() {
    let mut random = Random::new(1);
    for _ in 0..500 {
        // A sphere's cone is round for Lambert; so is that of a disk on its axis. Nearly so is as hard.
        let towards = random.direction();
        let nearly = random.decades(1e-16, 1e-3);
        let radius = random.decades(1e-3, 1e3);
        let (u, v) = towards.any_orthonormal_pair();
        let round = Shape::Disk { centre: towards, normal: towards, radius };
        let almost = Shape::Ellipse { centre: towards, u: u * radius, v: v * (radius * (1.0 + nearly)) };
        let sine = radius / (1.0 + radius * radius).sqrt();
        let sphere = Shape::Sphere { centre: towards, radius: sine };
        let [a, b, c] = [round, almost, sphere].map(|light| light.exact(DMat3::IDENTITY, Horizon::BOTH));
        // From near its surface a sphere's cone depends on d − r.
        let rounding = 1e-13 + 1e-15 * radius * radius;
        assert!(
            (a - c).abs() < rounding && (a - b).abs() < rounding + nearly,
            "{a} {b} {c}: {towards} {radius}"
        );
        let single = round.single(DMat3::IDENTITY, Horizon::BOTH);
        assert!((single - a).abs() < 1e-5, "{single} {a}");
    }
}

#[test]
fn edge_on_disk() {
    let mut random = Random::new(2);
    for i in 0..4000 {
        let frame = random.rotation();
        let (a, b) = (random.range(-1.0, 1.0), random.range(-1.0, 1.0));
        let (x, y) = (frame.x_axis, frame.y_axis);
        // Inside, on the rim, outside, at the centre: in the plane all are dark, from any side.
        let centre = [x * a * 0.7 + y * b * 0.7, x, x * (3.0 * a) + y * (3.0 * b), DVec3::ZERO][i % 4];
        for light in
            [Shape::Disk { centre, normal: frame.z_axis, radius: 1.0 }, Shape::Ellipse { centre, u: x, v: y }]
        {
            assert_eq!(light.exact(tilted(), Horizon::BOTH), 0.0, "{light:?}");
            // Rounded to f32 it is another light, a hair off the plane: seen as f64 sees that one.
            let rounded = light.rounded();
            let (exact, single) =
                (rounded.exact(tilted_f32(), Horizon::BOTH), light.single(tilted(), Horizon::BOTH));
            assert!((exact - single).abs() < 2e-5, "{exact} {single}: {light:?}");
        }
    }
    // Along the axes rounding leaves the side in no doubt.
    for height in [1e-3, 1e-7, 1e-10, 1e-14] {
        let light = Shape::Disk { centre: dvec3(0.3, 0.2, height), normal: DVec3::Z, radius: 1.0 };
        for value in values(&light, DMat3::IDENTITY) {
            assert!((value - 1.0).abs() < 2.0 * height + 1e-6, "{height}: {value}");
        }
    }
}

#[test]
fn point_inside_a_sphere() {
    let mut random = Random::new(3);
    for _ in 0..200 {
        let m = random.matrix(30.0);
        let up = m.transpose() * DVec3::Z;
        let above = 0.5 * (1.0 + up.z / up.length());
        let centre = random.direction() * random.range(0.0, 0.999);
        let (sphere, closed) = (
            Shape::Sphere { centre, radius: 1.0 },
            Shape::Cylinder { ends: [centre - DVec3::X, centre + DVec3::X * 1.5], radius: 1.0, caps: true },
        );
        for light in [sphere, closed] {
            for value in values(&light, m) {
                assert!((value - above).abs() < 1e-5, "{value} {above}");
            }
            assert_eq!(light.exact(m, Horizon::COSINE), 1.0);
            assert_eq!(light.exact(m, Horizon::NONE), 0.0);
        }
        let Shape::Cylinder { ends, radius, .. } = closed else { continue };
        assert_dark(&Shape::Cylinder { ends, radius, caps: false });
    }
    // On the surface it counts as inside; just outside the lower half is dark.
    let sphere = |gap: f64| Shape::Sphere { centre: dvec3(0.0, 0.0, -1.0 - gap), radius: 1.0 };
    assert_eq!(values(&sphere(0.0), DMat3::IDENTITY), [1.0; 2]);
    assert_eq!(values(&sphere(1e-6), DMat3::IDENTITY), [0.0; 2]);
    let overhead = Shape::Sphere { centre: dvec3(0.0, 0.0, 1.0 + 1e-6), radius: 1.0 };
    assert!(values(&overhead, DMat3::IDENTITY).iter().all(|v| *v > 0.99999));
}

#[test]
fn zero_radius() {
    let centre = dvec3(0.1, 0.2, 1.0);
    let ends = [centre, centre + DVec3::X];
    assert_dark(&Shape::Disk { centre, normal: DVec3::Z, radius: 0.0 });
    assert_dark(&Shape::Sphere { centre, radius: 0.0 });
    assert_dark(&Shape::Sphere { centre: DVec3::ZERO, radius: 0.0 });
    for caps in [false, true] {
        assert_dark(&Shape::Cylinder { ends, radius: 0.0, caps });
        assert_dark(&Shape::Cylinder { ends: [centre; 2], radius: 0.5, caps });
        assert_dark(&Shape::Cylinder { ends: [DVec3::ZERO; 2], radius: 0.0, caps });
    }
    for (u, v) in [(DVec3::ZERO, DVec3::Y), (DVec3::X, DVec3::ZERO), (DVec3::X, DVec3::X * 2.0)] {
        assert_dark(&Shape::Ellipse { centre, u, v });
    }
    assert_dark(&Shape::Ellipse { centre: DVec3::ZERO, u: DVec3::X, v: DVec3::Y });
}

#[test]
fn light_1e6_units_away_and_1e6_units_large() {
    // Relative accuracy: a small disk far away is area · cos / (π d²), whatever the distance.
    for distance in [1e2, 1e3, 1e6] {
        let towards = dvec3(0.6, 0.0, 0.8);
        let area = core::f64::consts::PI;
        let expected = area * 0.8 / (core::f64::consts::PI * distance * distance);
        let flat = Shape::Disk { centre: towards * distance, normal: towards, radius: 1.0 };
        let ball = Shape::Sphere { centre: towards * distance, radius: 1.0 };
        for light in [flat, ball] {
            let [exact, single] = values(&light, DMat3::IDENTITY);
            assert!(
                (exact / expected - 1.0).abs() < 2.0 / (distance * distance) + 1e-13,
                "{distance}: {exact}"
            );
            assert!((single / expected - 1.0).abs() < 2e-4, "{distance}: {single}");
        }
        // Huge and near: the whole hemisphere on that side.
        let vast = Shape::Disk { centre: dvec3(0.0, 0.0, 1.0), normal: DVec3::Z, radius: distance };
        for value in values(&vast, tilted()) {
            let all = Shape::Sphere { centre: DVec3::ZERO, radius: 1.0 }.exact(tilted(), Horizon::BOTH);
            assert!((value - all).abs() < 2.0 / distance, "{value} {all}");
        }
    }
}

#[test]
fn below_the_horizon() {
    let mut random = Random::new(5);
    for i in 0..2000 {
        let m = random.matrix(100.0);
        let towards = random.direction();
        let towards = dvec3(towards.x, towards.y, -towards.z.abs() - 1e-9);
        let light = match i % 4 {
            0 => Shape::Disk { centre: towards * 3.0, normal: random.direction(), radius: -towards.z * 2.9 },
            1 => {
                let reach = -towards.z * 2.0;
                let centre = towards * 3.0;
                Shape::Ellipse { centre, u: random.direction() * reach, v: random.direction() * reach }
            }
            2 => Shape::Sphere { centre: towards * 3.0, radius: -towards.z * 2.99 },
            _ => {
                let ends = [towards * 3.0, towards * 3.5 + DVec3::X];
                Shape::Cylinder { ends, radius: -towards.z * 2.9, caps: i % 8 < 4 }
            }
        };
        assert_eq!(values(&light, m), [0.0; 2], "{light:?}");
        // Behind the lobe, too: all of cosine space below its horizon.
        let upside_down = DMat3::from_rotation_x(core::f64::consts::PI);
        let above = Shape::Sphere { centre: dvec3(0.3, 0.2, 2.0), radius: 1.0 };
        assert_eq!(values(&above, upside_down), [0.0; 2]);
    }
}

#[test]
fn touching_the_horizon() {
    // From above nothing is cut, from below nothing is left; either way nothing is made of the touch.
    for angle in [0.0, 0.3, 1.0, 2.0] {
        let towards = dvec3(f64::cos(angle), f64::sin(angle), 0.0);
        for m in [DMat3::IDENTITY, tilted()] {
            let above = Shape::Sphere { centre: towards * 2.0 + DVec3::Z, radius: 1.0 };
            let [exact, single] = values(&above, m);
            let uncut = above.exact(m, Horizon::COSINE);
            assert!(
                (exact - uncut).abs() < 1e-14 && (single - uncut).abs() < 1e-6,
                "{exact} {single} {uncut}"
            );
            let below = Shape::Sphere { centre: towards * 2.0 - DVec3::Z, radius: 1.0 };
            assert_eq!(values(&below, m), [0.0; 2]);
        }
    }
}

/// A cylinder that stands or lies on the ground: the surface's horizon holds a generator or an end circle.
#[test]
fn resting_on_the_ground() {
    let mut random = Random::new(9);
    for _ in 0..300 {
        let m = random.matrix(20.0);
        let turn = DMat3::from_rotation_z(random.range(0.0, 6.0));
        let radius = random.range(0.1, 1.0);
        let (foot, span) = (turn * dvec3(2.0, 0.0, 0.0), turn * dvec3(0.3, 1.0, 0.0));
        let lying = |lift: f64| Shape::Cylinder {
            ends: [foot, foot + span].map(|p| p + DVec3::Z * (radius + lift)),
            radius,
            caps: true,
        };
        let standing = |lift: f64| Shape::Cylinder {
            ends: [foot + DVec3::Z * lift, foot + DVec3::Z * (1.0 + lift)],
            radius,
            caps: true,
        };
        for light in [&lying as &dyn Fn(f64) -> Shape, &standing] {
            let [low, on, high] = [-1e-7, 0.0, 1e-7].map(|lift| light(lift).exact(m, Horizon::BOTH));
            assert!((low - on).abs() < 1e-4 && (high - on).abs() < 1e-4, "{low} {on} {high}");
            assert!((light(0.0).single(m, Horizon::BOTH) - on).abs() < 2e-5);
        }
    }
}

#[test]
fn in_line_with_a_cylinder() {
    let (near, far) = (dvec3(0.1, 0.0, 1.0), dvec3(0.1, 0.0, 2.0));
    for ends in [[near, far], [far, near]] {
        let solid = Shape::Cylinder { ends, radius: 0.5, caps: true };
        let cap = Shape::Disk { centre: near, normal: DVec3::Z, radius: 0.5 };
        for (a, b) in values(&solid, tilted()).into_iter().zip(values(&cap, tilted())) {
            assert!((a - b).abs() < 1e-6 && a > 0.01, "{a} {b}");
        }
        assert_dark(&Shape::Cylinder { ends, radius: 0.5, caps: false });
    }
    // Out of line it goes on smoothly.
    let at = |aside: f64, caps| Shape::Cylinder {
        ends: [dvec3(aside, 0.0, 1.0), dvec3(aside, 0.0, 2.0)],
        radius: 0.5,
        caps,
    };
    for caps in [false, true] {
        let [inside, outside] =
            [0.5 - 1e-9, 0.5 + 1e-9].map(|aside| at(aside, caps).exact(tilted(), Horizon::BOTH));
        assert!((inside - outside).abs() < 1e-4, "{caps}: {inside} {outside}");
    }
}

#[test]
fn determinant_to_zero_and_condition_1e8() {
    let mut random = Random::new(11);
    for i in 0..4000 {
        let m = random.ggx_like(1e-8);
        let distance = random.decades(0.1, 10.0);
        let light = shape(&mut random, i % 4, DMat3::IDENTITY, distance);
        for horizon in HORIZONS {
            let value = light.exact(m, horizon);
            assert!((0.0..=1.0).contains(&value), "{value}");
            if Ltc::<f32>::new(m.as_mat3()).is_ok() {
                let value = light.single(m, horizon);
                assert!((0.0..=1.0).contains(&value), "{value}");
            }
        }
    }
}

/// Numbers of any size and sign, zeros and coincidences among them: a fraction comes out of all.
#[test]
fn adversarial_numbers_never_break_it() {
    let mut random = Random::new(13);
    let mut number = || match (random.unit() * 12.0) as usize {
        0 => 0.0,
        1 => 1.0,
        2 => -1.0,
        3 => 1e-30,
        4 => 1e30,
        5 => -1e-7,
        6 => f64::from(f32::MAX),
        7 => f64::from(f32::MIN_POSITIVE),
        8 => 1.0 + 1e-7,
        _ => random.range(-2.0, 2.0),
    };
    for i in 0..100_000 {
        let mut vector = || dvec3(number(), number(), number());
        let (a, b, c) = (vector(), vector(), vector());
        let radius = number().abs();
        let light = match i % 4 {
            0 if b == DVec3::ZERO => continue,
            0 => Shape::Disk { centre: a, normal: b, radius },
            1 => Shape::Ellipse { centre: a, u: b, v: c },
            2 => Shape::Sphere { centre: a, radius },
            _ => Shape::Cylinder { ends: [a, b], radius, caps: i % 8 < 4 },
        };
        let m = if i % 3 == 0 { DMat3::IDENTITY } else { tilted() };
        // The disk of a normal that f32 cannot hold is refused there.
        let skip = matches!(light, Shape::Disk { normal, .. } if normal.as_vec3() == Vec3::ZERO);
        for horizon in HORIZONS {
            let single = if skip { 0.0 } else { light.single(m, horizon) };
            for value in [light.exact(m, horizon), single] {
                assert!((0.0..=1.0).contains(&value), "{value}: {light:?} {horizon:?}");
            }
        }
    }
}

fn refused<T>(result: Result<T, InputError>) -> bool {
    matches!(result, Err(InputError::NotFinite { .. } | InputError::OutOfRange { .. }))
}

#[test]
fn nan_and_infinity_are_refused() {
    let p = dvec3(0.1, 0.2, 1.0);
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let q = dvec3(0.0, bad, 1.0);
        assert!(refused(Disk::<f64>::new(q, p, 1.0, Sides::One)));
        assert!(refused(Disk::<f64>::new(p, q, 1.0, Sides::One)));
        assert!(refused(Disk::<f64>::new(p, p, bad, Sides::One)));
        assert!(refused(Ellipse::<f64>::new(q, p, p, Sides::One)));
        assert!(refused(Ellipse::<f64>::new(p, q, p, Sides::One)));
        assert!(refused(Ellipse::<f64>::new(p, p, q, Sides::One)));
        assert!(refused(Sphere::<f64>::new(q, 1.0)));
        assert!(refused(Sphere::<f64>::new(p, bad)));
        assert!(refused(Cylinder::<f64>::new(q, p, 1.0, true)));
        assert!(refused(Cylinder::<f64>::new(p, q, 1.0, true)));
        assert!(refused(Cylinder::<f64>::new(p, p, bad, true)));
    }
    assert!(refused(Disk::<f32>::new(Vec3::Z, Vec3::Z, -1.0, Sides::One)));
    assert!(refused(Sphere::<f32>::new(Vec3::Z, -1.0)));
    assert!(refused(Cylinder::<f32>::new(Vec3::Z, Vec3::X, -1.0, false)));
    // A disk that faces nowhere has an area, but no side: no value would be right.
    let nowhere = Disk::<f64>::new(p, DVec3::ZERO, 1.0, Sides::One);
    assert!(matches!(nowhere, Err(InputError::Degenerate { .. })));
}
