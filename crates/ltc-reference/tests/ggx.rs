//! GGX: identities of the distribution, sampling against density, albedo by two routes.

mod common;

use std::f64::consts::{PI, TAU};

use glam::{DVec3, dvec3};
use ltc_reference::{
    Ggx, Lobe, R2, ReferenceError, SplitMix64, Tolerance, directional_albedo, integrate_squares, lobe_mass,
    view_direction,
};

/// A function of normals as a lobe over directions ω with wh ∝ (stretch · ω_xy, ω_z), where a narrow D is round;
/// `dwh = sx sy / |stretched ω|³ dω`. `visible_from` adds the plane wo·wh = 0.
struct Stretched<F> {
    stretch: DVec3,
    visible_from: Option<DVec3>,
    f: F,
}

impl<F: Fn(DVec3) -> f64> Lobe for Stretched<F> {
    fn density(&self, w: DVec3) -> f64 {
        let normal = self.stretch * w;
        let length = normal.length();
        (self.f)(normal / length) * self.stretch.x * self.stretch.y / length.powi(3)
    }

    fn kinks(&self) -> Vec<DVec3> {
        self.visible_from.into_iter().map(|wo| self.stretch * wo).chain([DVec3::Z]).collect()
    }
}

/// `∫ f(wh) dwh` over the upper hemisphere.
fn over_normals(ggx: &Ggx, visible_from: Option<DVec3>, f: impl Fn(DVec3) -> f64) -> f64 {
    let lobe = Stretched { stretch: dvec3(ggx.alpha_x(), ggx.alpha_y(), 1.0), visible_from, f };
    lobe_mass(&lobe, Tolerance::absolute(1e-9)).expect("the oracle converges on valid input").value
}

#[test]
fn normals_project_to_unit_area_at_every_width() {
    for (ax, ay) in [(1.0, 1.0), (0.5, 0.1), (0.02, 0.3), (1e-3, 1e-3), (1e-4, 1.0)] {
        let ggx = Ggx::new(ax, ay).expect("the oracle converges on valid input");
        let area = over_normals(&ggx, None, |wh| ggx.ndf(wh) * wh.z);
        assert!((area - 1.0).abs() < 1e-8, "({ax}, {ay}): {area}");
    }
}

#[test]
fn a_lost_factor_or_a_mixed_up_width_breaks_the_unit_area() {
    // Negative control: D without its 1/(αx αy), and with αy in both slopes.
    let ggx = Ggx::new(0.5, 0.1).expect("the oracle converges on valid input");
    let lost = over_normals(&ggx, None, |wh| ggx.ndf(wh) * wh.z * 0.5 * 0.1);
    assert!((lost - 1.0).abs() > 0.5, "{lost}");
    let mixed_up = over_normals(&ggx, None, |wh| {
        let e = (wh.x / 0.1).powi(2) + (wh.y / 0.1).powi(2) + wh.z * wh.z;
        wh.z / (PI * 0.5 * 0.1 * e * e)
    });
    assert!((mixed_up - 1.0).abs() > 0.5, "{mixed_up}");
}

#[test]
fn visible_normals_are_normalised() {
    let mut random = SplitMix64::new(11);
    let mut told_apart = 0;
    for _ in 0..20 {
        let (ggx, wo) = common::ggx_and_view(&mut random);
        let mass = over_normals(&ggx, Some(wo), |wh| ggx.vndf(wo, wh));
        assert!((mass - 1.0).abs() < 1e-8, "{ggx:?} {wo}: {mass}");
        // Negative control: the masking of swapped widths does not fit this D.
        let swapped = Ggx::new(ggx.alpha_y(), ggx.alpha_x()).expect("the oracle converges on valid input");
        let wrong =
            over_normals(&ggx, Some(wo), |wh| swapped.g1(wo) * wo.dot(wh).max(0.0) * ggx.ndf(wh) / wo.z);
        told_apart += usize::from((wrong - 1.0).abs() > 1e-6);
    }
    assert!(told_apart > 15, "{told_apart}");
}

#[test]
fn the_brdf_is_its_parts_and_reciprocal() {
    let mut random = SplitMix64::new(5);
    for _ in 0..1000 {
        let (ggx, wo) = common::ggx_and_view(&mut random);
        let wi = view_direction(1.5 * random.next_f64(), TAU * random.next_f64());
        let wh = (wo + wi).normalize_or(DVec3::Z);
        let parts = ggx.ndf(wh) * ggx.g2(wo, wi) / (4.0 * wo.z);
        let value = ggx.eval_cos(wo, wi);
        assert!((value - parts).abs() <= 1e-12 * parts, "{value} {parts}");
        let back = ggx.eval_cos(wi, wo) / wo.z;
        assert!((value / wi.z - back).abs() <= 1e-11 * back, "reciprocity");
        let jacobian = 1.0 / (4.0 * wo.dot(wh));
        assert!((ggx.pdf(wo, wi) - ggx.vndf(wo, wh) * jacobian).abs() <= 1e-11 * ggx.pdf(wo, wi));
        assert!((ggx.fresnel_weight(wo, wi) - (1.0 - wo.dot(wh)).powi(5)).abs() < 1e-14);
        assert!(value >= 0.0 && ggx.g2(wo, wi) <= ggx.g1(wo).min(ggx.g1(wi)) + 1e-15);
    }
}

