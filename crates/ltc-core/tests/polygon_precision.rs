//! What `f32` costs: polygons, quads and batches in `f32` against `f64` on the very same rounded inputs, and `f64` against
//! the oracle.

#![expect(clippy::unwrap_used, reason = "a test fails by a panic")]

mod common;

use common::{Case, SWEEPS, Statistics, Sweep, case};
use glam::{DMat3, DVec3, Vec3};
use ltc_core::points::SplitMix64;
use ltc_core::{Horizon, Light, Ltc, LtcBatch, Polygon, Quad, QuadBatch, Sides};
use ltc_reference::{AboveHorizon, LtcLobe, PolygonOptions, Tolerance, integrate_polygon_boundary};

fn exact(m: DMat3, quad: &[DVec3; 4]) -> f64 {
    Polygon::<f64>::new(quad, Sides::Two).unwrap().integrate(&Ltc::new(m).unwrap())
}

fn cases(sweep: Sweep, count: usize) -> Vec<Case> {
    let mut rng = SplitMix64::new(17);
    (0..count).map(|_| case(&mut rng, sweep)).collect()
}

/// Each form's errors as multiples of the bound, and the error that rounding the inputs alone makes.
struct Precision {
    polygon: Statistics,
    quad: Statistics,
    batch: Statistics,
    inputs: Statistics,
}

fn precision(cases: &[Case]) -> Precision {
    let (mut quads, mut ltcs) = (QuadBatch::new(), LtcBatch::new());
    for c in cases {
        quads.push(Quad::<f32>::new(c.quad.map(DVec3::as_vec3), Sides::Two).unwrap());
        ltcs.push(Ltc::<f32>::new(c.m.as_mat3()).unwrap());
    }
    let mut batched = vec![0.0; cases.len()];
    quads.integrate_each(&ltcs, Horizon::BOTH, &mut batched).unwrap();
    let mut p = [Statistics::default(); 4];
    for (i, c) in cases.iter().enumerate() {
        let rounded = c.quad.map(DVec3::as_vec3);
        let ltc = Ltc::<f32>::new(c.m.as_mat3()).unwrap();
        let truth = exact(c.m.as_mat3().as_dmat3(), &rounded.map(Vec3::as_dvec3));
        let polygon = Polygon::<f32>::new(&rounded, Sides::Two).unwrap().integrate(&ltc);
        let quad = Quad::<f32>::new(rounded, Sides::Two).unwrap().integrate(&ltc);
        for (statistics, value) in p.iter_mut().zip([polygon, quad, batched[i]]) {
            assert!((0.0..=1.0).contains(&value), "{value} for {c:?}");
            let error = (f64::from(value) - truth) / c.tolerance();
            assert!(error.abs() <= 1.0, "{value}, not {truth}: {error} of the bound, for {c:?}");
            statistics.add(error);
        }
        p[3].add((truth - exact(c.m, &c.quad)) / c.tolerance());
    }
    let [polygon, quad, batch, inputs] = p;
    Precision { polygon, quad, batch, inputs }
}

#[test]
fn f32_keeps_to_its_bound_over_all_sweeps() {
    println!("largest error as a fraction of the bound 2e-5 · max(1, cond/100)");
    println!("{:10} {:>9} {:>9} {:>9} {:>9}", "sweep", "polygon", "quad", "batch", "inputs");
    for sweep in SWEEPS {
        let p = precision(&cases(sweep, 20_000));
        let [polygon, quad, batch, inputs] = [p.polygon, p.quad, p.batch, p.inputs].map(|s| s.max);
        println!("{:10} {polygon:9.4} {quad:9.4} {batch:9.4} {inputs:9.2}", format!("{sweep:?}"));
    }
}

