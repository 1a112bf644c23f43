//! Every hazard of polygonal lights by name, each with its defined answer, on every back end.

#![expect(clippy::unwrap_used, reason = "a test fails by a panic")]

use core::f64::consts::{FRAC_PI_2, TAU};

use glam::{DMat3, DVec3};
use ltc_core::points::SplitMix64;
use ltc_core::{Matrix, Sides};
use ltc_table::Query;
use ltc_tests::{BackEnd, CpuF32, CpuF64, Gpu, Job, Path, shapes, table, tolerance};

/// One test body for all back ends: each function becomes a test for each of them.
macro_rules! on_each_back_end {
    ($($hazard:ident),+ $(,)?) => {
        mod cpu_f64 { use super::*; $(#[test] fn $hazard() { super::$hazard(&CpuF64); })+ }
        mod cpu_f32 { use super::*; $(#[test] fn $hazard() { super::$hazard(&CpuF32); })+ }
        mod gpu_polygons {
            use super::*;
            $(#[test] fn $hazard() { if let Some(gpu) = Gpu::open(Path::Polygons) { super::$hazard(&gpu); } })+
        }
        mod gpu_quads {
            use super::*;
            $(#[test] fn $hazard() { if let Some(gpu) = Gpu::open(Path::Quads) { super::$hazard(&gpu); } })+
        }
    };
}

on_each_back_end!(
    view_parallel_to_the_normal,
    edge_ends_equal,
    edge_ends_antipodal,
    point_in_the_plane_on_an_edge_on_a_vertex,
    light_below_the_horizon,
    light_partly_below_the_horizon,
    light_behind_its_own_face,
    non_convex_and_self_touching,
    zero_area,
    near_and_far,
    smallest_and_largest_widths,
    grazing_view,
    determinant_to_zero_and_condition_1e8,
    nan_and_infinity_are_refused,
);

const COSINE: DMat3 = DMat3::IDENTITY;

fn job(m: DMat3, vertices: &[DVec3], sides: Sides) -> Job {
    Job::new(m, vertices, sides)
}

/// The fraction, checked to be one.
fn fraction(back_end: &dyn BackEnd, job: &Job) -> f64 {
    let value = back_end.fraction(job).unwrap();
    assert!((0.0..=1.0).contains(&value), "{}: {value} for {job:?}", back_end.name());
    value
}

fn assert_near(back_end: &dyn BackEnd, job: &Job, expected: f64, tolerance: f64) {
    let value = fraction(back_end, job);
    let name = back_end.name();
    assert!((value - expected).abs() <= tolerance, "{name}: {value}, not {expected}, for {job:?}");
}

/// The same for many, in one go.
fn assert_all_near(back_end: &dyn BackEnd, jobs: &[(Job, f64)], tolerance: f64) {
    let (lights, expected): (Vec<Job>, Vec<f64>) = jobs.iter().cloned().unzip();
    let values = back_end.fractions(&lights).unwrap();
    for ((value, expected), job) in values.iter().zip(expected).zip(&lights) {
        let name = back_end.name();
        assert!((0.0..=1.0).contains(value), "{name}: {value} for {job:?}");
        assert!((value - expected).abs() <= tolerance, "{name}: {value}, not {expected}, for {job:?}");
    }
}

/// A lobe that is neither round nor upright, of condition number 12.
fn tilted() -> DMat3 {
    DMat3::from_row_array([0.5, 0.05, -0.4, 0.02, 0.2, -0.15, 0.1, 0.03, 0.8])
}

fn looked_up(name: &str, theta: f64, phi: f64, alpha_x: f64, alpha_y: f64) -> DMat3 {
    let lookup = table(name).lookup(&Query { theta, phi, alpha_x, alpha_y }).unwrap();
    DMat3::from_row_array(lookup.lobes[0].m)
}

fn view_parallel_to_the_normal(back_end: &dyn BackEnd) {
    // There is no azimuth then: any φ must give the same light.
    let light = shapes::ceiling([-0.2, 0.9], [-0.3, 0.5], 1.0);
    for (name, alpha_y) in [("ggx-anisotropic", 0.1), ("ggx-anisotropic", 0.9), ("ggx-isotropic", 0.4)] {
        let at = |phi| fraction(back_end, &job(looked_up(name, 0.0, phi, 0.4, alpha_y), &light, Sides::One));
        let first = at(0.0);
        assert!(first > 0.1, "{first}");
        for phi in [0.3, FRAC_PI_2, 2.0, 4.0, 6.0] {
            assert!(
                (at(phi) - first).abs() < tolerance::EXACT,
                "{name} {alpha_y} {phi}: {} {first}",
                at(phi)
            );
        }
    }
    // The control: at an angle, φ does matter.
    let tilted =
        |phi| fraction(back_end, &job(looked_up("ggx-anisotropic", 0.7, phi, 0.4, 0.1), &light, Sides::One));
    assert!((tilted(0.0) - tilted(2.0)).abs() > 0.01);
}

fn edge_ends_equal(back_end: &dyn BackEnd) {
    let [a, b, c, d] = shapes::ceiling([-0.2, 0.9], [-0.3, 0.5], 1.0);
    for m in [COSINE, tilted()] {
        let plain = fraction(back_end, &job(m, &[a, b, c, d], Sides::One));
        for repeated in
            [vec![a, a, b, c, d], vec![a, b, b, b, c, d], vec![a, b, c, d, d], vec![a, b, c, d, a]]
        {
            assert_near(back_end, &job(m, &repeated, Sides::One), plain, tolerance::EXACT);
        }
        // A quad that is a triangle.
        let triangle = fraction(back_end, &job(m, &[a, b, c], Sides::One));
        assert_near(back_end, &job(m, &[a, b, c, c], Sides::One), triangle, tolerance::EXACT);
        assert!(triangle > 0.01 && triangle < plain - 0.01);
    }
}

fn edge_ends_antipodal(back_end: &dyn BackEnd) {
    // Seen from just below an edge, its ends lie in opposite directions, and the light covers one half of the sky; from
    // below a corner a quarter, from below the middle all of it.
    for height in [1e-6, 1e-4] {
        for (x, y, expected) in
            [([-1.0, 1.0], [-1.0, 1.0], 1.0), ([0.0, 1.0], [-1.0, 1.0], 0.5), ([0.0, 1.0], [-1.0, 0.0], 0.25)]
        {
            let light = job(COSINE, &shapes::ceiling(x, y, height), Sides::One);
            assert_near(back_end, &light, expected, height + tolerance::EXACT);
        }
    }
    // Exactly antipodal: the shading point lies on the edge, in the light's plane.
    for (p, q) in [(DVec3::new(1.0, 2.0, 2.0), DVec3::Y), (DVec3::X, DVec3::Z)] {
        let light = job(COSINE, &[p, -p, q - p, q + p], Sides::Two);
        assert_near(back_end, &light, 0.0, 0.0);
    }
}

fn point_in_the_plane_on_an_edge_on_a_vertex(back_end: &dyn BackEnd) {
    let upright = |y: [f64; 2], z: [f64; 2]| shapes::wall(0.0, y, z);
    for m in [COSINE, tilted()] {
        for light in [
            upright([-1.0, 1.0], [-1.0, 1.0]), // inside it
            upright([1.0, 2.0], [0.5, 1.5]),   // beside it
            upright([-1.0, 1.0], [0.0, 1.0]),  // on an edge
            upright([0.0, 1.0], [-1.0, 1.0]),
            upright([0.0, 1.0], [0.0, 1.0]), // on a vertex
            shapes::ceiling([-1.0, 1.0], [-1.0, 1.0], 0.0),
        ] {
            assert_near(back_end, &job(m, &light, Sides::Two), 0.0, 0.0);
        }
    }
    // Tilted planes, their vertices rounded to f32, which puts the point truly beside the plane. The CPU sees what is truly
    // there, in f32 as in f64; for the GPU that rounding is below the arithmetic's own, and the light is dark.
    let mut rng = SplitMix64::new(2);
    let (mut beside, mut within) = (Vec::new(), Vec::new());
    for _ in 0..300 {
        let (u, v) = shapes::tangents(shapes::in_cube(&mut rng));
        let light = |centre| job(tilted(), &shapes::parallelogram(centre, u, v * 0.5), Sides::Two);
        beside.push((light(u * 3.0 + v), 0.0));
        within.extend([DVec3::ZERO, u, u + v * 0.5].map(|centre| (light(centre), 0.0)));
    }
    let on_cpu = back_end.name() == CpuF64.name() || back_end.name() == CpuF32.name();
    if on_cpu {
        within.iter_mut().for_each(|(job, expected)| *expected = CpuF64.fraction(job).unwrap());
    }
    assert_all_near(back_end, &beside, if on_cpu { tolerance::EXACT } else { 0.0 });
    assert_all_near(back_end, &within, if on_cpu { tolerance::EXACT } else { 0.0 });
}

fn light_below_the_horizon(back_end: &dyn BackEnd) {
    let mut rng = SplitMix64::new(3);
    let (mut below, mut above) = (Vec::new(), Vec::new());
    for _ in 0..300 {
        let (u, v) = (shapes::in_cube(&mut rng), shapes::in_cube(&mut rng));
        let sunk = shapes::parallelogram(DVec3::new(0.3, 0.2, -u.z.abs() - v.z.abs() - 1e-3), u, v);
        // The cosine tilted by 80° would see a great deal of it.
        let lobes = [COSINE, tilted(), DMat3::from_rotation_x(1.4)];
        below.extend(lobes.map(|m| (job(m, &sunk, Sides::Two), 0.0)));
        above.push(job(COSINE, &sunk.map(|p| p * DVec3::new(1.0, 1.0, -1.0)), Sides::Two));
    }
    assert_all_near(back_end, &below, 0.0);
    let lit = back_end.fractions(&above).unwrap().iter().filter(|v| **v > 1e-3).count();
    assert!(lit > 250, "the control: above the horizon they do light: {lit}");
}

fn light_partly_below_the_horizon(back_end: &dyn BackEnd) {
    for (b, a) in [(1.0, 1.0), (0.3, 4.0), (20.0, 0.1)] {
        for depth in [0.0, 0.5, 100.0] {
            let light = shapes::wall(1.0, [0.0, b], [-depth, a]);
            assert_near(back_end, &job(COSINE, &light, Sides::One), shapes::standing(a, b), tolerance::EXACT);
            // Under any lobe, what is below adds nothing.
            for m in [tilted(), DMat3::from_rotation_y(1.2)] {
                let above = fraction(back_end, &job(m, &shapes::wall(1.0, [0.0, b], [0.0, a]), Sides::One));
                assert_near(back_end, &job(m, &light, Sides::One), above, tolerance::EXACT);
            }
        }
    }
}

fn light_behind_its_own_face(back_end: &dyn BackEnd) {
    let front = shapes::ceiling([-0.2, 0.9], [-0.3, 0.5], 1.0);
    let back = shapes::reversed(front);
    for m in [COSINE, tilted()] {
        let seen = fraction(back_end, &job(m, &front, Sides::One));
        assert!(seen > 0.05);
        assert_near(back_end, &job(m, &back, Sides::One), 0.0, 0.0);
        assert_near(back_end, &job(m, &back, Sides::Two), seen, tolerance::EXACT);
        assert_near(back_end, &job(m, &front, Sides::Two), seen, tolerance::EXACT);
    }
}

fn non_convex_and_self_touching(back_end: &dyn BackEnd) {
    let at = |x: f64, y: f64| DVec3::new(x, y, 1.0);
    let rectangle = |x, y| shapes::ceiling(x, y, 1.0).to_vec();
    for m in [COSINE, tilted()] {
        let of = |vertices: &[DVec3]| fraction(back_end, &job(m, vertices, Sides::One));
        // An L: a square without a quarter.
        let l = [at(0.0, 0.0), at(0.0, 2.0), at(1.0, 2.0), at(1.0, 1.0), at(2.0, 1.0), at(2.0, 0.0)];
        let parts = of(&rectangle([0.0, 1.0], [0.0, 2.0])) + of(&rectangle([1.0, 2.0], [0.0, 1.0]));
        assert_near(back_end, &job(m, &l, Sides::One), parts, tolerance::EXACT);
        // A quad with a dent: a triangle without another.
        let dart = [at(-1.0, -1.0), at(0.0, 1.0), at(1.0, -1.0), at(0.0, -0.5)];
        let parts = of(&[dart[0], dart[1], dart[2]]) - of(&[dart[0], dart[3], dart[2]]);
        assert_near(back_end, &job(m, &dart, Sides::One), parts, tolerance::EXACT);
        // Two triangles that touch at a vertex.
        let pinched = [at(0.0, 0.0), at(-1.0, 0.5), at(-1.0, 1.5), at(0.0, 0.0), at(1.0, 1.5), at(1.0, 0.5)];
        let parts = of(&pinched[..3]) + of(&pinched[3..]);
        assert_near(back_end, &job(m, &pinched, Sides::One), parts, tolerance::EXACT);
        // A frame, its hole joined to the outside by an edge that runs there and back.
        let (outer, hole) = (rectangle([-1.0, 1.0], [-1.0, 1.0]), rectangle([-0.5, 0.5], [-0.5, 0.5]));
        let mut frame = outer.clone();
        frame.push(outer[0]);
        frame.push(hole[0]);
        frame.extend(hole.iter().rev());
        assert_near(back_end, &job(m, &frame, Sides::One), of(&outer) - of(&hole), tolerance::EXACT);
    }
}

fn zero_area(back_end: &dyn BackEnd) {
    let (p, q) = (DVec3::new(0.25, 0.5, 1.0), DVec3::new(-0.5, 0.25, 2.0));
    for m in [COSINE, tilted()] {
        for light in [[p; 4], [DVec3::ZERO; 4], [p, q, q, p], [p, q, p, q], [p, p * 2.0, p * 3.0, p * 4.0]] {
            assert_near(back_end, &job(m, &light, Sides::Two), 0.0, 0.0);
            assert_near(back_end, &job(m, &light[..3], Sides::Two), 0.0, 0.0);
        }
    }
    // Corners on a line that rounding bends: a sliver of no area to speak of.
    let mut rng = SplitMix64::new(4);
    let mut sliver = || {
        let (a, b) = (shapes::in_cube(&mut rng) + DVec3::Z * 1.5, shapes::in_cube(&mut rng));
        (job(tilted(), &[0.0, 1.0, 0.7, 0.2].map(|t| a + b * t), Sides::Two), 0.0)
    };
    let slivers: Vec<_> = (0..300).map(|_| sliver()).collect();
    assert_all_near(back_end, &slivers, tolerance::EXACT);
}

fn near_and_far(back_end: &dyn BackEnd) {
    // The same light, near and small or far and large.
    let light = shapes::ceiling([-0.2, 0.9], [-0.3, 0.5], 1.0);
    for m in [COSINE, tilted()] {
        let expected = job(m, &light, Sides::One).in_f64().unwrap();
        for scale in [1e-6, 1e-3, 1e3, 1e6] {
            let scaled = light.map(|p| p * scale);
            assert_near(back_end, &job(m, &scaled, Sides::One), expected, tolerance::EXACT);
        }
    }
    // A light of size 1: from nearly touching it to where it is a point.
    for distance in [1e-6, 1e-3, 1.0, 1e3, 1e6] {
        let light = job(COSINE, &shapes::ceiling([-1.0, 1.0], [-1.0, 1.0], distance), Sides::One);
        let expected = 4.0 * shapes::corner_above(1.0 / distance, 1.0 / distance);
        assert_near(back_end, &light, expected, tolerance::EXACT * (1e-6 + expected));
    }
}

fn smallest_and_largest_widths(back_end: &dyn BackEnd) {
    let (theta, phi) = (0.7, 0.4);
    let wo = ltc_fit::direction(theta, phi);
    let mirror = DVec3::new(-wo.x, -wo.y, wo.z);
    let (u, v) = shapes::tangents(mirror);
    let around = |centre: DVec3, size: f64| {
        let quad = shapes::parallelogram(centre, u * size, v * size);
        if shapes::faces_origin(&quad) { quad } else { shapes::reversed(quad) }
    };
    let widths = [(0.0, 0.0), (1e-4, 1e-4), (0.5, 0.0), (0.0, 0.5), (1.0, 0.0), (1.0, 1.0)];
    for (alpha_x, alpha_y) in widths {
        for name in ["ggx-anisotropic", "ggx-isotropic"] {
            if name == "ggx-isotropic" && alpha_x != alpha_y {
                continue;
            }
            let m = looked_up(name, theta, phi, alpha_x, alpha_y);
            for (centre, size) in [(mirror, 0.3), (mirror, 3.0), (mirror * 2.0 + u, 0.5), (DVec3::Z, 0.1)] {
                let light = job(m, &around(centre, size), Sides::One);
                let expected = light.in_f64().unwrap();
                assert_near(back_end, &light, expected, tolerance::BACK_ENDS);
            }
            if alpha_x.max(alpha_y) < 1e-3 {
                // A mirror: all of the lobe is in a light around the mirror direction, and nothing elsewhere.
                assert!(
                    fraction(back_end, &job(m, &around(mirror, 0.3), Sides::One)) > 0.95,
                    "{name} {alpha_x}"
                );
                let aside = around(DVec3::new(mirror.y, -mirror.x, mirror.z), 0.1);
                assert!(fraction(back_end, &job(m, &aside, Sides::One)) < 0.01, "{name} {alpha_x}");
            }
        }
    }
}

fn grazing_view(back_end: &dyn BackEnd) {
    const WIDTHS: [(f64, f64); 6] =
        [(1.0, 1.0), (0.3, 0.3), (0.05, 0.05), (0.0, 0.0), (0.6, 0.05), (0.02, 0.9)];
    let mut jobs = Vec::new();
    for theta in [89.0_f64.to_radians(), 89.99_f64.to_radians(), FRAC_PI_2] {
        for (alpha_x, alpha_y) in WIDTHS {
            for phi in [0.0, 0.1, FRAC_PI_2, 2.0, 4.0] {
                let name = if alpha_x == alpha_y { "ggx-isotropic" } else { "ggx-anisotropic" };
                let m = looked_up(name, theta, phi, alpha_x, alpha_y);
                let ahead = DVec3::new(-phi.cos(), -phi.sin(), 0.0);
                let (u, v) = (DVec3::Z * 0.5, ahead.cross(DVec3::Z) * 0.5);
                for centre in [ahead, ahead * 0.2 + DVec3::Z * 0.1, DVec3::Z] {
                    let light = job(m, &shapes::parallelogram(centre, u, v), Sides::Two);
                    let expected = light.in_f64().unwrap();
                    jobs.push((light, expected));
                }
            }
        }
    }
    assert!(jobs.iter().filter(|(_, expected)| *expected > 0.01).count() > 100);
    assert_all_near(back_end, &jobs, tolerance::BACK_ENDS);
}

fn determinant_to_zero_and_condition_1e8(back_end: &dyn BackEnd) {
    // Squashed along axes, the answers are known: nothing is left beside the plane, or the axis, that the lobe fills.
    for small in [1e-4, 1e-6, 1e-8] {
        let overhead = shapes::ceiling([-0.5, 0.5], [-0.5, 0.5], 1.0);
        let needle = DMat3::from_diagonal(DVec3::new(small, small, 1.0));
        assert_near(back_end, &job(needle, &overhead, Sides::One), 1.0, tolerance::EXACT);
        let aside = shapes::ceiling([0.5, 1.5], [-0.5, 0.5], 1.0);
        assert_near(back_end, &job(needle, &aside, Sides::One), 0.0, tolerance::EXACT);
        // A fan in the plane x = 0: of density cos/2 over the angle in it, so that the square takes sin(atan ½).
        let fan = DMat3::from_diagonal(DVec3::new(small, 1.0, 1.0));
        let expected = 0.5_f64.atan().sin();
        assert_near(back_end, &job(fan, &overhead, Sides::One), expected, 3.0 * small + tolerance::EXACT);
        assert_near(back_end, &job(fan, &aside, Sides::One), 0.0, 3.0 * small + tolerance::EXACT);
    }
    // Turned anywhere, what is left of the digits must still be a fraction, or be refused in words.
    let mut rng = SplitMix64::new(6);
    let turn = |rng: &mut SplitMix64| {
        let (axis, angle) = (shapes::in_cube(rng).normalize_or(DVec3::Z), rng.range(0.0, TAU));
        DMat3::from_axis_angle(axis, angle)
    };
    let mut answered = 0;
    for _ in 0..100 {
        let scale = DMat3::from_diagonal(DVec3::new(1e-8_f64.powf(rng.unit()), 1e-8, 1.0));
        let light = shapes::parallelogram(shapes::in_cube(&mut rng), shapes::in_cube(&mut rng), DVec3::Z);
        let light = job(turn(&mut rng) * scale * turn(&mut rng), &light, Sides::Two);
        match back_end.fraction(&light) {
            Ok(value) => {
                assert!((0.0..=1.0).contains(&value), "{value} for {light:?}");
                answered += 1;
            }
            Err(reason) => assert!(reason.contains("determinant above 0"), "{reason}"),
        }
    }
    assert!(answered > 20, "{}: {answered}", back_end.name());
}

fn nan_and_infinity_are_refused(back_end: &dyn BackEnd) {
    let good = job(tilted(), &shapes::ceiling([-1.0, 1.0], [-1.0, 1.0], 1.0), Sides::One);
    let refused = |bad: Job, words: &str| {
        let reason = back_end.fractions(&[good.clone(), bad]).unwrap_err();
        assert!(reason.contains(words), "{}: {reason}", back_end.name());
    };
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for i in 0..9 {
            let mut job = good.clone();
            job.m[i] = bad;
            refused(job, "matrix m is not a finite number");
        }
        for i in 0..12 {
            let mut job = good.clone();
            job.vertices[i / 3][i % 3] = bad;
            refused(job, "vertex is not a finite number");
        }
    }
    refused(good.under(DMat3::ZERO), "determinant above 0");
    refused(good.under(DMat3::from_diagonal(DVec3::new(1.0, 1.0, -1.0))), "determinant above 0");
    refused(good.lit_by(&good.vertices_f64()[..2]), "at least 3 vertices");
    assert!(back_end.fraction(&good).unwrap() > 0.5, "the control: the good one is computed");
}