/// Bins of (height, azimuth) of the upper hemisphere.
const BINS: (usize, usize) = (8, 16);

/// How many standard deviations the χ² of `samples` draws lies above its mean (Wilson-Hilferty), against the density of
/// `expected`.
fn chi_square_deviation(drawn: &Ggx, expected: &Ggx, wo: DVec3, samples: usize) -> f64 {
    let mut counts = vec![0.0; BINS.0 * BINS.1 + 1];
    let mut random = SplitMix64::new(99);
    for _ in 0..samples {
        let bin = match drawn.sample(wo, random.next_2d()) {
            Some((wi, _)) => {
                let row = ((wi.z * BINS.0 as f64) as usize).min(BINS.0 - 1);
                let turn = (wi.y.atan2(wi.x) / TAU).rem_euclid(1.0);
                row * BINS.1 + ((turn * BINS.1 as f64) as usize).min(BINS.1 - 1)
            }
            None => BINS.0 * BINS.1,
        };
        counts[bin] += 1.0;
    }
    let mut mass: Vec<f64> = (0..BINS.0 * BINS.1).map(|bin| bin_mass(expected, wo, bin)).collect();
    mass.push(1.0 - mass.iter().sum::<f64>());
    // Bins that expect fewer than ten draws are pooled.
    let (mut chi, mut bins, mut pool) = (0.0, 0.0, (0.0, 0.0));
    for (count, mass) in counts.into_iter().zip(mass) {
        let expected = mass * samples as f64;
        if expected < 10.0 {
            pool = (pool.0 + count, pool.1 + expected);
        } else {
            chi += (count - expected).powi(2) / expected;
            bins += 1.0;
        }
    }
    if pool.1 > 5.0 {
        chi += (pool.0 - pool.1).powi(2) / pool.1;
        bins += 1.0;
    }
    let k: f64 = bins - 1.0;
    ((chi / k).cbrt() - (1.0 - 2.0 / (9.0 * k))) / (2.0 / (9.0 * k)).sqrt()
}

/// The probability of one bin.
fn bin_mass(ggx: &Ggx, wo: DVec3, bin: usize) -> f64 {
    let density = |_: usize, u: f64, v: f64| {
        let z = ((bin / BINS.1) as f64 + u) / BINS.0 as f64;
        let phi = TAU * ((bin % BINS.1) as f64 + v) / BINS.1 as f64;
        ggx.pdf(wo, view_direction(z.acos(), phi))
    };
    let scale = TAU / (BINS.0 * BINS.1) as f64;
    scale
        * integrate_squares(density, &[vec![]], Tolerance::absolute(1e-5))
            .expect("the oracle converges on valid input")
            .value
}

#[test]
fn samples_follow_their_density() {
    for (ax, ay, theta, phi) in
        [(0.5, 0.5, 0.3, 0.0), (0.6, 0.2, 1.0, 0.7), (0.2, 0.9, 1.4, 4.0), (1.0, 0.3, 1.55, 2.0)]
    {
        let ggx = Ggx::new(ax, ay).expect("the oracle converges on valid input");
        let wo = view_direction(theta, phi);
        let deviation = chi_square_deviation(&ggx, &ggx, wo, 200_000);
        assert!(deviation.abs() < 4.0, "({ax}, {ay}) {wo}: {deviation}");
        // Negative control: the density of slightly other widths, and of swapped ones, is told apart.
        let other = Ggx::new(1.05 * ax, ay).expect("the oracle converges on valid input");
        assert!(chi_square_deviation(&ggx, &other, wo, 200_000) > 6.0);
        if ax != ay {
            assert!(
                chi_square_deviation(
                    &ggx,
                    &Ggx::new(ay, ax).expect("the oracle converges on valid input"),
                    wo,
                    200_000
                ) > 100.0
            );
        }
    }
}

