//! Beckmann, Disney diffuse, Oren–Nayar, Charlie: normalisation of their normals, masking, closed values of their albedo.

mod common;

use std::f64::consts::{FRAC_PI_2, PI};

use glam::{DVec3, dvec3};
use ltc_reference::{
    BeckmannLobe, CharlieLobe, DisneyDiffuseLobe, Lobe, OrenNayarLobe, SplitMix64, Tolerance, integrate_1d,
    lobe_mass, view_direction,
};

/// A function of normals over directions ω with wh ∝ (stretch · ω_xy, ω_z), where a narrow D is round.
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
fn over_normals(ax: f64, ay: f64, visible_from: Option<DVec3>, f: impl Fn(DVec3) -> f64) -> f64 {
    let lobe = Stretched { stretch: dvec3(ax, ay, 1.0), visible_from, f };
    lobe_mass(&lobe, Tolerance::absolute(1e-9)).expect("the oracle converges on valid input").value
}

fn mass(lobe: &impl Lobe) -> f64 {
    lobe_mass(lobe, Tolerance::absolute(1e-8)).expect("the oracle converges on valid input").value
}

#[test]
fn beckmanns_normals_project_to_unit_area() {
    for (ax, ay) in [(1.0, 1.0), (0.5, 0.1), (0.02, 0.3), (1e-3, 1e-3)] {
        let lobe = BeckmannLobe::new(ax, ay, DVec3::Z).expect("widths are positive");
        let area = over_normals(ax, ay, None, |wh| lobe.ndf(wh) * wh.z);
        assert!((area - 1.0).abs() < 1e-8, "({ax}, {ay}): {area}");
        // Negative control: without the cosine of the projection.
        let lost = over_normals(ax, ay, None, |wh| lobe.ndf(wh));
        assert!(ax * ay < 0.01 || (lost - 1.0).abs() > 1e-3, "({ax}, {ay}): {lost}");
    }
}

#[test]
fn beckmanns_visible_normals_project_to_the_view() {
    // The weak white furnace: ∫ G1(wo) max(0, wo·wh) D dwh = cos θo.
    let mut random = SplitMix64::new(21);
    let mut told_apart = 0;
    for _ in 0..20 {
        let (ggx, wo) = common::ggx_and_view(&mut random);
        let (ax, ay) = (ggx.alpha_x(), ggx.alpha_y());
        let lobe = BeckmannLobe::new(ax, ay, wo).expect("widths are positive");
        let projected = over_normals(ax, ay, Some(wo), |wh| wo.dot(wh).max(0.0) * lobe.ndf(wh));
        let seen = projected / (1.0 + lobe.lambda(wo)) / wo.z;
        assert!((seen - 1.0).abs() < 1e-7, "({ax}, {ay}) {wo}: {seen}");
        // Negative control: the masking of GGX.
        told_apart += usize::from((projected / (1.0 + ggx.lambda(wo)) / wo.z - 1.0).abs() > 1e-4);
    }
    assert!(told_apart > 10, "{told_apart} of 20");
}

#[test]
fn charlies_normals_project_to_unit_area() {
    for roughness in [1.0, 0.5, 0.1, 0.02] {
        let lobe = CharlieLobe { roughness, wo: DVec3::Z };
        let ring = |theta: f64| 2.0 * PI * theta.sin() * lobe.ndf(dvec3(theta.sin(), 0.0, theta.cos()));
        let area = integrate_1d(|t| ring(t) * t.cos(), 0.0, FRAC_PI_2, Tolerance::absolute(1e-10));
        let area = area.expect("the oracle converges on valid input").value;
        assert!((area - 1.0).abs() < 1e-8, "{roughness}: {area}");
        // Negative control: without the cosine.
        let lost = integrate_1d(ring, 0.0, FRAC_PI_2, Tolerance::absolute(1e-10));
        assert!(lost.expect("the oracle converges on valid input").value > 1.1, "{roughness}");
    }
}

/// How far the paper's fit of Λ is from Smith's Λ of its D, which the weak white furnace defines.
#[test]
fn charlies_masking_is_a_fit() {
    let mut largest = 0.0_f64;
    for roughness in [1.0, 0.6, 0.3, 0.1] {
        for degrees in [10.0_f64, 40.0, 60.0, 75.0, 85.0] {
            let wo = view_direction(degrees.to_radians(), 0.0);
            let lobe = CharlieLobe { roughness, wo };
            let projected = over_normals(1.0, 1.0, Some(wo), |wh| wo.dot(wh).max(0.0) * lobe.ndf(wh));
            let smith = wo.z / projected;
            let fitted = 1.0 / (1.0 + lobe.lambda(wo.z));
            println!("r {roughness} θ {degrees}°: G1 {smith:.4}, fitted {fitted:.4}");
            largest = largest.max((smith - fitted).abs());
        }
    }
    assert!((1e-3..0.05).contains(&largest), "{largest}");
}

#[test]
fn albedos_from_above_are_the_closed_ones() {
    // Burley: 1 + 2 ∫ c (r(1 + c) − ½)(1 − c)^5 dc = 1 − 1/42 + 5r/84. Oren–Nayar: A, since tan 0 = 0.
    for parameter in [0.0, 0.3, 0.7, 1.0_f64] {
        let disney = mass(&DisneyDiffuseLobe { roughness: parameter, wo: DVec3::Z });
        assert!((disney - (1.0 - 1.0 / 42.0 + 5.0 * parameter / 84.0)).abs() < 1e-7, "{parameter}: {disney}");
        let variance = parameter * parameter;
        let oren_nayar = mass(&OrenNayarLobe { sigma: parameter, wo: DVec3::Z });
        assert!(
            (oren_nayar - (1.0 - 0.5 * variance / (variance + 0.33))).abs() < 1e-7,
            "{parameter}: {oren_nayar}"
        );
    }
}

#[test]
fn a_smooth_oren_nayar_is_lambert_and_a_rough_one_shines_back() {
    let wo = view_direction(1.2, 0.7);
    let lambert = OrenNayarLobe { sigma: 0.0, wo };
    let rough = OrenNayarLobe { sigma: 0.6, wo };
    let (back, forth) = (wo, dvec3(-wo.x, -wo.y, wo.z));
    assert!((lambert.density(back) - wo.z / PI).abs() < 1e-15);
    assert!(rough.density(back) > 2.0 * rough.density(forth));
    assert!((mass(&lambert) - 1.0).abs() < 1e-8);
}

#[test]
fn no_lobe_reflects_to_or_from_below() {
    for (wo, wi) in [(DVec3::Z, -DVec3::Z), (-DVec3::Z, DVec3::Z), (DVec3::X, DVec3::Z), (DVec3::Z, DVec3::X)]
    {
        let beckmann = BeckmannLobe::new(0.5, 0.5, wo).expect("widths are positive");
        assert_eq!(beckmann.density(wi), 0.0);
        assert_eq!(DisneyDiffuseLobe { roughness: 0.5, wo }.density(wi), 0.0);
        assert_eq!(OrenNayarLobe { sigma: 0.5, wo }.density(wi), 0.0);
        assert_eq!(CharlieLobe { roughness: 0.5, wo }.density(wi), 0.0);
    }
    assert!(BeckmannLobe::new(0.0, 0.5, DVec3::Z).is_err());
    assert!(BeckmannLobe::new(f64::NAN, 0.5, DVec3::Z).is_err());
}