#[test]
fn f64_is_the_oracle_to_1e_9() {
    let options = PolygonOptions {
        two_sided: true,
        tolerance: Tolerance { absolute: 1e-11, relative: 0.0, max_evaluations: 1_000_000 },
    };
    println!("{:10} {:>9} {:>9} {:>9}", "sweep", "polygon", "quad", "leak");
    for sweep in SWEEPS {
        let (mut polygon, mut quad, mut leak) =
            (Statistics::default(), Statistics::default(), Statistics::default());
        for c in cases(sweep, 400) {
            let lobe = LtcLobe::new(c.m).unwrap();
            let truth = integrate_polygon_boundary(&lobe, true, &c.quad, options).unwrap().value;
            let leaky = integrate_polygon_boundary(&lobe, false, &c.quad, options).unwrap().value;
            let ltc = Ltc::<f64>::new(c.m).unwrap();
            let light = Quad::<f64>::new(c.quad, Sides::Two).unwrap();
            for (statistics, value) in
                [(&mut polygon, exact(c.m, &c.quad)), (&mut quad, light.integrate(&ltc))]
            {
                statistics.add(value - truth);
                assert!((value - truth).abs() < 1e-9, "{value} {truth} {c:?}");
            }
            let cosine_only = light.integrate_within(&ltc, Horizon::COSINE);
            assert!((cosine_only - leaky).abs() < 1e-9, "{cosine_only} {leaky} {c:?}");
            leak.add(leaky - truth);
        }
        println!("{:10} {:9.1e} {:9.1e} {:9.1e}", format!("{sweep:?}"), polygon.max, quad.max, leak.max);
    }
}

/// The control: the same comparison sees an edge that is left out, and a light that is not cut.
#[test]
fn a_planted_error_is_seen() {
    let mut seen = [0; 2];
    let cases = cases(Sweep::Scale, 300);
    for c in &cases {
        let truth = exact(c.m, &c.quad);
        let ltc = Ltc::<f64>::new(c.m).unwrap();
        let triangle = Polygon::<f64>::new(&c.quad[..3], Sides::Two).unwrap().integrate(&ltc);
        let leaky = Polygon::<f64>::new(&c.quad, Sides::Two).unwrap().integrate_within(&ltc, Horizon::COSINE);
        seen[0] += usize::from((triangle - truth).abs() > c.tolerance());
        seen[1] += usize::from((leaky - truth).abs() > c.tolerance());
    }
    assert!(seen[0] > 250 && seen[1] > 50, "{seen:?}");
}

/// Cubature of the density knows nothing of edges at all; slower, so fewer and milder.
#[test]
fn f64_is_the_cubature_too() {
    let options = PolygonOptions {
        two_sided: true,
        tolerance: Tolerance { absolute: 1e-10, relative: 0.0, max_evaluations: 20_000_000 },
    };
    let mut rng = SplitMix64::new(5);
    for _ in 0..12 {
        let c = case(&mut rng, Sweep::Scale);
        let lobe = AboveHorizon(LtcLobe::new(c.m).unwrap());
        let truth = ltc_reference::integrate_polygon(&lobe, &c.quad, options).unwrap().value;
        assert!((exact(c.m, &c.quad) - truth).abs() < 1e-9, "{truth} {c:?}");
    }
}

/// Small distant lights are bright ones: their values keep their leading digits, not their absolute error alone.
#[test]
fn small_distant_lights_keep_their_digits() {
    let mut rng = SplitMix64::new(9);
    for size in [1e-1, 1e-2, 1e-3, 1e-4] {
        let (mut quads, mut ltcs, mut truths) = (QuadBatch::new(), LtcBatch::new(), Vec::new());
        let mut single = Statistics::default();
        for _ in 0..2000 {
            let (m, _) = common::lobe(&mut rng, 0.3, 0.8);
            let axis = (m * DVec3::Z).normalize_or_zero();
            let [u, v] = common::across(&mut rng, axis);
            let quad = common::parallelogram(axis, u * size, v * size).map(DVec3::as_vec3);
            let truth = exact(m.as_mat3().as_dmat3(), &quad.map(Vec3::as_dvec3));
            let (light, ltc) =
                (Quad::<f32>::new(quad, Sides::Two).unwrap(), Ltc::<f32>::new(m.as_mat3()).unwrap());
            single.add(f64::from(light.integrate(&ltc)) / truth - 1.0);
            quads.push(light);
            ltcs.push(ltc);
            truths.push(truth);
        }
        let mut out = vec![0.0; truths.len()];
        quads.integrate_each(&ltcs, Horizon::BOTH, &mut out).unwrap();
        let mut batch = Statistics::default();
        out.iter().zip(&truths).for_each(|(value, truth)| batch.add(f64::from(*value) / truth - 1.0));
        println!("size {size:e}: relative error {:.1e} one by one, {:.1e} batched", single.max, batch.max);
        assert!(single.max < 3e-6 && batch.max < 1e-6 / size, "{size}: {} {}", single.max, batch.max);
    }
}
