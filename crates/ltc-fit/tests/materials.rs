//! The materials against oracles that share no code with them.

#![expect(clippy::unwrap_used, reason = "a test fails by a panic")]

use glam::{DMat3, DVec3};
use ltc_core::points::SplitMix64;
use ltc_core::{Alpha, Ltc};
use ltc_fit::{
    Beckmann, Brdf, CharlieSheen, DiskPoints, DisneyDiffuse, GgxFamily, Lobe, OrenNayar, Pattern, direction,
    fit_entry,
};
use ltc_reference::{
    BeckmannLobe, CharlieLobe, DisneyDiffuseLobe, Ggx, GgxLobe, Lobe as _, LtcLobe, OrenNayarLobe, Scaled,
    Tolerance, integrate_sphere, lobe_mass,
};

/// The reference's lobe of one of the families, seen from a direction.
#[derive(Clone)]
enum Oracle {
    Ggx(GgxLobe),
    Beckmann(BeckmannLobe),
    Disney(DisneyDiffuseLobe),
    OrenNayar(OrenNayarLobe),
    Charlie(CharlieLobe),
}

impl ltc_reference::Lobe for Oracle {
    fn density(&self, wi: DVec3) -> f64 {
        match self {
            Self::Ggx(lobe) => lobe.density(wi),
            Self::Beckmann(lobe) => lobe.density(wi),
            Self::Disney(lobe) => lobe.density(wi),
            Self::OrenNayar(lobe) => lobe.density(wi),
            Self::Charlie(lobe) => lobe.density(wi),
        }
    }

    fn half_spaces(&self) -> Vec<DVec3> {
        vec![DVec3::Z]
    }

    fn kinks(&self) -> Vec<DVec3> {
        if let Self::OrenNayar(lobe) = self { lobe.kinks() } else { vec![DVec3::Z] }
    }

    fn hints(&self) -> Vec<DVec3> {
        match self {
            Self::Ggx(lobe) => lobe.hints(),
            Self::Beckmann(lobe) => lobe.hints(),
            Self::Disney(lobe) => lobe.hints(),
            Self::OrenNayar(lobe) => lobe.hints(),
            Self::Charlie(lobe) => lobe.hints(),
        }
    }
}

struct Material {
    brdf: &'static dyn Brdf,
    /// From what α means on the table's axis to what the paper calls it.
    oracle: fn(f64, f64, DVec3) -> Oracle,
    /// Relative error of a value.
    exact: f64,
    anisotropic: bool,
    /// Smallest width of its tables.
    narrowest: f64,
}

fn materials() -> [Material; 5] {
    let material =
        |brdf, oracle| Material { brdf, oracle, exact: 1e-11, anisotropic: false, narrowest: 1e-3 };
    [
        Material {
            anisotropic: true,
            ..material(&GgxFamily as &dyn Brdf, |x, y, wo| {
                Oracle::Ggx(GgxLobe { ggx: Ggx::new(x, y).unwrap(), wo })
            })
        },
        Material {
            anisotropic: true,
            // Its error function is approximated.
            exact: 2e-7,
            ..material(&Beckmann, |x, y, wo| Oracle::Beckmann(BeckmannLobe::new(x, y, wo).unwrap()))
        },
        material(&DisneyDiffuse, |x, _, wo| Oracle::Disney(DisneyDiffuseLobe { roughness: x.sqrt(), wo })),
        material(&OrenNayar, |x, _, wo| Oracle::OrenNayar(OrenNayarLobe { sigma: x, wo })),
        Material {
            narrowest: 4e-3,
            ..material(&CharlieSheen, |x, _, wo| Oracle::Charlie(CharlieLobe { roughness: x, wo }))
        },
    ]
}

/// A random width pair and view.
fn configuration(material: &Material, rng: &mut SplitMix64) -> (f64, f64, DVec3) {
    let alpha = rng.range(material.narrowest.sqrt(), 1.0).powi(2);
    let lambda = if material.anisotropic { rng.range(0.05, 1.0) } else { 1.0 };
    (alpha, alpha * lambda, direction(rng.range(0.0, 1.55), rng.range(0.0, core::f64::consts::TAU)))
}