#[test]
fn albedo_agrees_with_the_mean_weight_of_samples() {
    let mut random = SplitMix64::new(21);
    let points = R2::new();
    let samples = 1 << 18;
    let mut told_apart = 0;
    for _ in 0..20 {
        let (ggx, wo) = common::ggx_and_view(&mut random);
        let (mut magnitude, mut fresnel, mut separable) = (0.0, 0.0, 0.0);
        for (wi, pdf) in (0..samples).filter_map(|i| ggx.sample(wo, points.point(i))) {
            let weight = ggx.eval_cos(wo, wi) / pdf;
            magnitude += weight / samples as f64;
            fresnel += weight * ggx.fresnel_weight(wo, wi) / samples as f64;
            separable += ggx.g1(wi) / samples as f64;
        }
        let albedo = directional_albedo(&ggx, wo, Tolerance::absolute(1e-8))
            .expect("the oracle converges on valid input");
        assert!((albedo.magnitude.value - magnitude).abs() < 1e-4, "{ggx:?} {wo}: {magnitude} {albedo:?}");
        assert!((albedo.fresnel.value - fresnel).abs() < 1e-4, "{ggx:?} {wo}: {fresnel} {albedo:?}");
        assert!(albedo.magnitude.value <= 1.0 + 1e-8);
        // Negative control: separable masking G1·G1 is not the height-correlated one, where masking matters at all.
        told_apart += usize::from((albedo.magnitude.value - separable).abs() > 1e-4);
    }
    assert!(told_apart > 10, "{told_apart}");
}

#[test]
fn albedo_of_the_roughest_surface_seen_from_above_is_known() {
    // α = 1 makes D = 1/π and Λ(wo) = 0: n = ∫ z / (z + 1) dz = 1 - ln 2 over [0, 1], with s(wi) = 1 in
    // zi / (2 (zi + 1)) · D · 2π dz.
    let rough = Ggx::isotropic(1.0).expect("the oracle converges on valid input");
    let albedo = directional_albedo(&rough, DVec3::Z, Tolerance::absolute(1e-10))
        .expect("the oracle converges on valid input");
    assert!((albedo.magnitude.value - (1.0 - 2f64.ln())).abs() < 1e-10, "{albedo:?}");
    // Negative control: a width 1 % off is seen.
    let near = directional_albedo(
        &Ggx::isotropic(0.99).expect("the oracle converges on valid input"),
        DVec3::Z,
        Tolerance::absolute(1e-10),
    )
    .expect("the oracle converges on valid input");
    assert!((near.magnitude.value - (1.0 - 2f64.ln())).abs() > 1e-4, "{near:?}");
}

#[test]
fn narrow_lobes_reflect_everything() {
    for theta in [0.0, 0.5, 1.2, 1.5] {
        let albedo = directional_albedo(
            &Ggx::isotropic(0.0).expect("the oracle converges on valid input"),
            view_direction(theta, 0.3),
            Tolerance::absolute(1e-7),
        )
        .expect("the oracle converges on valid input");
        assert!((albedo.magnitude.value - 1.0).abs() < 1e-5, "{theta}: {albedo:?}");
        let mirror = (1.0 - theta.cos()).powi(5);
        assert!((albedo.fresnel.value - mirror).abs() < 1e-5, "{theta}: {albedo:?}");
    }
}

#[test]
fn every_degenerate_input_has_an_answer() {
    assert!(matches!(Ggx::new(f64::NAN, 0.1), Err(ReferenceError::NonFiniteInput { .. })));
    assert!(matches!(Ggx::new(0.1, -0.1), Err(ReferenceError::InvalidAlpha { .. })));
    assert_eq!(Ggx::isotropic(0.0).expect("the oracle converges on valid input").alpha_x(), Ggx::MIN_ALPHA);
    let ggx = Ggx::new(0.3, 0.1).expect("the oracle converges on valid input");
    for wo in [DVec3::Z, DVec3::X, DVec3::Y, view_direction(PI / 2.0, 1.0), -DVec3::Z] {
        for wi in [DVec3::Z, DVec3::X, -DVec3::X, -wo, -DVec3::Z] {
            for value in [ggx.eval_cos(wo, wi), ggx.pdf(wo, wi), ggx.fresnel_weight(wo, wi)] {
                assert!(value.is_finite() && value >= 0.0, "{wo} {wi}: {value}");
            }
        }
        for u in [[0.0, 0.0], [0.999_999, 0.999_999], [0.5, 0.5], [0.0, 1.0]] {
            if let Some((wi, pdf)) = ggx.sample(wo, u) {
                assert!(wo.z >= 0.0 && wi.is_finite() && wi.z > 0.0 && pdf.is_finite(), "{wo} {u:?}");
            }
        }
        let albedo = directional_albedo(&ggx, wo, Tolerance::absolute(1e-5))
            .expect("the oracle converges on valid input");
        assert!((0.0..=1.00001).contains(&albedo.magnitude.value), "{wo}: {albedo:?}");
    }
    let long = directional_albedo(&ggx, 2.0 * DVec3::Z, Tolerance::default());
    assert!(matches!(long, Err(ReferenceError::NotUnit { .. })));
}
