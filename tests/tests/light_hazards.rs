//! Every hazard of MATHS.md for lights of every kind, on every back end: near CPU f64, or exactly dark.

#![expect(clippy::unwrap_used, reason = "a test fails by a panic")]

use core::f64::consts::FRAC_PI_2;

use glam::{DMat3, DVec3, dvec3};
use ltc_core::points::SplitMix64;
use ltc_core::{Matrix as _, Sides};
use ltc_shade_gpu::{LightJob, LightShape};
use ltc_table::Query;
use ltc_tests::make::{all, cylinder, disk, ellipse, flat, line, polygon, quad, sphere, strip};
use ltc_tests::{LightBackEnd, LightsF64, condition, light_back_ends, matrix, shapes, table, tolerance};

const COSINE: DMat3 = DMat3::IDENTITY;

fn tilted() -> DMat3 {
    DMat3::from_cols(dvec3(0.4, 0.1, 0.0), dvec3(0.0, 0.3, -0.1), dvec3(0.3, 0.2, 0.9))
}

fn jobs(lobes: &[DMat3], lights: impl IntoIterator<Item = LightShape>) -> Vec<LightJob> {
    let lights: Vec<_> = lights.into_iter().collect();
    let job = |m: &DMat3, light: &LightShape| LightJob {
        m: m.to_row_array().map(|x| x as f32),
        light: light.clone(),
    };
    lobes.iter().flat_map(|m| lights.iter().map(move |light| job(m, light))).collect()
}

/// Lights that are dark, by hazard.
fn dark() -> Vec<(&'static str, Vec<LightShape>)> {
    let [p, q, normal] = [dvec3(0.1, 0.2, 1.0), dvec3(0.6, -0.3, 1.5), DVec3::X];
    let below = [dvec3(0.3, 0.2, -2.0), dvec3(3.0, 0.0, -1.0), dvec3(-5.0, 4.0, -1.5)];
    let (through, far) = (dvec3(0.5, 0.25, 1.0), dvec3(1.0, 2.0, 2.0));
    let in_plane = [(0.0, 0.0), (1.0, 0.5), (0.0, 1.0), (1.0, 1.0), (0.0, 3.0), (4.0, 0.25)];
    let one_sided = |light| match light {
        LightShape::Quad { corners, .. } => LightShape::Quad { corners, sides: Sides::One },
        LightShape::Polygon { vertices, .. } => LightShape::Polygon { vertices, sides: Sides::One },
        LightShape::Disk { center, normal, radius, .. } => {
            LightShape::Disk { center, normal, radius, sides: Sides::One }
        }
        LightShape::Ellipse { center, axis_u, axis_v, .. } => {
            LightShape::Ellipse { center, axis_u, axis_v, sides: Sides::One }
        }
        LightShape::Strip { p0, p1, width, normal, .. } => {
            LightShape::Strip { p0, p1, width, normal, sides: Sides::One }
        }
        other => other,
    };
    vec![
        (
            "edge ends antipodal",
            vec![
                polygon(&[far, -far, DVec3::Y - far, DVec3::Y + far]),
                quad([DVec3::X, -DVec3::X, DVec3::Z - DVec3::X, DVec3::Z + DVec3::X]),
                line(p, -p, 0.1, true),
                strip(p, -p, p.any_orthogonal_vector(), 0.1),
                cylinder(p, -p, 0.1, false),
            ],
        ),
        (
            "point in the plane, on an edge, on a vertex",
            in_plane.iter().flat_map(|(y, z)| flat(dvec3(0.0, *y, *z), DVec3::Y, DVec3::Z)).collect(),
        ),
        ("below the horizon", below.iter().flat_map(|c| all(*c, 1.0)).collect()),
        ("in the horizon", flat(dvec3(3.0, 0.0, 0.0), DVec3::X, DVec3::Y)),
        (
            "behind its own face",
            flat(dvec3(0.2, 0.1, 1.5), DVec3::X * 0.5, DVec3::Y * 0.5).into_iter().map(one_sided).collect(),
        ),
        (
            "no area, length or radius",
            vec![
                polygon(&[p, p, p]),
                polygon(&[p, q, p]),
                quad([p, q, q, p]),
                quad([DVec3::ZERO; 4]),
                disk(p, normal, 0.0),
                ellipse(p, q, DVec3::ZERO),
                ellipse(p, q, q * 2.0),
                sphere(p, 0.0),
                sphere(DVec3::ZERO, 0.0),
                line(p, q, 0.0, true),
                line(p, p, 0.1, true),
                strip(p, q, normal, 0.0),
                strip(p, p, normal, 0.1),
                cylinder(p, q, 0.0, true),
                cylinder(p, p, 0.1, true),
            ],
        ),
        (
            "line through the shading point",
            vec![
                line(through * 2.0, through * -0.5, 0.1, false),
                line(DVec3::ZERO, through, 0.1, false),
                strip(through, -through, DVec3::X, 0.1),
                cylinder(through * 2.0, through * -0.5, 0.1, false),
            ],
        ),
        (
            "ends on one ray",
            vec![
                line(through, through * 2.0, 0.1, false),
                strip(through, through * 2.0, through.any_orthogonal_vector(), 0.1),
                cylinder(through, through * 2.0, 0.1, false),
            ],
        ),
        ("disk edge-on", vec![disk(dvec3(0.0, 0.3, 2.0), DVec3::X, 1.0)]),
    ]
}