#[test]
fn values_are_the_oracles() {
    for material in materials() {
        let mut rng = SplitMix64::new(1);
        let (mut largest, mut control, mut lit) = (0.0_f64, 0.0_f64, 0);
        for _ in 0..200 {
            let (x, y, wo) = configuration(&material, &mut rng);
            let alpha = Alpha::new(x, y).unwrap();
            let (oracle, other) = ((material.oracle)(x, y, wo), (material.oracle)(1.01 * x, y, wo));
            for _ in 0..50 {
                let wi = material.brdf.sample(wo, alpha, [rng.unit(), rng.unit()]);
                let (expected, value) = (oracle.density(wi), material.brdf.eval_cos(wo, wi, alpha));
                if expected > 1e-100 {
                    lit += 1;
                    largest = largest.max((value / expected - 1.0).abs());
                    control = control.max((other.density(wi) / expected - 1.0).abs());
                } else {
                    assert!(value < 1e-99, "{}: {value} {expected}", material.brdf.name());
                }
            }
        }
        println!("{}: values within {largest:.1e}, {lit} compared", material.brdf.name());
        assert!(largest < material.exact, "{}: {largest:e}", material.brdf.name());
        assert!(control > 1e-3 && lit > 5_000, "{}: {control} {lit}", material.brdf.name());
    }
}

#[test]
fn light_goes_both_ways() {
    for material in materials() {
        let mut rng = SplitMix64::new(2);
        let mut control = 0.0_f64;
        for _ in 0..2_000 {
            let (x, y, wo) = configuration(&material, &mut rng);
            let alpha = Alpha::new(x, y).unwrap();
            let wi = material.brdf.sample(wo, alpha, [rng.unit(), rng.unit()]);
            if wi.z < 1e-3 {
                continue;
            }
            let there = material.brdf.eval_cos(wo, wi, alpha);
            let back = material.brdf.eval_cos(wi, wo, alpha);
            let difference = |a: f64, b: f64| (a - b).abs() / (a + b).max(1e-100);
            assert!(
                difference(there / wi.z, back / wo.z) < 1e-9,
                "{}: {there} {back} at {wo} {wi} {alpha:?}",
                material.brdf.name()
            );
            control = control.max(difference(there, back));
        }
        assert!(control > 0.1, "{}: the cosine makes a difference: {control}", material.brdf.name());
    }
}

#[test]
fn exchanged_widths_turn_the_lobe() {
    for material in materials() {
        let mut rng = SplitMix64::new(3);
        for _ in 0..500 {
            let (x, y, wo) = configuration(&material, &mut rng);
            let wi = material.brdf.sample(wo, Alpha::new(x, y).unwrap(), [rng.unit(), rng.unit()]);
            let turned = |w: DVec3| DVec3::new(w.y, w.x, w.z);
            let a = material.brdf.eval_cos(wo, wi, Alpha::new(x, y).unwrap());
            let b = material.brdf.eval_cos(turned(wo), turned(wi), Alpha::new(y, x).unwrap());
            assert!((a - b).abs() <= 1e-12 * a, "{}: {a} {b}", material.brdf.name());
        }
    }
}

/// Samples of the channels in the presets.
const CHANNEL_SAMPLES: usize = 16_384;

#[test]
fn magnitude_and_fresnel_are_the_cubatures() {
    let points = DiskPoints::new(CHANNEL_SAMPLES, [0.5, 0.5]);
    let mut lobe = Lobe::default();
    for material in materials() {
        let (mut sum, mut largest, mut control, mut count) = (0.0, 0.0_f64, 0.0_f64, 0.0);
        for degrees in [0.0_f64, 30.0, 60.0, 75.0, 86.0] {
            for alpha in [0.01, 0.1, 0.3, 0.6, 1.0_f64] {
                let wo = direction(degrees.to_radians(), 0.4);
                let oracle = (material.oracle)(alpha, alpha, wo);
                let tolerance = Tolerance::absolute(1e-6);
                let magnitude = lobe_mass(&oracle, tolerance).unwrap().value;
                let weighted =
                    |wi: DVec3| oracle.density(wi) * (1.0 - 0.5 * (wo + wi).length()).max(0.0).powi(5);
                let schlick =
                    integrate_sphere(weighted, &oracle.kinks(), &oracle.hints(), tolerance).unwrap().value;
                let microfacets = matches!(oracle, Oracle::Ggx(_) | Oracle::Beckmann(_));
                let fresnel = if microfacets { schlick } else { 0.0 };
                material.brdf.sample_lobe(wo, Alpha::isotropic(alpha).unwrap(), &points, &mut lobe);
                let error = (lobe.magnitude - magnitude).abs().max((lobe.fresnel - fresnel).abs());
                assert!(magnitude < material.brdf.max_magnitude() + 1e-5, "{magnitude}");
                (sum, count) = (sum + error, count + 1.0);
                largest = largest.max(error);
                control = control.max((magnitude - 1.0).abs());
            }
        }
        let mean = sum / count;
        println!(
            "{}: magnitude and Fresnel within {mean:.1e} in the mean, {largest:.1e} at most",
            material.brdf.name()
        );
        assert!(mean < 1e-4 && largest < 5e-4, "{}: {mean:e} {largest:e}", material.brdf.name());
        assert!(control > 0.02, "{}: magnitudes that are all 1 would hide an error", material.brdf.name());
    }
}

