//! Lights of every kind: CPU f32 and every GPU driver that can run here against CPU f64, by one body.

use core::f64::consts::FRAC_PI_2;

use glam::{DVec3, Mat3, Vec3};
use ltc_core::Sides;
use ltc_core::points::SplitMix64;
use ltc_fit::draw;
use ltc_shade_gpu::{LightJob, LightKind, LightShape};
use ltc_tests::{
    LightBackEnd, LightsF64, condition, lean_lights, light_back_ends, light_jobs, lit_share, matrix, shapes,
    table, tolerance, wide,
};

/// Triples of material, view and light for each kind of light.
const TRIPLES: usize = 100_000;

/// Half of the triples over the standard draw of the anisotropic table, half over wider domains of both tables.
fn triples(kind: LightKind) -> Vec<LightJob> {
    let (anisotropic, isotropic) = (table("ggx-anisotropic"), table("ggx-isotropic"));
    let seed = 100 + kind as u64;
    let standard = draw::standard(TRIPLES / 2, seed, false);
    let mut jobs = light_jobs(kind, &anisotropic, &standard, seed);
    jobs.extend(light_jobs(kind, &anisotropic, &wide(TRIPLES / 4, 0.0, FRAC_PI_2, seed), seed + 50));
    jobs.extend(light_jobs(kind, &isotropic, &wide(TRIPLES / 4, 1.0, FRAC_PI_2, seed), seed + 60));
    jobs
}

/// The largest error over what is allowed at each job's condition number, and where it is.
fn largest_excess(jobs: &[LightJob], values: &[f64], truth: &[f64]) -> (f64, usize) {
    let mut worst = (0.0, 0);
    for (i, (job, (value, truth))) in jobs.iter().zip(values.iter().zip(truth)).enumerate() {
        assert!((0.0..=1.0).contains(value), "{value}: {job:?}");
        let allowed = tolerance::LIGHTS * (condition(matrix(job)) / 100.0).max(1.0);
        let excess = (value - truth).abs() / allowed;
        if excess > worst.0 {
            worst = (excess, i);
        }
    }
    worst
}