/// Jobs of which the defined answer is that of CPU f64, by hazard.
fn defined() -> Vec<(&'static str, Vec<LightJob>)> {
    let both = [COSINE, tilted()];
    let at = |x: f64, y: f64| dvec3(x, y, 1.0);
    let [a, b, c] = [dvec3(-0.2, -0.3, 1.0), dvec3(0.9, -0.3, 1.1), dvec3(0.9, 0.5, 1.2)];
    let centre = dvec3(2.0, 0.3, 0.0);
    let scales = [-12, -6, -3, 3, 6, 12].map(|e| 10f64.powi(e));
    let heights = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5];
    let needles = [1e-4, 1e-6, 1e-8].map(|s| DMat3::from_diagonal(dvec3(s, s, 1.0)));
    let fans = [1e-2, 1e-4, 1e-6].map(|s| DMat3::from_diagonal(dvec3(1.0, s, 1.0)));
    let grazing = [1.0, 1e-2, 0.0].map(|below: f64| {
        DMat3::from_rotation_y(FRAC_PI_2 - below.to_radians()) * DMat3::from_diagonal(dvec3(0.1, 0.1, 1.0))
    });
    let cubic = |axis: DVec3| {
        let (u, v) = axis.any_orthonormal_pair();
        [1.0, 1.0 + 1e-7, 1.001].map(|s| ellipse(axis, u * 0.2 * s, v * 0.2))
    };
    vec![
        (
            "edge ends equal",
            jobs(
                &both,
                [
                    polygon(&[a, a, b, c]),
                    polygon(&[a, b, b, b, c]),
                    polygon(&[a, b, c, a]),
                    quad([a, b, c, c]),
                ],
            ),
        ),
        (
            "an edge of nearly half a turn",
            jobs(
                &both,
                heights.iter().flat_map(|h| {
                    let corners = shapes::parallelogram(dvec3(0.0, 1.0, *h), DVec3::X, DVec3::Y);
                    [quad(corners), polygon(&corners)]
                }),
            ),
        ),
        (
            "non-convex and self-touching",
            jobs(
                &both,
                [
                    polygon(&[
                        at(0.0, 0.0),
                        at(2.0, 0.0),
                        at(2.0, 1.0),
                        at(1.0, 1.0),
                        at(1.0, 2.0),
                        at(0.0, 2.0),
                    ]),
                    polygon(&[at(0., 0.), at(1., -1.), at(1., 1.), at(0., 0.), at(-1., 1.), at(-1., -1.)]),
                    quad([at(-2.0, -2.0), at(2.0, -2.0), at(0.0, -1.5), at(0.0, 2.0)]),
                ],
            ),
        ),
        ("partly below the horizon", jobs(&both, flat(centre, DVec3::Y, DVec3::Z))),
        (
            "partly below the horizon",
            jobs(
                &both,
                [
                    line(centre - DVec3::Z, centre + DVec3::Z, 0.1, true),
                    cylinder(centre - DVec3::Z, centre + DVec3::Z, 0.5, false),
                    cylinder(centre - DVec3::Z, centre + DVec3::Z, 0.5, true),
                    sphere(centre, 1.0),
                ],
            ),
        ),
        (
            "inside and on the surface of a solid",
            jobs(
                &both,
                [
                    sphere(dvec3(0.1, 0.2, -0.1), 1.0),
                    sphere(DVec3::Z, 1.0),
                    cylinder(-DVec3::X, DVec3::X, 1.0, true),
                    cylinder(DVec3::Y - DVec3::X, DVec3::Y + DVec3::X, 1.0, true),
                ],
            ),
        ),
        ("ends on one ray", jobs(&both, [cylinder(at(0.5, 0.2), at(0.5, 0.2) * 2.0, 0.1, true)])),
        (
            "line ever nearer to the shading point",
            jobs(
                &[COSINE],
                heights.iter().flat_map(|h| {
                    let (p0, p1) = (dvec3(-1.0, 0.0, *h), dvec3(1.0, 0.0, *h));
                    [line(p0, p1, 0.01 * h, false), strip(p0, p1, DVec3::Z, 0.02 * h)]
                }),
            ),
        ),
        (
            "coincident roots of the cubic",
            jobs(&both, [DVec3::Z, dvec3(0.6, 0.0, 0.8)].into_iter().flat_map(cubic)),
        ),
        (
            "coincident roots of the cubic",
            jobs(
                &[DMat3::from_diagonal(dvec3(0.25, 0.5, 1.0))],
                [ellipse(DVec3::Z, DVec3::X * 0.25, DVec3::Y * 0.5)],
            ),
        ),
        (
            "disk edge-on and nearly so",
            jobs(
                &both,
                heights.iter().flat_map(|h| {
                    [
                        disk(dvec3(*h, 0.3, 2.0), DVec3::X, 1.0),
                        disk(DVec3::Z * *h, DVec3::Z, 1.0),
                        disk(dvec3(1.5, 0.0, *h), DVec3::Z, 1.0),
                    ]
                }),
            ),
        ),
        ("near and far", jobs(&both, scales.iter().flat_map(|s| all(dvec3(0.4, 0.3, 2.5) * *s, *s)))),
        ("far for its size", jobs(&both, all(dvec3(0.6e6, 0.0, 0.8e6), 1.0))),
        (
            "narrowest lobes, condition 1e8",
            jobs(
                &needles,
                [
                    quad(shapes::parallelogram(DVec3::Z * 2.0, DVec3::X, DVec3::Y)),
                    disk(DVec3::Z * 2.0, DVec3::Z, 1.0),
                    sphere(DVec3::Z * 2.0, 1.0),
                    cylinder(dvec3(-1.0, 0.0, 2.0), dvec3(1.0, 0.0, 2.0), 0.5, false),
                ],
            ),
        ),
        ("narrowest lobes beside the light", jobs(&needles, all(dvec3(3.0, 3.0, 3.0), 1.0))),
        (
            "ever more anisotropic lobes",
            jobs(
                &fans,
                [
                    quad(shapes::parallelogram(DVec3::Z, DVec3::X * 0.5, DVec3::Y * 0.5)),
                    disk(DVec3::Z, DVec3::Z, 0.5),
                    ellipse(DVec3::Z, DVec3::X * 0.5, DVec3::Y * 0.3),
                    sphere(dvec3(0.0, 2.0, 1.0), 1.0),
                ],
            ),
        ),
        (
            "grazing lobes",
            jobs(
                &grazing,
                [
                    sphere(DVec3::ZERO, 1.0),
                    quad(shapes::parallelogram(DVec3::X, DVec3::Y * 1e4, DVec3::Z * 1e4)),
                    disk(DVec3::X, DVec3::X, 1e4),
                    cylinder(dvec3(2.0, -1.0, 0.0), dvec3(2.0, 1.0, 0.0), 0.5, true),
                ],
            ),
        ),
    ]
}

