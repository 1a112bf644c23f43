//! χ² tests of every distribution's samples, corrected for their number.

use glam::{DMat3, DVec3, Mat3, dvec3};
use ltc_core::points::SplitMix64;
use ltc_core::{
    Alpha, Base, ClampedCosine, ClampedCosineSquared, Distribution, Ggx, LinearlyTransformed, Ltc,
    LtcMixture, UniformHemisphere, UniformSphere,
};
use ltc_reference::{
    CapChart, ChiSquare, ChiSquareOptions, ChiSquareSuite, TransformedChart, chi_square, view_direction,
};

use crate::support::matrix;

/// Pass with 99 % if all are right.
const LEVEL: f64 = 0.01;

/// Matrices by name: isotropic and sheared ones, thin ones, and ones whose determinant is next to nothing.
fn matrices() -> Vec<(String, DMat3)> {
    let mut random = SplitMix64::new(11);
    let mut matrices = vec![
        ("identity".to_owned(), DMat3::IDENTITY),
        (
            "sheared".to_owned(),
            DMat3::from_cols(dvec3(0.6, 0.0, 0.1), dvec3(0.2, 0.4, 0.0), dvec3(-0.5, 0.3, 0.8)),
        ),
        (
            "mirror-like".to_owned(),
            DMat3::from_rotation_y(0.9) * DMat3::from_diagonal(dvec3(1e-4, 1e-4, 1.0)),
        ),
        ("needle".to_owned(), DMat3::from_rotation_x(-0.7) * DMat3::from_diagonal(dvec3(1e-5, 0.5, 1.0))),
        ("determinant 1e-14".to_owned(), DMat3::from_diagonal(dvec3(1e-7, 1e-7, 1.0))),
        ("flattened".to_owned(), DMat3::from_diagonal(dvec3(1.0, 1.0, 1e-3))),
    ];
    for condition in [3.0, 30.0, 300.0] {
        matrices.push((format!("condition {condition}"), matrix(&mut random, condition)));
    }
    matrices
}

/// Bins that follow the matrix `m`, so that thin lobes fill them. They know nothing of the base.
fn test(distribution: &impl Distribution<f64>, m: DMat3, seed: u64) -> ChiSquare {
    let chart = TransformedChart::new(CapChart::sphere(), m).unwrap();
    let options = ChiSquareOptions { seed, ..ChiSquareOptions::default() };
    chi_square(|u| Some(distribution.sample(u)), |w| distribution.density(w), &chart, options).unwrap()
}

fn add<B: Base<f64>>(name: &str, suite: &mut ChiSquareSuite) {
    for (i, (kind, m)) in matrices().into_iter().enumerate() {
        let distribution = LinearlyTransformed::<f64, B>::new(m).unwrap();
        let outcome = test(&distribution, m, i as u64);
        assert!((outcome.mass - 1.0).abs() < 1e-6, "{name}, {kind}: {outcome:?}");
        suite.add(format!("{name}, {kind}"), outcome);
    }
}

#[test]
fn samples_of_every_base_follow_its_density() {
    let mut suite = ChiSquareSuite::new(LEVEL);
    add::<UniformSphere>("uniform sphere", &mut suite);
    add::<UniformHemisphere>("uniform hemisphere", &mut suite);
    add::<ClampedCosine>("clamped cosine", &mut suite);
    add::<ClampedCosineSquared>("clamped cosine²", &mut suite);
    assert_eq!(suite.len(), 36);
    assert!(suite.rejected().is_empty(), "{:#?}", suite.rejected());
}

/// Bins that owe nothing to the matrix: a sampler and a chart that shared a fault would not pass both.
#[test]
fn samples_follow_the_density_in_plain_spherical_bins() {
    let mut suite = ChiSquareSuite::new(LEVEL);
    // Those that are not thinner than the bins.
    let plain = ["identity", "sheared", "mirror-like", "condition 3", "condition 30"];
    for (seed, (kind, m)) in
        matrices().into_iter().filter(|(kind, _)| plain.contains(&kind.as_str())).enumerate()
    {
        let squared = LinearlyTransformed::<f64, ClampedCosineSquared>::new(m).unwrap();
        let chart = CapChart::cap(squared.median(), if kind == "mirror-like" { 1e-3 } else { 3.2 }).unwrap();
        let options = ChiSquareOptions { seed: seed as u64, ..ChiSquareOptions::default() };
        let outcome =
            chi_square(|u| Some(squared.sample(u)), |w| squared.density(w), &chart, options).unwrap();
        suite.add(kind, outcome);
    }
    assert!(suite.rejected().is_empty(), "{:#?}", suite.rejected());
}

#[test]
fn single_precision_samples_follow_the_density_too() {
    let mut suite = ChiSquareSuite::new(LEVEL);
    for (seed, (kind, m)) in matrices().into_iter().take(3).enumerate() {
        let truth = Ltc::<f64>::new(m).unwrap();
        let ltc = Ltc::<f32>::new(m.as_mat3()).unwrap();
        let chart = TransformedChart::new(CapChart::sphere(), m).unwrap();
        // Below the horizon by a rounding error: some.
        let options =
            ChiSquareOptions { seed: seed as u64, allowed_stray: 10, ..ChiSquareOptions::default() };
        let sample = |u: [f64; 2]| Some(ltc.sample(u.map(|x| x as f32)).as_dvec3());
        suite.add(kind, chi_square(sample, |w| truth.density(w), &chart, options).unwrap());
    }
    assert!(suite.rejected().is_empty(), "{:#?}", suite.rejected());
    assert!(
        Ltc::<f32>::new(Mat3::from_diagonal(glam::vec3(1e-19, 1e-19, 1.0))).is_err(),
        "its peak overflows"
    );
}