#[test]
fn random_triples_agree_on_all_back_ends() {
    let back_ends = light_back_ends();
    let mut failures = Vec::new();
    for kind in LightKind::ALL {
        let jobs = triples(kind);
        let truth = LightsF64.fractions(&jobs).unwrap();
        let lit = lit_share(&truth);
        assert!(lit > 0.05, "{kind}: only {lit} of the triples are lit");
        for back_end in &back_ends {
            let values = back_end.fractions(&jobs).unwrap();
            let absolute = values.iter().zip(&truth).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            let (excess, at) = largest_excess(&jobs, &values, &truth);
            println!(
                "{kind}, {}: up to {absolute:.1e}, {excess:.2} of what is allowed; {:.0} % lit",
                back_end.name(),
                100.0 * lit
            );
            if excess > 1.0 {
                failures.push(format!(
                    "{kind}, {}: {} for {}, {excess} of what is allowed: {:?}",
                    back_end.name(),
                    values[at],
                    truth[at],
                    jobs[at]
                ));
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// The same bound for the lights that leave out care for what is rare.
#[test]
fn lean_lights_agree_in_absolute_terms() {
    for kind in [LightKind::Quad, LightKind::Line, LightKind::Strip] {
        let jobs = triples(kind);
        let truth = LightsF64.fractions(&jobs).unwrap();
        for back_end in lean_lights() {
            let values = back_end.fractions(&jobs).unwrap();
            let absolute = values.iter().zip(&truth).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            let (excess, at) = largest_excess(&jobs, &values, &truth);
            println!("{kind}, {}: up to {absolute:.1e}, {excess:.2} of what is allowed", back_end.name());
            assert!(excess <= 1.0, "{} for {}: {:?}", values[at], truth[at], jobs[at]);
            // The control: the same light under its neighbour's lobe.
            let others: Vec<_> =
                jobs.iter().zip(&jobs[1..]).map(|(a, b)| LightJob { m: b.m, ..a.clone() }).collect();
            let values = back_end.fractions(&others).unwrap();
            assert!(largest_excess(&others, &values, &truth).0 > 100.0);
        }
    }
}

/// Lines that have no extent, lie along the view, go through the shading point, or lie below the surface.
#[test]
fn lean_lines_stay_in_range() {
    let job = |[p0, p1]: [DVec3; 2]| LightJob {
        m: [0.4, 0.0, 0.3, 0.1, 0.3, 0.2, 0.0, -0.1, 0.9],
        light: LightShape::Line { p0: p0.as_vec3(), p1: p1.as_vec3(), radius: 0.1, caps: false },
    };
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
    let degenerate: Vec<_> = [
        [z, z],
        [DVec3::ZERO; 2],
        [z, 2.0 * z],
        [z, -z],
        [x + z, -x - z],
        [x, -x],
        [x, y],
        [DVec3::ZERO, z],
        [z * 1e-30, x],
        [(x + z) * 1e6, (y + z) * 1e6],
        [(x + z) * 1e-6, (y + z) * 1e-6],
        [z + x * 1e-7, z - x * 1e-7],
        [x - y, z * 1e-20 - x],
    ]
    .into_iter()
    .map(job)
    .collect();
    let below = job([x - z, y - z]);
    for back_end in lean_lights() {
        let values = back_end.fractions(&degenerate).unwrap();
        assert!(values.iter().all(|value| (0.0..=1.0).contains(value)), "{values:?}");
        assert_eq!(back_end.fractions(std::slice::from_ref(&below)).unwrap(), [0.0], "it leaks");
    }
}

/// Distance of the shading point from a quad's plane, over the quad's farthest corner.
fn height_over_plane(job: &LightJob) -> f64 {
    let LightShape::Quad { corners, .. } = &job.light else { return 0.0 };
    let [a, b, c, d] = corners.map(Vec3::as_dvec3);
    let farthest = [a, b, c, d].map(DVec3::length).into_iter().fold(0.0, f64::max);
    (c - a).cross(d - b).normalize_or_zero().dot(a).abs() / farthest
}

/// What they leave out: digits of tiny lights, by size; and degenerate ones, which are never more than a number in [0, 1].
#[test]
fn lean_quads_say_how_tiny_a_light_may_be_and_stay_in_range() {
    let lobe = Mat3::from_cols_array(&[0.4, 0.1, 0.0, 0.0, 0.3, -0.1, 0.3, 0.2, 0.9]).transpose();
    let job = |corners: [DVec3; 4]| LightJob {
        m: lobe.transpose().to_cols_array(),
        light: LightShape::Quad { corners: corners.map(DVec3::as_vec3), sides: Sides::Two },
    };
    let mut rng = SplitMix64::new(5);
    for (size, allowed) in [(1.0, 1e-5), (0.1, 1e-5), (0.01, 1e-4), (0.001, 1e-3)] {
        let of_size: Vec<_> = (0..20_000)
            .map(|_| {
                let (u, v) = shapes::tangents(shapes::in_cube(&mut rng));
                let centre = DVec3::new(0.3, 0.2, 0.9) + 0.2 * shapes::in_cube(&mut rng);
                job(shapes::parallelogram(centre, u * size, v * size))
            })
            .collect();
        let truth = LightsF64.fractions(&of_size).unwrap();
        for back_end in lean_lights() {
            let values = back_end.fractions(&of_size).unwrap();
            let largest = truth.iter().copied().fold(0.0, f64::max);
            let mut worst = [0.0_f64; 2];
            for ((value, truth), job) in values.iter().zip(&truth).zip(&of_size) {
                let error = (value - truth).abs() / largest;
                // What is near the light's plane is held to the distance from it.
                let height = height_over_plane(job);
                let bound = if height > 0.01 { allowed } else { allowed + 1e-6 / height };
                worst[usize::from(height <= 0.01)] = worst[usize::from(height <= 0.01)].max(error);
                assert!(error < bound, "size {size}, {height} over the plane: {error}, {job:?}");
            }
            let [free, near] = worst;
            println!(
                "{}, size {size}: {free:.1e} of the brightest, near its plane {near:.1e}",
                back_end.name()
            );
        }
    }
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
    let degenerate: Vec<_> = [
        [x, -x, z - x, z + x],
        [y, y + z, 2.0 * y + z, 2.0 * y],
        [DVec3::ZERO, y, y + z, z],
        [-y, y, y + z, z - y],
        [x + z, x + z, x + z, x + z],
        [DVec3::ZERO; 4],
        [x, y, x, y],
        [x * 1e-6, y * 1e-6, z * 1e-6, (y + z) * 1e-6],
        [x * 1e6, y * 1e6, z * 1e6, (y + z - x) * 1e6],
        [z - x - y, z + x - y, z + x + y, z * 1e-20],
        [x * 1e-30, y, z, x * 1e6],
    ]
    .into_iter()
    .map(job)
    .collect();
    let below = job([x - z, y - z, -x - z, -y - z]);
    for back_end in lean_lights() {
        // Whatever is not finite is an error of the device's.
        let values = back_end.fractions(&degenerate).unwrap();
        assert!(values.iter().all(|value| (0.0..=1.0).contains(value)), "{values:?}");
        assert_eq!(back_end.fractions(std::slice::from_ref(&below)).unwrap(), [0.0], "it leaks");
    }
}
