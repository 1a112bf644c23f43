//! The χ² test itself: it passes right samplers, catches wrong ones, and its p-values are uniform.

mod common;

use std::f64::consts::{PI, TAU};

use glam::{DMat3, DVec3, dvec3};
use ltc_reference::{
    CapChart, ChiSquareOptions, ChiSquareSuite, Lobe, LtcLobe, R2, ReferenceError, SplitMix64,
    TransformedChart, chi_square, chi_square_unit, cosine_direction, sidak, sphere_direction,
};

fn cosine_pdf(w: DVec3) -> f64 {
    w.z.max(0.0) / PI
}

/// A direction within `angle` of +x, uniform in solid angle.
fn in_cap(angle: f64, u: [f64; 2]) -> DVec3 {
    let h = u[0] * (0.5 * angle).sin().powi(2);
    let sine = 2.0 * (h * (1.0 - h)).sqrt();
    let (sin, cos) = (TAU * u[1]).sin_cos();
    dvec3(1.0 - 2.0 * h, sine * cos, sine * sin)
}

fn cap_pdf(angle: f64) -> impl Fn(DVec3) -> f64 {
    let edge = 2.0 * (0.5 * angle).sin();
    let density = 1.0 / (PI * edge * edge);
    move |w| if (w - DVec3::X).length() < edge { density } else { 0.0 }
}

#[test]
fn right_samplers_pass_together() {
    let options = ChiSquareOptions::default();
    let mut suite = ChiSquareSuite::new(0.01);
    let sphere = CapChart::sphere();
    let hemisphere = CapChart::hemisphere();
    suite.add("sphere", chi_square(|u| Some(sphere_direction(u)), |_| 0.25 / PI, &sphere, options).unwrap());
    for (name, chart) in [("cosine, hemisphere", hemisphere), ("cosine, sphere", sphere)] {
        suite.add(name, chi_square(|u| Some(cosine_direction(u)), cosine_pdf, &chart, options).unwrap());
    }
    // A jump that no bin's border follows, and supports down to 1e-6 rad in bins of their own.
    for angle in [1.0, 1e-2, 1e-4, 1e-6] {
        let chart = CapChart::cap(dvec3(1.0, 0.3 * angle, 0.2 * angle), 2.0 * angle).unwrap();
        let outcome = chi_square(|u| Some(in_cap(angle, u)), cap_pdf(angle), &chart, options).unwrap();
        assert!((outcome.mass - 1.0).abs() < 1e-4, "{angle}: {outcome:?}");
        suite.add(format!("cap {angle}"), outcome);
    }
    let mut random = SplitMix64::new(2);
    for condition in [1.0, 10.0, 1e3, 1e5] {
        let ltc = common::ltc(&mut random, condition);
        let chart = TransformedChart::new(hemisphere, ltc.target_from_cosine()).unwrap();
        let outcome = chi_square(|u| Some(ltc.sample(u)), |w| ltc.density(w), &chart, options).unwrap();
        suite.add(format!("LTC of condition {condition}"), outcome);
    }
    // A sampler that refuses half of its samples, and a chart that covers half of a lobe.
    let half = |u: [f64; 2]| Some(sphere_direction(u)).filter(|w| w.z > 0.0);
    let outcome =
        chi_square(half, |w| if w.z > 0.0 { 0.25 / PI } else { 0.0 }, &hemisphere, options).unwrap();
    assert!((outcome.mass - 0.5).abs() < 1e-6 && outcome.outside > 49_000, "{outcome:?}");
    suite.add("half refused", outcome);
    let cap = CapChart::cap(DVec3::X, 0.5 * PI).unwrap();
    suite.add("half seen", chi_square(|u| Some(cosine_direction(u)), cosine_pdf, &cap, options).unwrap());
    let line = chi_square_unit(|[u, v]| Some([u.sqrt(), v]), |[x, _]| 2.0 * x, options).unwrap();
    suite.add("unit square", line);
    assert!(suite.rejected().is_empty(), "{:#?} of {}", suite.rejected(), suite.len());
}

