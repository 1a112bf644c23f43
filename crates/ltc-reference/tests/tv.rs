//! Total variation by cubature against known values and against the estimator of the fit.

mod common;

use std::f64::consts::PI;

use glam::{DMat3, DVec3, dvec3};
use ltc_reference::{
    AboveHorizon, CosineLobe, Ggx, Lobe, LtcLobe, R2, ReferenceError, SplitMix64, Tolerance,
    directional_albedo, ggx_total_variation, total_variation, view_direction,
};

const TOLERANCE: f64 = 1e-4;

fn tv(p: &impl Lobe, q: &impl Lobe) -> f64 {
    total_variation(p, q, Tolerance::absolute(TOLERANCE)).expect("the oracle converges on valid input").value
}

#[test]
fn known_distances() {
    let ltc = common::ltc(&mut SplitMix64::new(1), 100.0);
    assert!(tv(&ltc, &ltc) < TOLERANCE);
    // Opposite cosines have nothing in common.
    let down = LtcLobe::new(DMat3::from_diagonal(dvec3(1.0, 1.0, -1.0)))
        .expect("the oracle converges on valid input");
    assert!((tv(&CosineLobe, &down) - 1.0).abs() < TOLERANCE);
    // A cosine and the uniform hemisphere: (1/2π) ∫ |2 cos θ - 1| / 2 dw = ½ ∫₀¹ |2z - 1| dz = 1/4.
    let uniform = |w: DVec3| if w.z > 0.0 { 0.5 / PI } else { 0.0 };
    assert!((tv(&CosineLobe, &uniform) - 0.25).abs() < TOLERANCE);
    // Two cosines at an angle β: the lune where one exceeds the other has TV = sin(β/2).
    for beta in [0.1, 0.5, 1.5] {
        let tilted = LtcLobe::new(DMat3::from_rotation_x(beta)).expect("the oracle converges on valid input");
        assert!((tv(&CosineLobe, &tilted) - (0.5 * beta).sin()).abs() < TOLERANCE, "{beta}");
    }
}

/// `E_p[max(0, 1 - q/p)]` over visible-normal samples of the GGX lobe.
fn sampled(ggx: &Ggx, wo: DVec3, q: &impl Lobe, samples: u64) -> f64 {
    let points = R2::new();
    let (mut sum, mut mass) = (0.0, 0.0);
    let magnitude = directional_albedo(ggx, wo, Tolerance::absolute(1e-6))
        .expect("the oracle converges on valid input")
        .magnitude
        .value;
    for i in 0..samples {
        if let Some((wi, pdf)) = ggx.sample(wo, points.point(i)) {
            let p = ggx.eval_cos(wo, wi) / magnitude;
            sum += (p - q.density(wi)).max(0.0) / pdf;
            mass += p / pdf;
        }
    }
    assert!((mass / samples as f64 - 1.0).abs() < 2e-3);
    sum / samples as f64
}

/// A crude LTC near a GGX lobe: the cosine, narrowed and turned to the mirror direction.
fn crude_fit(ggx: &Ggx, wo: DVec3) -> LtcLobe {
    let axis = dvec3(-wo.x, -wo.y, wo.z);
    let (x, y) = axis.any_orthonormal_pair();
    let width = (ggx.alpha_x() * ggx.alpha_y()).sqrt();
    LtcLobe::new(DMat3::from_cols(1.5 * width * x, 1.2 * width * y, axis))
        .expect("the oracle converges on valid input")
}

#[test]
fn cubature_agrees_with_samples_of_the_lobe() {
    let mut random = SplitMix64::new(3);
    for _ in 0..20 {
        let (ggx, wo) = common::ggx_and_view(&mut random);
        let q = crude_fit(&ggx, wo);
        let by_samples = sampled(&ggx, wo, &q, 1 << 17);
        let by_cubature = ggx_total_variation(&ggx, wo, &q, Tolerance::absolute(TOLERANCE))
            .expect("the oracle converges on valid input")
            .value;
        assert!((by_cubature - by_samples).abs() < 1e-3, "{ggx:?} {wo}: {by_cubature} {by_samples}");
        assert!((0.0..=1.0 + TOLERANCE).contains(&by_cubature));
        // Negative control: for a q that is not normalised the two expressions differ.
        let heavy = ltc_reference::Scaled { lobe: q, factor: 1.1 };
        let wrong = ggx_total_variation(&ggx, wo, &heavy, Tolerance::absolute(TOLERANCE))
            .expect("the oracle converges on valid input")
            .value;
        assert!((wrong - sampled(&ggx, wo, &heavy, 1 << 15)).abs() > 0.04, "{ggx:?} {wo}");
    }
}

#[test]
fn narrow_lobes_and_cut_off_leaks() {
    for alpha in [1e-2, 1e-3, 1e-4] {
        let ggx = Ggx::isotropic(alpha).expect("the oracle converges on valid input");
        let wo = view_direction(0.7, 0.2);
        let near = ggx_total_variation(&ggx, wo, &crude_fit(&ggx, wo), Tolerance::absolute(TOLERANCE))
            .expect("the oracle converges on valid input");
        let by_samples = sampled(&ggx, wo, &crude_fit(&ggx, wo), 1 << 16);
        assert!((near.value - by_samples).abs() < 1e-3, "{alpha}: {near:?} {by_samples}");
        let missed = ggx_total_variation(&ggx, wo, &CosineLobe, Tolerance::absolute(TOLERANCE))
            .expect("the oracle converges on valid input");
        assert!(missed.value > 0.9, "{alpha}: {missed:?}");
    }
    // A lobe that leaks below the horizon is farther from itself cut off by half of the leak.
    let leaky = LtcLobe::new(DMat3::from_rotation_x(1.0)).expect("the oracle converges on valid input");
    let cut = AboveHorizon(leaky);
    let leak = 0.5 * (1.0 - 1.0f64.cos());
    assert!((tv(&leaky, &cut) - 0.5 * leak).abs() < TOLERANCE);
}

#[test]
fn bad_views_are_errors_or_one() {
    let ggx = Ggx::isotropic(0.3).expect("the oracle converges on valid input");
    let tolerance = Tolerance::absolute(1e-3);
    assert_eq!(
        ggx_total_variation(&ggx, -DVec3::Z, &CosineLobe, tolerance)
            .expect("the oracle converges on valid input")
            .value,
        1.0
    );
    let long = ggx_total_variation(&ggx, DVec3::ONE, &CosineLobe, tolerance);
    assert!(matches!(long, Err(ReferenceError::NotUnit { .. })));
}
