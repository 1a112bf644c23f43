//! LTC lobes: normalisation, sampling, invariances.

mod common;

use glam::{DMat3, DVec3};
use ltc_reference::{
    AboveHorizon, BaseShape, CosineLobe, Lobe, LtcLobe, LtcMixture, ReferenceError, Scaled, SplitMix64,
    Tolerance, TransformedLobe, integrate_sphere, lobe_mass, sphere_direction,
};

fn mass(lobe: &impl Lobe) -> f64 {
    lobe_mass(lobe, Tolerance::absolute(1e-9)).expect("the oracle converges on valid input").value
}

#[test]
fn random_ltcs_integrate_to_one() {
    let mut random = SplitMix64::new(1);
    for condition in [1.0, 10.0, 100.0, 1e3] {
        for _ in 0..10 {
            let ltc = common::ltc(&mut random, condition);
            let total = mass(&ltc);
            assert!((total - 1.0).abs() < 1e-9, "condition {condition}: {total}");
        }
    }
}

#[test]
fn a_kink_that_nobody_knows_costs_accuracy() {
    let mut random = SplitMix64::new(1);
    let mut worst = 0.0f64;
    for _ in 0..30 {
        let ltc = common::ltc(&mut random, 30.0);
        let blind = integrate_sphere(|w| ltc.density(w), &[], &ltc.hints(), Tolerance::absolute(1e-6))
            .expect("the oracle converges on valid input");
        assert!((blind.value - 1.0).abs() < 1e-4, "{blind:?}");
        worst = worst.max((blind.value - 1.0).abs());
    }
    // Were it not so, the list of kinks would be idle.
    assert!(worst > 1e-8, "{worst}");
}

#[test]
fn a_wrong_jacobian_does_not_integrate_to_one() {
    let mut random = SplitMix64::new(2);
    for _ in 0..5 {
        let ltc = common::ltc(&mut random, 10.0);
        // Forgotten determinant, and a square in place of the cube.
        let inverse = ltc.cosine_from_target();
        let no_determinant = Scaled { lobe: ltc, factor: 1.0 / inverse.determinant().abs() };
        assert!((mass(&no_determinant) - 1.0).abs() > 1e-2);
        let squared = |w: DVec3| ltc.density(w) * (inverse * w).length();
        let total = integrate_sphere(squared, &ltc.kinks(), &ltc.hints(), Tolerance::absolute(1e-5))
            .expect("the oracle converges on valid input")
            .value;
        assert!((total - 1.0).abs() > 1e-2, "{total}");
    }
}

#[test]
fn samples_follow_the_density() {
    // E[g(w)] over samples against ∫ g D, with g a smooth function without symmetry.
    let g = |w: DVec3| (1.3 * w.x + 0.4 * w.y - 0.9 * w.z).sin() + w.x * w.y;
    let mut random = SplitMix64::new(3);
    for condition in [1.0, 10.0, 100.0] {
        let ltc = common::ltc(&mut random, condition);
        let n = 200_000;
        let values: Vec<f64> = (0..n).map(|_| g(ltc.sample(random.next_2d()))).collect();
        let mean = values.iter().sum::<f64>() / f64::from(n);
        let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / f64::from(n);
        let sigma = (variance / f64::from(n)).sqrt();
        let expected = |lobe: &LtcLobe| {
            let f = |w: DVec3| g(w) * lobe.density(w);
            integrate_sphere(f, &lobe.kinks(), &lobe.hints(), Tolerance::absolute(1e-5))
                .expect("the oracle converges on valid input")
                .value
        };
        assert!((mean - expected(&ltc)).abs() < 5.0 * sigma + 1e-5, "condition {condition}");
        // Negative control: the lobe of the transposed matrix is another one.
        let transposed =
            LtcLobe::new(ltc.target_from_cosine().transpose()).expect("the oracle converges on valid input");
        assert!((mean - expected(&transposed)).abs() > 20.0 * sigma, "condition {condition}");
    }
}