fn assert_near(back_end: &dyn LightBackEnd, hazard: &str, jobs: &[LightJob]) {
    let (values, truth) = (back_end.fractions(jobs).unwrap(), LightsF64.fractions(jobs).unwrap());
    for ((value, truth), job) in values.iter().zip(truth).zip(jobs) {
        let allowed = tolerance::LIGHTS * (condition(matrix(job)) / 100.0).max(1.0);
        let name = back_end.name();
        assert!((0.0..=1.0).contains(value), "{hazard}, {name}: {value}: {job:?}");
        assert!((value - truth).abs() <= allowed, "{hazard}, {name}: {value}, not {truth}: {job:?}");
    }
}

#[test]
fn every_hazard_has_its_defined_answer() {
    for back_end in light_back_ends() {
        for (hazard, lights) in dark() {
            let jobs = jobs(&[COSINE, tilted()], lights);
            for (value, job) in back_end.fractions(&jobs).unwrap().iter().zip(&jobs) {
                assert_eq!(*value, 0.0, "{hazard}, {}: {job:?}", back_end.name());
            }
        }
        for (hazard, jobs) in defined() {
            assert_near(&*back_end, hazard, &jobs);
        }
    }
}

/// At every roughness, from α = 0 to 1, seen from above and at grazing angles; and the control that they shine from above.
#[test]
fn below_the_horizon_lights_add_exactly_nothing() {
    let table = table("ggx-anisotropic");
    let mut rng = SplitMix64::new(9);
    let (mut below, mut above) = (Vec::new(), Vec::new());
    for i in 0..400 {
        let query = Query {
            theta: FRAC_PI_2 * f64::from(i % 20) / 19.0,
            phi: rng.range(0.0, 6.0),
            alpha_x: f64::from(i / 20) / 19.0,
            alpha_y: f64::from(i / 20) / 19.0 * rng.unit(),
        };
        let m = DMat3::from_row_array(table.lookup(&query).unwrap().lobes[0].m);
        let centre = dvec3(rng.range(-3.0, 3.0), rng.range(-3.0, 3.0), -1.0 - 1e-3 - 3.0 * rng.unit());
        below.extend(jobs(&[m], all(centre, 1.0)));
        above.extend(jobs(&[COSINE], all(dvec3(centre.x, centre.y, -centre.z), 1.0)));
    }
    for back_end in light_back_ends() {
        let values = back_end.fractions(&below).unwrap();
        for (value, job) in values.iter().zip(&below) {
            assert_eq!(*value, 0.0, "{}: {job:?}", back_end.name());
        }
        let lit = back_end.fractions(&above).unwrap().iter().filter(|v| **v > 1e-6).count();
        assert!(lit > above.len() * 9 / 10, "the control, {}: {lit}", back_end.name());
    }
}

