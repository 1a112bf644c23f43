//! Mixtures: what they accept, and that they are the sum of their parts.

use glam::{DMat3, DVec3, Vec3, dvec3};
use ltc_core::points::{SplitMix64, r2};
use ltc_core::{ClosedForm, Distribution, Horizon, InputError, Light, Ltc, LtcMixture, Polygon, Sides};
use ltc_reference::{AboveHorizon, LtcLobe, PolygonOptions, Tolerance, integrate_polygon};

use crate::support::{matrix, star};

#[test]
fn integrals_match_the_cubature_of_the_mixed_density() {
    let mut random = SplitMix64::new(31);
    for _ in 0..40 {
        let matrices = [0; 3].map(|_| matrix(&mut random, 20.0));
        let weights = [0.5, 0.2, 0.3];
        let mixture =
            LtcMixture::new(weights.into_iter().zip(matrices.map(|m| Ltc::<f64>::new(m).unwrap()))).unwrap();
        let oracle = ltc_reference::LtcMixture {
            parts: weights.into_iter().zip(matrices.map(|m| LtcLobe::new(m).unwrap())).collect(),
        };
        let polygon = star(&mut random, dvec3(0.3, -0.2, 0.8), 1.0);
        let options = PolygonOptions { two_sided: true, tolerance: Tolerance::absolute(2e-10) };
        let expected = integrate_polygon(&AboveHorizon(oracle), &polygon, options).unwrap().value;
        let light = Polygon::new(&polygon, Sides::Two).unwrap();
        let got = mixture.integrate(&light);
        assert!((got - expected).abs() < 1e-9, "{got} {expected}");
        let dynamic: &dyn ClosedForm<f64> = &mixture;
        assert_eq!(dynamic.integrate(&light), got);
        assert_eq!(
            dynamic.integrate_within(&light, Horizon::COSINE),
            mixture.integrate_within(&light, Horizon::COSINE)
        );
    }
}

#[test]
fn one_lobe_is_that_lobe() {
    let mut random = SplitMix64::new(32);
    let ltc = Ltc::<f64>::new(matrix(&mut random, 5.0)).unwrap();
    let mixture = LtcMixture::from(ltc);
    for i in 0..100 {
        let u = r2(i, [0.5, 0.5]);
        assert_eq!(mixture.sample(u), ltc.sample(u));
        assert_eq!(Distribution::density(&mixture, ltc.sample(u)), ltc.density(ltc.sample(u)));
    }
    let polygon = star(&mut random, DVec3::Z, 0.5);
    let light = Polygon::new(&polygon, Sides::Two).unwrap();
    assert_eq!(mixture.integrate(&light), light.integrate(&ltc));
}

#[test]
fn stratified_points_stay_stratified_within_each_lobe() {
    // Of n strata of u[0], those of one lobe map to its own [0, 1) in order and evenly: radii √u of a flat lobe tell.
    let up = Ltc::<f64>::cosine();
    let down = Ltc::<f64>::new(DMat3::from_rotation_x(core::f64::consts::PI)).unwrap();
    let mixture = LtcMixture::new([(0.25, up), (0.75, down)]).unwrap();
    let n = 400;
    let (mut above, mut below) = (Vec::new(), Vec::new());
    for i in 0..n {
        let w = mixture.sample([(f64::from(i) + 0.5) / f64::from(n), 0.3]);
        let radius = w.x * w.x + w.y * w.y;
        if w.z > 0.0 { above.push(radius) } else { below.push(radius) }
    }
    assert_eq!((above.len(), below.len()), (100, 300));
    for radii in [above, below] {
        let count = radii.len() as f64;
        assert!(radii.iter().enumerate().all(|(i, r)| (r - (i as f64 + 0.5) / count).abs() < 1e-12));
    }
}

#[test]
fn weights_are_checked_and_normalised() {
    let lobe = Ltc::<f32>::cosine();
    assert_eq!(LtcMixture::<f32>::new([]), Err(InputError::Empty { name: "mixture" }));
    for (weights, fault) in [
        ([0.5, f32::NAN], "weight is not a finite number"),
        ([0.5, f32::INFINITY], "weight is not a finite number"),
        ([1.1, -0.1], "weight is 1.1"),
        ([-0.0005, 1.0], "weight is -0.0005"),
        ([0.5, 0.4], "sum of weights is 0.9"),
        ([0.6, 0.5], "sum of weights is 1.1"),
        ([0.0, 0.0], "sum of weights is 0"),
    ] {
        let error = LtcMixture::new(weights.map(|w| (w, lobe))).unwrap_err().to_string();
        assert!(error.starts_with(fault), "{weights:?}: {error}");
    }
    // Within the tolerance: what half floats make of 0.3 and 0.7.
    let mixture = LtcMixture::new([(0.300_05, lobe), (0.700_2, lobe)]).unwrap();
    let sum: f32 = mixture.lobes().iter().map(|(weight, _)| weight).sum();
    assert!((sum - 1.0).abs() <= f32::EPSILON, "{sum}");
    assert!((mixture.density(Vec3::Z) - lobe.density(Vec3::Z)).abs() < 1e-6);
}

#[test]
fn the_ends_of_the_unit_interval_are_in_some_lobe() {
    let flipped = Ltc::<f32>::new(glam::Mat3::from_rotation_x(3.0)).unwrap();
    let mixture =
        LtcMixture::new([(0.0, flipped), (0.1, Ltc::cosine()), (0.9, flipped), (0.0, Ltc::cosine())])
            .unwrap();
    let last = 1.0 - 0.5 * f32::EPSILON;
    for u in [0.0, f32::MIN_POSITIVE, 0.1, 0.1 - 1e-8, 0.5, last, 1.0] {
        let w = mixture.sample([u, last]);
        assert!(w.is_normalized() && mixture.density(w) >= 0.0, "{u}: {w}");
    }
    assert!(flipped.density(mixture.sample([0.99, 0.2])) > 0.0, "a lobe without weight is never drawn");
    assert!(Ltc::<f32>::cosine().density(mixture.sample([0.0, 0.2])) > 0.0);
}