#[test]
fn wrong_samplers_and_wrong_densities_are_caught() {
    let options = ChiSquareOptions::default();
    let hemisphere = CapChart::hemisphere();
    let mut suite = ChiSquareSuite::new(0.01);
    let cosine = |u| Some(cosine_direction(u));
    let mut wrong = |name: &str, outcome: Result<_, _>| suite.add(name, outcome.unwrap());
    // The classical slips: no square root, a squared cosine, a lobe that is 3 % too sharp, a tilted one.
    wrong("u for √u", chi_square(|[u, v]| cosine([u * u, v]), cosine_pdf, &hemisphere, options));
    wrong("cosine²", chi_square(cosine, |w| 1.5 * w.z * w.z.max(0.0) / PI, &hemisphere, options));
    let sharper = |w: DVec3| 1.03 * w.z.max(0.0).powf(1.06) / PI;
    let more = ChiSquareOptions { samples: 400_000, ..options };
    wrong("3 % too sharp", chi_square(cosine, sharper, &hemisphere, more));
    let tilted = LtcLobe::new(DMat3::from_rotation_x(0.02)).unwrap();
    wrong("tilted by 0.02", chi_square(|u| Some(tilted.sample(u)), cosine_pdf, &CapChart::sphere(), options));
    // Shapes that fit, masses that do not.
    wrong("2 % too much", chi_square(cosine, |w| 1.02 * cosine_pdf(w), &hemisphere, options));
    wrong("2 % too little", chi_square(cosine, |w| 0.98 * cosine_pdf(w), &hemisphere, options));
    // One sample in a thousand where the density is 0.
    let stray = |[u, v]: [f64; 2]| Some(if u < 1e-3 { -DVec3::Z } else { cosine_direction([u, v]) });
    wrong("stray", chi_square(stray, cosine_pdf, &CapChart::sphere(), options));
    // A sampler that never reaches a tenth of the azimuth; one that refuses what it should draw.
    let gap = |[u, v]: [f64; 2]| cosine([u, 0.9 * v]);
    wrong("gap", chi_square(gap, cosine_pdf, &hemisphere, options));
    let refuses = |[u, v]: [f64; 2]| cosine([u, v]).filter(|_| u > 2e-3);
    wrong("refuses", chi_square(refuses, cosine_pdf, &hemisphere, options));
    // A peak that slips between the quadrature's nodes must not pass.
    let narrow = chi_square(|u| Some(in_cap(1e-5, u)), cap_pdf(1e-5), &CapChart::sphere(), options);
    wrong("overlooked peak", narrow);
    let elsewhere = CapChart::cap(-DVec3::Z, 0.5).unwrap();
    wrong("nothing to compare", chi_square(cosine, cosine_pdf, &elsewhere, options));
    assert_eq!(suite.rejected().len(), suite.len(), "only {:#?} were caught", suite.rejected());
}

#[test]
fn p_values_of_a_right_sampler_are_uniform() {
    let mut sum = 0.0;
    let mut below = 0;
    for seed in 0..200 {
        let options = ChiSquareOptions { samples: 4000, bins: [6, 10], seed, ..ChiSquareOptions::default() };
        let outcome =
            chi_square(|u| Some(cosine_direction(u)), cosine_pdf, &CapChart::hemisphere(), options).unwrap();
        assert_eq!(outcome.dof, 59);
        sum += outcome.p_value;
        below += usize::from(outcome.p_value < 0.1);
    }
    // Means of 200 uniform numbers have a standard deviation of 0.0204; 20 ± 4.2 of them lie below 0.1.
    assert!((sum / 200.0 - 0.5).abs() < 0.08, "{sum}");
    assert!((5..=37).contains(&below), "{below}");
}

#[test]
fn low_discrepancy_points_are_too_good() {
    // Why the points are pseudo-random: R2 would let a slightly wrong sampler pass.
    let mut i = 0;
    let sample = |_: [f64; 2]| {
        i += 1;
        Some(cosine_direction(R2::new().point(i)))
    };
    let outcome =
        chi_square(sample, cosine_pdf, &CapChart::hemisphere(), ChiSquareOptions::default()).unwrap();
    assert!(outcome.p_value > 0.9999, "{outcome:?}");
}

#[test]
fn levels_are_corrected() {
    for tests in [1, 3, 100] {
        let each = sidak(0.01, tests);
        assert!((1.0 - (1.0 - each).powi(tests as i32) - 0.01).abs() < 1e-12, "{tests}: {each}");
    }
    assert_eq!(sidak(0.01, 0), sidak(0.01, 1));
    assert!(ChiSquareSuite::new(0.01).is_empty());
}

#[test]
fn bad_samplers_and_densities_are_errors() {
    let options = ChiSquareOptions { samples: 100, ..ChiSquareOptions::default() };
    let sphere = CapChart::sphere();
    let cosine = |u| Some(cosine_direction(u));
    for bad in [f64::NAN, f64::INFINITY, -1.0] {
        let got = chi_square(cosine, |_| bad, &sphere, options);
        assert!(matches!(got, Err(ReferenceError::NonFiniteIntegrand { .. })), "{bad}: {got:?}");
    }
    let got = chi_square(|_| Some(DVec3::NAN), cosine_pdf, &sphere, options);
    assert!(matches!(got, Err(ReferenceError::NonFiniteInput { .. })), "{got:?}");
    let got = chi_square(|_| Some(DVec3::ONE), cosine_pdf, &sphere, options);
    assert!(matches!(got, Err(ReferenceError::NotUnit { .. })), "{got:?}");
    let got = chi_square_unit(|_| Some([f64::NAN; 2]), |_| 1.0, options);
    assert!(matches!(got, Err(ReferenceError::NonFiniteInput { .. })), "{got:?}");
}
