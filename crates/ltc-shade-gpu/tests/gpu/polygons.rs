//! Polygons under lobes: GPU against `ltc_core` in both precisions.

use glam::{DMat3, DVec3, Mat3, Vec3};
use ltc_core::{Light as _, Ltc, Matrix, Polygon, Sides};
use ltc_shade_gpu::{Filtering, GpuError, PolygonJob, Polygons};
use ltc_table::Mapping;

use crate::support::{gpu, random};
use crate::tables;

/// The bound that the workspace promises between GPU, CPU f32 and CPU f64, absolute.
const TOLERANCE: f64 = 1e-4;

/// A random quad around the shading point: often partly below the horizon, seldom degenerate.
fn quad(rng: &mut impl FnMut() -> f64) -> Vec<[f32; 3]> {
    let mut vector = |scale: f64| DVec3::new(rng() - 0.5, rng() - 0.5, rng() - 0.5) * scale;
    let (centre, u, v) = (vector(4.0), vector(3.0), vector(3.0));
    [centre - u - v, centre + u - v, centre + u + v, centre - u + v].map(|p| p.as_vec3().to_array()).to_vec()
}

fn sides(rng: &mut impl FnMut() -> f64) -> Sides {
    if rng() < 0.5 { Sides::One } else { Sides::Two }
}

/// On the CPU in f64 and f32, from the same f32 inputs.
fn on_cpu(job: &PolygonJob<'_>) -> (f64, f64) {
    let single: Vec<_> = job.vertices.iter().map(|v| Vec3::from_array(*v)).collect();
    let double: Vec<_> = single.iter().map(|v| v.as_dvec3()).collect();
    let m = job.m.map(f64::from);
    let wide = Ltc::<f64>::new(DMat3::from_row_array(m)).unwrap();
    let narrow = Ltc::<f32>::new(Mat3::from_row_array(job.m)).unwrap();
    (
        Polygon::<f64>::new(&double, job.sides).unwrap().integrate(&wide),
        f64::from(Polygon::<f32>::new(&single, job.sides).unwrap().integrate(&narrow)),
    )
}