#[test]
fn no_material_makes_more_energy_than_it_admits() {
    // White furnace: what a family says of its largest magnitude holds up to the edge of its tables, and is not idle.
    let points = DiskPoints::new(8_192, [0.5, 0.5]);
    let mut lobe = Lobe::default();
    for material in materials() {
        let mut most = 0.0_f64;
        for i in 0..40 {
            for j in 0..20 {
                let theta = f64::from(i) / 39.0 * 89.5_f64.to_radians();
                let alpha = material.narrowest.max((f64::from(j) / 19.0).powi(2));
                material.brdf.sample_lobe(
                    direction(theta, 0.0),
                    Alpha::isotropic(alpha).unwrap(),
                    &points,
                    &mut lobe,
                );
                most = most.max(lobe.magnitude);
            }
        }
        println!("{}: magnitudes up to {most:.4}", material.brdf.name());
        // Sampling may exceed a magnitude of 1 by its own error.
        assert!(most < material.brdf.max_magnitude() + 5e-4, "{}: {most}", material.brdf.name());
        let bound =
            if material.brdf.max_magnitude().is_finite() { material.brdf.max_magnitude() } else { 2.0 };
        assert!(most > 0.95 * bound, "{}: {most}", material.brdf.name());
    }
}

#[test]
fn total_variation_is_the_cubatures() {
    let points = DiskPoints::new(CHANNEL_SAMPLES, [0.5, 0.5]);
    let mut lobe = Lobe::default();
    for material in materials() {
        let mut rng = SplitMix64::new(4);
        let (mut largest, mut control) = (0.0_f64, 0.0_f64);
        for _ in 0..6 {
            let (alpha, _, wo) = configuration(&material, &mut rng);
            let alpha = alpha.max(0.05);
            material.brdf.sample_lobe(wo, Alpha::isotropic(alpha).unwrap(), &points, &mut lobe);
            let m = DMat3::from_cols(
                DVec3::new(0.6, 0.0, 0.1),
                DVec3::new(0.0, 0.5, 0.0),
                DVec3::new(-0.4 * wo.x, -0.4 * wo.y, 0.9),
            );
            let sampled = ltc_fit::total_variation(&lobe, m);
            let oracle = (material.oracle)(alpha, alpha, wo);
            let tolerance = Tolerance::absolute(1e-5);
            let magnitude = lobe_mass(&oracle, tolerance).unwrap().value;
            let p = Scaled { lobe: oracle, factor: 1.0 / magnitude };
            let exact =
                ltc_reference::total_variation(&p, &LtcLobe::new(m).unwrap(), Tolerance::absolute(1e-4));
            let exact = exact.unwrap().value;
            largest = largest.max((sampled - exact).abs());
            // The control: an LTC that is a tenth wider along x.
            let wider = LtcLobe::new(m * DMat3::from_diagonal(DVec3::new(1.1, 1.0, 1.0))).unwrap();
            let other = ltc_reference::total_variation(&p, &wider, Tolerance::absolute(1e-4));
            control = control.max((exact - other.unwrap().value).abs());
        }
        println!("{}: total variation within {largest:.1e}", material.brdf.name());
        assert!(largest < 2e-3, "{}: {largest:e}", material.brdf.name());
        assert!(control > 4e-3, "{}: {control}", material.brdf.name());
    }
}

#[test]
fn no_entry_fails_whatever_the_width_and_angle() {
    let points = DiskPoints::new(512, [0.5, 0.5]);
    let mut lobe = Lobe::default();
    let mut dark = 0;
    for material in materials() {
        for degrees in [0.0_f64, 20.0, 60.0, 85.0, 89.9] {
            for alpha in [0.0, 1e-3, 0.01, 0.1, 1.0] {
                let (wo, alpha) = (direction(degrees.to_radians(), 0.0), Alpha::isotropic(alpha).unwrap());
                material.brdf.sample_lobe(wo, alpha, &points, &mut lobe);
                let what = format!("{} θ {degrees}° α {}", material.brdf.name(), alpha.x());
                assert!((lobe.weight.iter().sum::<f64>() - 1.0).abs() < 1e-9, "{what}");
                assert!(lobe.magnitude >= 0.0 && lobe.magnitude.is_finite(), "{what}: {}", lobe.magnitude);
                dark += usize::from(lobe.magnitude == 0.0);
                let pattern = if degrees == 0.0 { Pattern::Round } else { Pattern::MirrorY };
                let fit = fit_entry(&lobe, wo, pattern, 100);
                assert!(Ltc::<f64>::new(fit.m).is_ok() && fit.m.determinant() > 0.0, "{what}: {fit:?}");
                assert!(fit.tv < 0.5, "{what}: {fit:?}");
            }
        }
    }
    assert!((1..10).contains(&dark), "Charlie's narrowest lobes underflow: {dark}");
}