#[test]
fn samples_of_mixtures_follow_their_density() {
    let mut suite = ChiSquareSuite::new(LEVEL);
    let [(_, a), (_, b), .., (_, c)] = &matrices()[..] else { panic!("there are nine matrices") };
    let lobes = [a, b, c].map(|m| Ltc::<f64>::new(*m).unwrap());
    let weights = [vec![0.2, 0.5, 0.3], vec![0.0, 0.99, 0.01], vec![1.0, 0.0, 0.0], vec![0.5, 0.5]];
    for (seed, weights) in weights.into_iter().enumerate() {
        let name = format!("{weights:?}");
        let mixture = LtcMixture::new(weights.into_iter().zip(lobes)).unwrap();
        let options = ChiSquareOptions { seed: seed as u64, ..ChiSquareOptions::default() };
        let outcome =
            chi_square(|u| Some(mixture.sample(u)), |w| mixture.density(w), &CapChart::sphere(), options);
        suite.add(name, outcome.unwrap());
    }
    assert!(suite.rejected().is_empty(), "{:#?}", suite.rejected());
}

const VIEWS: [(f64, f64, f64, f64); 7] = [
    (1.0, 1.0, 0.0, 0.0),
    (0.5, 0.5, 0.8, 0.3),
    (0.8, 0.1, 1.2, 1.1),
    (0.05, 0.6, 1.4, 4.0),
    (0.3, 0.3, 1.57, 0.2),
    (0.02, 0.02, 0.5, 2.0),
    (1e-3, 1e-3, 1.0, 5.0),
];

#[test]
fn visible_normals_follow_the_oracles_density() {
    let mut suite = ChiSquareSuite::new(LEVEL);
    for (seed, (ax, ay, theta, phi)) in VIEWS.into_iter().enumerate() {
        let ggx = Ggx::<f64>::new(Alpha::new(ax, ay).unwrap());
        let oracle = ltc_reference::Ggx::new(ax, ay).unwrap();
        let wo = view_direction(theta, phi);
        let options = ChiSquareOptions { seed: seed as u64, ..ChiSquareOptions::default() };
        let chart =
            TransformedChart::new(CapChart::hemisphere(), DMat3::from_diagonal(dvec3(ax, ay, 1.0))).unwrap();
        let sample = |u| Some(ggx.sample_visible_normal(wo, u));
        let outcome = chi_square(sample, |wh| oracle.vndf(wo, wh), &chart, options).unwrap();
        assert!((outcome.mass - 1.0).abs() < 1e-5, "{outcome:?}");
        suite.add(format!("normals of {ax} {ay} {theta}"), outcome);
        // And the light directions that they reflect to, of which some go below the horizon.
        let sample = |u| Some(ggx.sample(wo, u)).filter(|wi| wi.z > 0.0);
        let mirror = dvec3(-wo.x, -wo.y, wo.z);
        let chart = CapChart::cap(mirror, if ax < 0.01 { 0.1 } else { 3.2 }).unwrap();
        let outcome = chi_square(sample, |wi| oracle.pdf(wo, wi), &chart, options).unwrap();
        suite.add(format!("directions of {ax} {ay} {theta}"), outcome);
    }
    assert!(suite.rejected().is_empty(), "{:#?}", suite.rejected());
}

/// Negative controls: faults that a sampler could have, in the very tests above.
#[test]
fn faults_are_caught() {
    let mut suite = ChiSquareSuite::new(LEVEL);
    let (_, m) = &matrices()[1];
    let chart = TransformedChart::new(CapChart::sphere(), *m).unwrap();
    let options = ChiSquareOptions::default();
    let mut fault = |name: &str, sample: &dyn Fn([f64; 2]) -> DVec3, pdf: &dyn Fn(DVec3) -> f64| {
        suite.add(name, chi_square(|u| Some(sample(u)), pdf, &chart, options).unwrap());
    };
    let cosine = Ltc::<f64>::new(*m).unwrap();
    let squared = LinearlyTransformed::<f64, ClampedCosineSquared>::new(*m).unwrap();
    let other = Ltc::<f64>::new(m.transpose()).unwrap();
    fault("another base", &|u| squared.sample(u), &|w| cosine.density(w));
    fault("the transposed matrix", &|u| other.sample(u), &|w| cosine.density(w));
    fault("no Jacobian", &|u| cosine.sample(u), &|w| {
        (cosine.cosine_from_target() * w)
            .try_normalize()
            .map_or(0.0, |w| w.z.max(0.0) / core::f64::consts::PI)
    });
    // A mixture that draws its lobe and its point from the same number without stretching what is left of it.
    let mixture = LtcMixture::new([(0.4, cosine), (0.6, Ltc::cosine())]).unwrap();
    let careless = |u: [f64; 2]| if u[0] < 0.4 { cosine.sample(u) } else { Ltc::cosine().sample(u) };
    fault("an unstretched choice", &careless, &|w| mixture.density(w));
    // Normals drawn from the distribution of normals where visible ones are asked for.
    let (oracle, wo) = (ltc_reference::Ggx::new(0.5, 0.5).unwrap(), view_direction(0.8, 0.3));
    let overhead = Ggx::<f64>::new(Alpha::new(0.5, 0.5).unwrap());
    let all = |u| Some(overhead.sample_visible_normal(DVec3::Z, u));
    suite.add(
        "all normals",
        chi_square(all, |wh| oracle.vndf(wo, wh), &CapChart::hemisphere(), options).unwrap(),
    );
    assert_eq!(suite.rejected().len(), 5, "only {:#?} were caught", suite.rejected());
}