/// The control of these tests and of `lights.rs`: a light that is a thousandth larger is seen to be.
#[test]
fn a_planted_error_is_seen() {
    let light = |size: f64| vec![sphere(DVec3::Z * 2.0, size), disk(DVec3::Z * 2.0, DVec3::Z, size)];
    let (right, wrong) = (jobs(&[COSINE], light(1.0)), jobs(&[COSINE], light(1.001)));
    let truth = LightsF64.fractions(&right).unwrap();
    for back_end in light_back_ends() {
        for (value, truth) in back_end.fractions(&wrong).unwrap().iter().zip(&truth) {
            assert!((value - truth).abs() > tolerance::LIGHTS, "{}: {value}", back_end.name());
        }
    }
}

#[test]
fn nan_and_infinity_are_refused() {
    for back_end in light_back_ends() {
        for bad in [f64::NAN, f64::INFINITY] {
            let p = dvec3(0.5, bad, 1.0);
            for light in [
                polygon(&[p, DVec3::X, DVec3::Z]),
                quad([p, DVec3::X, DVec3::Y, DVec3::Z]),
                line(p, DVec3::Z, 0.1, true),
                line(DVec3::Z, DVec3::X, bad, false),
                strip(DVec3::Z, DVec3::X, p, 0.1),
                cylinder(DVec3::Z, p, 0.1, true),
                disk(p, DVec3::Z, 1.0),
                ellipse(DVec3::Z, DVec3::X, p),
                sphere(DVec3::Z, bad),
            ] {
                assert!(back_end.fractions(&jobs(&[COSINE], [light.clone()])).is_err(), "{light:?}");
            }
        }
        let singular = DMat3::from_diagonal(dvec3(0.0, 1.0, 1.0));
        assert!(back_end.fractions(&jobs(&[singular], [sphere(DVec3::Z, 0.5)])).is_err());
    }
}