/// Largest differences of the GPU from f64 and from f32, and how many results are above 0.01.
fn compare(jobs: &[PolygonJob<'_>], results: &[f32]) -> (f64, f64, usize) {
    assert_eq!(jobs.len(), results.len());
    let (mut from_f64, mut from_f32, mut lit) = (0.0_f64, 0.0_f64, 0);
    for (job, result) in jobs.iter().zip(results) {
        assert!((0.0..=1.0).contains(result), "{result} for {job:?}");
        let (wide, narrow) = on_cpu(job);
        from_f64 = from_f64.max((wide - f64::from(*result)).abs());
        from_f32 = from_f32.max((narrow - f64::from(*result)).abs());
        lit += usize::from(wide > 0.01);
    }
    (from_f64, from_f32, lit)
}

/// Lobes of a table at random queries, and general random matrices of det > 0, in turn.
fn matrices(count: usize, rng: &mut impl FnMut() -> f64) -> Vec<[f32; 9]> {
    let table = tables::anisotropic(Mapping::Linear, Mapping::Linear);
    let mut list = Vec::with_capacity(count);
    while list.len() < count {
        if list.len() % 2 == 0 {
            let query = ltc_table::Query {
                theta: rng() * 1.5,
                phi: rng() * std::f64::consts::TAU,
                alpha_x: 0.01 + 0.99 * rng(),
                alpha_y: 0.01 + 0.99 * rng(),
            };
            list.push(table.lookup(&query).unwrap().lobes[0].m.map(|v| v as f32));
        } else {
            let mut m = [0.0; 9];
            m.fill_with(|| (rng() * 2.0 - 1.0) as f32);
            if Mat3::from_row_array(m).determinant() > 0.01 {
                list.push(m);
            }
        }
    }
    list
}

#[test]
fn random_quads_agree_on_both_paths() {
    let Some(gpu) = gpu(Filtering::Exact) else { return };
    let mut rng = random(1);
    let lobes = matrices(20_000, &mut rng);
    let quads: Vec<_> = lobes.iter().map(|_| (quad(&mut rng), sides(&mut rng))).collect();
    let jobs: Vec<_> = lobes
        .iter()
        .zip(&quads)
        .map(|(m, (vertices, sides))| PolygonJob { m: *m, vertices, sides: *sides })
        .collect();
    let polygons = Polygons::new(&gpu).unwrap();
    for (path, results) in [
        ("quads", polygons.integrate_quads(&gpu, &jobs).unwrap()),
        ("polygons", polygons.integrate(&gpu, &jobs).unwrap()),
    ] {
        let (from_f64, from_f32, lit) = compare(&jobs, &results);
        println!(
            "{path}: {lit} of {} lit, largest error {from_f64:.2e} from f64, {from_f32:.2e} from f32",
            jobs.len()
        );
        assert!(from_f64 <= TOLERANCE && from_f32 <= TOLERANCE, "{path}: {from_f64} {from_f32}");
        assert!(lit > 5_000, "too few lights light anything: {lit}");
    }
}

#[test]
fn a_planted_error_is_seen() {
    // The control of the test above: matrices that are off by a thousandth of their largest entry.
    let Some(gpu) = gpu(Filtering::Exact) else { return };
    let mut rng = random(1);
    let lobes = matrices(1_000, &mut rng);
    let quads: Vec<_> = lobes.iter().map(|_| quad(&mut rng)).collect();
    let job = |m: &[f32; 9], vertices| PolygonJob { m: *m, vertices, sides: Sides::Two };
    let right: Vec<_> = lobes.iter().zip(&quads).map(|(m, q)| job(m, q)).collect();
    let wrong: Vec<_> = right
        .iter()
        .map(|j| PolygonJob {
            m: [j.m[0] + 1e-3, j.m[1], j.m[2], j.m[3], j.m[4], j.m[5], j.m[6], j.m[7], j.m[8]],
            ..*j
        })
        .filter(|j| Mat3::from_row_array(j.m).determinant() > 0.0)
        .collect();
    assert_eq!(right.len(), wrong.len());
    let results = Polygons::new(&gpu).unwrap().integrate(&gpu, &wrong).unwrap();
    let (from_f64, from_f32, _) = compare(&right, &results);
    assert!(from_f64 > TOLERANCE && from_f32 > TOLERANCE, "{from_f64} {from_f32}");
}

#[test]
fn polygons_of_many_shapes_agree() {
    let Some(gpu) = gpu(Filtering::Exact) else { return };
    let mut rng = random(5);
    let lobes = matrices(2_000, &mut rng);
    // Flat stars of 3 to 40 corners, convex or not, tilted anywhere.
    let polygons: Vec<Vec<[f32; 3]>> = lobes
        .iter()
        .map(|_| {
            let corners = 3 + (rng() * 38.0) as usize;
            let centre = DVec3::new(rng() - 0.5, rng() - 0.5, rng() - 0.3) * 4.0;
            let turn = DMat3::from_euler(glam::EulerRot::XYZ, rng() * 6.0, rng() * 6.0, rng() * 6.0);
            (0..corners)
                .map(|i| {
                    let (sin, cos) = (std::f64::consts::TAU * i as f64 / corners as f64).sin_cos();
                    let p = turn * DVec3::new(cos, sin, 0.0) * (0.4 + 1.5 * rng()) + centre;
                    p.as_vec3().to_array()
                })
                .collect()
        })
        .collect();
    let jobs: Vec<_> = lobes
        .iter()
        .zip(&polygons)
        .map(|(m, vertices)| PolygonJob { m: *m, vertices, sides: Sides::Two })
        .collect();
    let results = Polygons::new(&gpu).unwrap().integrate(&gpu, &jobs).unwrap();
    let (from_f64, from_f32, lit) = compare(&jobs, &results);
    println!("stars: {lit} lit, largest error {from_f64:.2e} from f64, {from_f32:.2e} from f32");
    assert!(from_f64 <= TOLERANCE && from_f32 <= TOLERANCE);
    assert!(lit > 500);
}

#[test]
fn lights_below_the_horizon_add_exactly_nothing() {
    let Some(gpu) = gpu(Filtering::Exact) else { return };
    let mut rng = random(9);
    let lobes = matrices(4_000, &mut rng);
    // Flat, the highest corner just below the horizon.
    let quads: Vec<Vec<[f32; 3]>> = lobes
        .iter()
        .map(|_| {
            let corners = quad(&mut rng);
            let highest = corners.iter().map(|[.., z]| *z).fold(f32::MIN, f32::max) + 1e-6 + rng() as f32;
            corners.iter().map(|[x, y, z]| [*x, *y, *z - highest]).collect()
        })
        .collect();
    let jobs: Vec<_> = lobes
        .iter()
        .zip(&quads)
        .map(|(m, vertices)| PolygonJob { m: *m, vertices, sides: Sides::Two })
        .collect();
    let polygons = Polygons::new(&gpu).unwrap();
    assert!(polygons.integrate_quads(&gpu, &jobs).unwrap().iter().all(|v| *v == 0.0));
    assert!(polygons.integrate(&gpu, &jobs).unwrap().iter().all(|v| *v == 0.0));
    // The control: lifted above the horizon, nearly all of them light something.
    let lifted: Vec<Vec<[f32; 3]>> =
        quads.iter().map(|q| q.iter().map(|[x, y, z]| [*x, *y, -z]).collect()).collect();
    let jobs: Vec<_> = jobs.iter().zip(&lifted).map(|(j, q)| PolygonJob { vertices: q, ..*j }).collect();
    let lit = polygons.integrate_quads(&gpu, &jobs).unwrap().iter().filter(|v| **v > 0.0).count();
    assert!(lit > 3_000, "{lit}");
}

const COSINE: [f32; 9] = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];

