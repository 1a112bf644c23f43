//! CPU f64, CPU f32 and GPU give the same light for the same materials and quads.

#![expect(clippy::unwrap_used, reason = "a test fails by a panic")]

use core::f64::consts::FRAC_PI_2;

use glam::DMat3;
use ltc_core::Matrix;
use ltc_core::points::SplitMix64;
use ltc_shade_gpu::{Lookups, TableTextures};
use ltc_table::Query;
use ltc_tests::{
    BackEnd, CpuF32, CpuF64, Gpu, Job, Path, lit, lit_share, pairs, shapes, table, tolerance, wide,
};

/// Pairs for each of the two tables.
const PAIRS: usize = 10_000;

/// Every back end that can run here.
fn back_ends() -> Vec<Box<dyn BackEnd>> {
    let mut list: Vec<Box<dyn BackEnd>> = vec![Box::new(CpuF64), Box::new(CpuF32)];
    for path in [Path::Polygons, Path::Quads] {
        if let Some(gpu) = Gpu::open(path) {
            list.push(Box::new(gpu));
        }
    }
    list
}

/// The largest difference between two back ends' results.
fn largest(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

fn assert_fractions(name: &str, values: &[f64]) {
    assert!(values.iter().all(|v| (0.0..=1.0).contains(v)), "{name}: a result is no fraction");
}

/// All results of all back ends for these jobs, each pair of back ends compared.
fn assert_agreement(what: &str, jobs: &[Job]) -> Vec<f64> {
    let results: Vec<_> = back_ends()
        .iter()
        .map(|back_end| {
            let values = back_end.fractions(jobs).unwrap();
            assert_fractions(back_end.name(), &values);
            (back_end.name(), values)
        })
        .collect();
    for (i, (a, values)) in results.iter().enumerate() {
        for (b, others) in &results[..i] {
            let difference = largest(values, others);
            println!("{what}: {a} and {b} differ by up to {difference:.2e}");
            assert!(difference <= tolerance::BACK_ENDS, "{what}: {a} and {b} differ by {difference:e}");
        }
    }
    results.into_iter().next().unwrap().1
}

#[test]
fn materials_and_quads_agree_on_all_back_ends() {
    for (name, seed) in [("ggx-anisotropic", 11), ("ggx-isotropic", 12)] {
        let jobs: Vec<Job> = pairs(&table(name), PAIRS, seed).into_iter().map(|(_, job)| job).collect();
        let lit = lit_share(&assert_agreement(name, &jobs));
        println!("{name}: {:.0} % of the pairs are lit", 100.0 * lit);
        assert!(lit > 0.4, "{name}: only {lit} of the pairs are lit");
    }
}

#[test]
fn materials_and_stars_agree_on_all_back_ends() {
    // Three to twelve corners, convex or not, one and two-sided, above and below the horizon.
    let mut rng = SplitMix64::new(5);
    let jobs: Vec<Job> = pairs(&table("ggx-anisotropic"), 2_000, 13)
        .into_iter()
        .map(|(_, job)| {
            let vertices = job.vertices_f64();
            let centre = (vertices[0] + vertices[2]) * 0.5;
            let corners = 3 + (rng.unit() * 10.0) as usize;
            let radius = (vertices[0] - centre).length();
            job.lit_by(&shapes::star(&mut rng, centre, radius, corners))
        })
        .collect();
    let lit = lit_share(&assert_agreement("stars", &jobs));
    assert!(lit > 0.2, "only {lit} of the stars are lit");
}

#[test]
fn a_wrong_matrix_is_noticed_on_every_back_end() {
    // The control of the tests above: a thousandth of the largest entry added to one other.
    let right: Vec<Job> = pairs(&table("ggx-anisotropic"), 500, 11).into_iter().map(|(_, job)| job).collect();
    let wrong: Vec<Job> = right
        .iter()
        .map(|job| {
            let mut m = job.m_f64();
            m.z_axis.x += 1e-3 * m.to_cols_array().into_iter().map(f64::abs).fold(0.0, f64::max);
            job.under(m)
        })
        .collect();
    let truth = CpuF64.fractions(&right).unwrap();
    for back_end in back_ends() {
        let difference = largest(&back_end.fractions(&wrong).unwrap(), &truth);
        assert!(difference > tolerance::BACK_ENDS, "{}: {difference}", back_end.name());
    }
}

/// The device's own lookups of these queries, as matrices.
fn looked_up(gpu: &Gpu, name: &str, queries: &[Query]) -> Vec<DMat3> {
    let device = gpu.device();
    let textures = TableTextures::upload(device, &table(name)).unwrap();
    let results = Lookups::new(device).unwrap().lookup(device, &textures, queries).unwrap();
    results.iter().map(|r| DMat3::from_row_array(r.m.map(f64::from))).collect()
}

/// The device looks up and integrates what the CPU looked up and integrated in double precision.
fn assert_whole_way(gpu: &Gpu, name: &str, pairs: Vec<(Query, Job)>, tolerance: f64) {
    let (queries, jobs): (Vec<Query>, Vec<Job>) = pairs.into_iter().unzip();
    let matrices = looked_up(gpu, name, &queries);
    for (m, query) in matrices.iter().zip(&queries) {
        assert!(m.determinant() > 0.0, "{name}: the device has det M = {} at {query:?}", m.determinant());
    }
    let by_device: Vec<Job> = jobs.iter().zip(matrices).map(|(job, m)| job.under(m)).collect();
    let (far, truth) = (gpu.fractions(&by_device).unwrap(), CpuF64.fractions(&jobs).unwrap());
    assert_fractions(gpu.name(), &far);
    let difference = largest(&far, &truth);
    println!("{name}: looked up and integrated on the device: up to {difference:.2e} from CPU f64");
    assert!(difference <= tolerance, "{name}: {difference:e}");
}

#[test]
fn the_whole_way_from_material_to_light_agrees() {
    // Here not only the arithmetic differs but the lookup, too: f64 on the CPU, f32 textures on the device.
    let Some(gpu) = Gpu::open(Path::Quads) else { return };
    for (name, seed) in [("ggx-anisotropic", 21), ("ggx-isotropic", 22)] {
        assert_whole_way(&gpu, name, pairs(&table(name), PAIRS, seed), tolerance::BACK_ENDS);
    }
}

#[test]
fn the_whole_way_agrees_beyond_the_standard_draw() {
    let Some(gpu) = Gpu::open(Path::Quads) else { return };
    for (name, lambda, seed) in [("ggx-anisotropic", 0.0, 23), ("ggx-isotropic", 1.0, 24)] {
        let queries = wide(4 * PAIRS, lambda, FRAC_PI_2, seed);
        assert_whole_way(&gpu, name, lit(&table(name), &queries, seed), tolerance::NARROW);
    }
}
