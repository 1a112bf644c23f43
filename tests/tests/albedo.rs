//! The fit's quadrature of magnitude and Fresnel term against adaptive cubature that shares no code with it.

#![expect(clippy::unwrap_used, reason = "a test fails by a panic")]

use ltc_core::Alpha;
use ltc_core::points::SplitMix64;
use ltc_fit::{Brdf, DiskRule, GgxFamily, Lobe, direction};
use ltc_reference::{Ggx, Tolerance, directional_albedo};

/// Largest differences of magnitude and Fresnel term over random views up to 89° and widths of the standard draw.
fn largest(rule: &DiskRule, turn: f64) -> (f64, f64) {
    let mut rng = SplitMix64::new(17);
    let mut lobe = Lobe::default();
    let mut largest = (0.0_f64, 0.0_f64);
    for i in 0..60 {
        let theta = if i % 2 == 0 { rng.range(0.0, 89.0) } else { rng.range(80.0, 89.0) };
        let (phi, alpha) = (rng.range(0.0, 1.57), rng.range(0.1, 1.0).powi(2));
        let (wo, lambda) = (direction(theta.to_radians(), phi), rng.range(0.05, 1.0));
        let found = GgxFamily.albedo(wo, Alpha::new(alpha, alpha * lambda).unwrap(), rule, &mut lobe);
        let wo = direction(theta.to_radians(), phi + turn);
        let ggx = Ggx::new(alpha, alpha * lambda).unwrap();
        let truth = directional_albedo(&ggx, wo, Tolerance::absolute(1e-6)).unwrap();
        largest.0 = largest.0.max((found.0 - truth.magnitude.value).abs());
        largest.1 = largest.1.max((found.1 - truth.fresnel.value).abs());
    }
    largest
}

#[test]
fn quadrature_is_right_to_a_ten_thousandth() {
    let (magnitude, fresnel) = largest(&DiskRule::of_about(8192), 0.0);
    assert!(magnitude < 1e-4 && fresnel < 1e-4, "{magnitude} {fresnel}");
}

/// Views that differ by a degree in azimuth are told apart.
#[test]
fn another_view_is_seen() {
    assert!(largest(&DiskRule::of_about(8192), 0.017).0 > 1e-3);
}