#[test]
fn degenerate_quads_are_dark_and_scale_does_not_matter() {
    let Some(gpu) = gpu(Filtering::Exact) else { return };
    let p = [0.3, 0.2, 1.0];
    let point = [p; 4];
    let origin = [[0.0; 3]; 4];
    let ray = [1.0_f32, 2.0, 3.0, 4.0].map(|s| p.map(|x| x * s));
    let in_plane = [[-1.0, 0.0, 0.5], [1.0, 0.0, 0.5], [1.0, 0.0, -0.5], [-1.0, 0.0, -0.5]];
    let line = [[-1.0, 0.0, 0.5], [1.0, 0.0, 0.5], [1.0, 0.0, 0.5], [-1.0, 0.0, 0.5]];
    let on_horizon = [[-1.0, -1.0, 0.0], [-1.0, 1.0, 0.0], [1.0, 1.0, 0.0], [1.0, -1.0, 0.0]];
    let denormal = [[1e-39, 0.0, 1e-39], [0.0, 1e-39, 1e-39], [-1e-39, 0.0, 1e-39], [0.0, -1e-39, 1e-39]];
    let job = |vertices| PolygonJob { m: COSINE, vertices, sides: Sides::Two };
    let jobs = [&point, &origin, &ray, &in_plane, &line, &on_horizon].map(|q| job(q.as_slice()));
    let polygons = Polygons::new(&gpu).unwrap();
    assert_eq!(polygons.integrate_quads(&gpu, &jobs).unwrap(), [0.0; 6]);
    assert_eq!(polygons.integrate(&gpu, &jobs).unwrap(), [0.0; 6]);
    let flushed = polygons.integrate_quads(&gpu, &[job(&denormal)]).unwrap()[0];
    assert!((0.0..=1.0).contains(&flushed));

    let square = [[-0.5, -0.5, 1.0], [-0.5, 0.5, 1.0], [0.5, 0.5, 1.0], [0.5, -0.5, 1.0]];
    let scaled = [1e-30_f32, 1e-6, 1.0, 1e6, 1e30].map(|s| square.map(|v| v.map(|x: f32| x * s)));
    let jobs: Vec<_> = scaled.iter().map(|q| PolygonJob { sides: Sides::One, ..job(q) }).collect();
    let expected = on_cpu(&jobs[2]).0;
    for result in polygons.integrate_quads(&gpu, &jobs).unwrap() {
        assert!((f64::from(result) - expected).abs() < 1e-6, "{result}");
    }
    let from_behind: Vec<_> = square.iter().rev().copied().collect();
    let jobs = [PolygonJob { sides: Sides::One, ..job(&from_behind) }, job(&from_behind)];
    let results = polygons.integrate(&gpu, &jobs).unwrap();
    assert_eq!(results[0], 0.0);
    assert!((f64::from(results[1]) - expected).abs() < 1e-6);
}

#[test]
fn invalid_jobs_are_refused_by_index() {
    let Some(gpu) = gpu(Filtering::Exact) else { return };
    let polygons = Polygons::new(&gpu).unwrap();
    let square = [[-1.0, -1.0, 1.0], [-1.0, 1.0, 1.0], [1.0, 1.0, 1.0], [1.0, -1.0, 1.0]];
    let good = PolygonJob { m: COSINE, vertices: &square, sides: Sides::One };
    let mut broken = square;
    broken[2][1] = f32::NAN;
    let flat = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    for bad in [
        PolygonJob { vertices: &broken, ..good },
        PolygonJob { vertices: &square[..2], ..good },
        PolygonJob { m: flat, ..good },
        PolygonJob { m: [f32::INFINITY; 9], ..good },
    ] {
        let error = polygons.integrate(&gpu, &[good, good, bad]).unwrap_err();
        assert!(matches!(error, GpuError::Input { index: 2, .. }), "{error}");
    }
    let triangle = PolygonJob { vertices: &square[..3], ..good };
    assert!(polygons.integrate(&gpu, &[triangle]).is_ok());
    assert!(matches!(
        polygons.integrate_quads(&gpu, &[good, triangle]),
        Err(GpuError::Input { index: 1, .. })
    ));
    assert!(polygons.integrate(&gpu, &[]).unwrap().is_empty());
}