#[test]
fn scale_and_rotation_about_the_cosine_axis_leave_a_lobe_alone() {
    let mut random = SplitMix64::new(4);
    for _ in 0..50 {
        let ltc = common::ltc(&mut random, 100.0);
        let m = ltc.target_from_cosine();
        let same = [
            LtcLobe::new(m * 1e-30).expect("the oracle converges on valid input"),
            LtcLobe::new(m * DMat3::from_rotation_z(0.7)).expect("the oracle converges on valid input"),
        ];
        let other =
            LtcLobe::new(m * DMat3::from_rotation_x(0.7)).expect("the oracle converges on valid input");
        let mut differs = 0.0f64;
        for _ in 0..50 {
            let w = ltc.sample(random.next_2d());
            let density = ltc.density(w);
            for same in &same {
                assert!((same.density(w) - density).abs() < 1e-9 * density, "{m}");
            }
            differs = differs.max((other.density(w) / density - 1.0).abs());
        }
        assert!(differs > 0.01, "a rotation about x must show: {m}");
    }
}

#[test]
fn the_identity_is_the_cosine_and_half_spaces_bound_the_support() {
    let mut random = SplitMix64::new(5);
    let identity = LtcLobe::new(DMat3::IDENTITY).expect("the oracle converges on valid input");
    let ltc = common::ltc(&mut random, 10.0);
    let clipped = AboveHorizon(ltc);
    let mixture = LtcMixture { parts: vec![(0.25, identity), (0.75, ltc)] };
    for _ in 0..1000 {
        let w = sphere_direction(random.next_2d());
        assert!((identity.density(w) - CosineLobe.density(w)).abs() < 1e-15);
        let inside = clipped.half_spaces().iter().all(|n| n.dot(w) > 0.0);
        assert_eq!(clipped.density(w) > 0.0, inside, "{w}");
        let mixed = 0.25 * identity.density(w) + 0.75 * ltc.density(w);
        assert!((mixture.density(w) - mixed).abs() < 1e-15);
    }
    assert!((mass(&mixture) - 1.0).abs() < 1e-9);
}

#[test]
fn a_turned_cosine_leaks_as_much_as_the_formula_says() {
    for angle in [0.1f64, 1.0, 2.5] {
        let cut = AboveHorizon(
            LtcLobe::new(DMat3::from_rotation_y(angle)).expect("the oracle converges on valid input"),
        );
        // A lune between two half-planes at this angle: (1 + cos) / 2 of the cosine is left.
        assert!((mass(&cut) - 0.5 * (1.0 + angle.cos())).abs() < 1e-9, "{angle}");
    }
    let mut random = SplitMix64::new(6);
    for _ in 0..10 {
        let ltc = common::ltc(&mut random, 30.0);
        let n = 100_000;
        let above = (0..n).filter(|_| ltc.sample(random.next_2d()).z > 0.0).count() as f64 / f64::from(n);
        assert!((mass(&AboveHorizon(ltc)) - above).abs() < 5.0 * (0.25 / f64::from(n)).sqrt(), "{above}");
    }
}

#[test]
fn singular_and_non_finite_matrices_are_errors() {
    assert!(matches!(LtcLobe::new(DMat3::ZERO), Err(ReferenceError::SingularMatrix { .. })));
    let flat = DMat3::from_diagonal(DVec3::new(1.0, 1.0, 0.0));
    assert!(matches!(LtcLobe::new(flat), Err(ReferenceError::SingularMatrix { .. })));
    let nan = DMat3::from_diagonal(DVec3::new(1.0, f64::NAN, 1.0));
    assert!(matches!(LtcLobe::new(nan), Err(ReferenceError::NonFiniteInput { .. })));
}

#[test]
fn every_transformed_base_integrates_to_one_and_they_differ() {
    let mut random = SplitMix64::new(7);
    for condition in [1.0, 10.0, 300.0] {
        let ltc = common::ltc(&mut random, condition);
        let w = ltc.sample([0.3, 0.2]);
        let mut densities = Vec::new();
        for shape in BaseShape::ALL {
            let lobe = TransformedLobe::new(shape, ltc.target_from_cosine()).unwrap();
            let total = mass(&lobe);
            assert!((total - 1.0).abs() < 1e-8, "{shape:?}, condition {condition}: {total}");
            densities.push(lobe.density(w));
        }
        assert!((densities[2] / ltc.density(w) - 1.0).abs() < 1e-12, "the cosine is the LTC");
        // cos² θ = 1 - 0.3 here, so that the densities are 1/4π, 1/2π, √0.7/π and 1.05/π times the same Jacobian.
        let expected = [0.25, 0.5, 0.7f64.sqrt(), 1.05].map(|d| d / 0.25);
        for (density, expected) in densities.iter().zip(expected) {
            assert!((density / densities[0] / expected - 1.0).abs() < 1e-9, "{densities:?}");
        }
    }
}
