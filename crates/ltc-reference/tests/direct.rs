//! The path tracer's estimator against cubature.

mod common;

use std::f64::consts::{PI, TAU};

use glam::{DVec3, dvec3};
use ltc_reference::{
    CosineLobe, Direct, Ggx, GgxLobe, Lobe, PolygonOptions, RectLight, ReferenceError, SplitMix64, Tolerance,
    direct_light, direct_light_visible, directional_albedo, integrate_polygon, view_direction,
};

/// A random square light around the mirror direction of `wo`.
fn light(random: &mut SplitMix64, wo: DVec3) -> [DVec3; 4] {
    let mirror = dvec3(-wo.x, -wo.y, wo.z);
    let frame = common::rotation(random);
    let half = common::log_uniform(random, 0.1, 1.6);
    let centre = 2.0 * mirror + 0.5 * half * frame.z_axis;
    let (x, y) = (half * frame.x_axis, half * frame.y_axis);
    [centre - x - y, centre + x - y, centre + x + y, centre - x + y]
}

/// The three integrals by cubature.
fn exact(ggx: &Ggx, wo: DVec3, corners: &[DVec3; 4], two_sided: bool) -> Direct {
    let options = PolygonOptions { two_sided, tolerance: Tolerance::absolute(1e-6) };
    let lobe = GgxLobe { ggx: *ggx, wo };
    let value = |lobe: &dyn Fn(DVec3) -> f64| {
        integrate_polygon(&|w| lobe(w), corners, options).expect("the oracle converges on valid input").value
    };
    Direct {
        magnitude: integrate_polygon(&lobe, corners, options)
            .expect("the oracle converges on valid input")
            .value,
        fresnel: value(&|w| if w.z > 0.0 { lobe.density(w) * ggx.fresnel_weight(wo, w) } else { 0.0 }),
        diffuse: integrate_polygon(&CosineLobe, corners, options)
            .expect("the oracle converges on valid input")
            .value,
    }
}

fn largest_error(a: Direct, b: Direct) -> f64 {
    let errors = [a.magnitude - b.magnitude, a.fresnel - b.fresnel, a.diffuse - b.diffuse];
    errors.into_iter().fold(0.0, |m, e| m.max(e.abs()))
}

#[test]
fn the_estimator_converges_to_the_integrals() {
    let mut random = SplitMix64::new(31);
    let (mut sum, mut swapped) = (0.0f64, 0.0f64);
    for i in 0..60 {
        let (ggx, wo) = common::ggx_and_view(&mut random);
        let corners = light(&mut random, wo);
        let two_sided = i % 2 == 0;
        let rect = RectLight::new(corners, two_sided).expect("the oracle converges on valid input");
        let expected = exact(&ggx, wo, &corners, two_sided);
        let got = direct_light(wo, &ggx, &rect, 1 << 14, i);
        assert!(largest_error(got, expected) < 3e-3, "{i}: {got:?} {expected:?}");
        sum += largest_error(got, expected);
        let other = Ggx::new(ggx.alpha_y(), ggx.alpha_x()).expect("the oracle converges on valid input");
        swapped = swapped.max(largest_error(direct_light(wo, &other, &rect, 1 << 14, i), expected));
    }
    assert!(sum / 60.0 < 3e-4, "mean error {}", sum / 60.0);
    // Negative control: swapped widths are found out.
    assert!(swapped > 0.05, "{swapped}");
}

#[test]
fn few_samples_are_unbiased() {
    let ggx = Ggx::new(0.3, 0.1).expect("the oracle converges on valid input");
    let wo = view_direction(0.9, 0.4);
    let corners =
        [dvec3(-1.5, -0.5, 0.1), dvec3(-1.5, 0.6, 0.1), dvec3(-1.2, 0.6, 1.4), dvec3(-1.2, -0.5, 1.4)];
    let rect = RectLight::new(corners, true).expect("the oracle converges on valid input");
    let expected = exact(&ggx, wo, &corners, true);
    let runs = 20_000;
    let estimates: Vec<Direct> = (0..runs).map(|seed| direct_light(wo, &ggx, &rect, 2, seed)).collect();
    let check = |get: fn(&Direct) -> f64| {
        let mean = estimates.iter().map(get).sum::<f64>() / runs as f64;
        let variance = estimates.iter().map(|e| (get(e) - mean).powi(2)).sum::<f64>() / runs as f64;
        (mean - get(&expected)) / (variance / runs as f64).sqrt()
    };
    for get in [|d: &Direct| d.magnitude, |d: &Direct| d.fresnel, |d: &Direct| d.diffuse] {
        assert!(check(get).abs() < 5.0, "{} standard errors", check(get));
        // Negative control: an error of 5 % is far outside.
        let mean = estimates.iter().map(get).sum::<f64>() / runs as f64;
        let off = check(get) + 0.05 * mean / ((mean - get(&expected)) / check(get)).abs();
        assert!(off.abs() > 5.0, "{off}");
    }
}

#[test]
fn a_light_over_everything_gives_the_albedo() {
    // A huge ceiling sees nearly all of the hemisphere; what it misses is below 2 of 1000 in elevation.
    let far = 1e4;
    let corners =
        [dvec3(-far, -far, 1.0), dvec3(-far, far, 1.0), dvec3(far, far, 1.0), dvec3(far, -far, 1.0)];
    let rect = RectLight::new(corners, false).expect("the oracle converges on valid input");
    for (ax, ay) in [(0.2, 0.2), (0.5, 0.05), (1e-4, 1e-4)] {
        let ggx = Ggx::new(ax, ay).expect("the oracle converges on valid input");
        let wo = view_direction(0.7, 1.0);
        let albedo = directional_albedo(&ggx, wo, Tolerance::absolute(1e-6))
            .expect("the oracle converges on valid input");
        let got = direct_light(wo, &ggx, &rect, 4096, 1);
        assert!((got.magnitude - albedo.magnitude.value).abs() < 2e-3, "{got:?} {albedo:?}");
        assert!((got.fresnel - albedo.fresnel.value).abs() < 2e-3, "{got:?} {albedo:?}");
        assert!((got.diffuse - 1.0).abs() < 2e-3, "{got:?}");
        let (f0, f90) = (0.04, 1.0);
        let schlick = f0 * got.magnitude + (f90 - f0) * got.fresnel;
        assert_eq!(got.specular(f0, f90), schlick);
        assert_eq!(got.specular_rgb(DVec3::splat(f0), DVec3::ONE), DVec3::splat(schlick));
        assert_eq!(got.diffuse(0.5), 0.5 * got.diffuse);
    }
}

#[test]
fn sides_shadows_and_the_horizon() {
    let ggx = Ggx::isotropic(0.4).expect("the oracle converges on valid input");
    let wo = view_direction(0.5, 0.0);
    let front = [dvec3(-1., -1., 1.), dvec3(-1., 1., 1.), dvec3(1., 1., 1.), dvec3(1., -1., 1.)];
    let back = [front[3], front[2], front[1], front[0]];
    let lit = |corners, two_sided, wo| {
        direct_light(
            wo,
            &ggx,
            &RectLight::new(corners, two_sided).expect("the oracle converges on valid input"),
            256,
            5,
        )
    };
    assert!(lit(front, false, wo).diffuse > 0.5);
    assert_eq!(lit(back, false, wo), Direct::default());
    assert!(largest_error(lit(back, true, wo), lit(front, false, wo)) < 1e-2);
    assert_eq!(lit(front, false, -wo), Direct::default());
    assert_eq!(lit(front, false, dvec3(f64::NAN, 0.0, 1.0)), Direct::default());
    assert_eq!(lit(front.map(|p| p - 2.0 * DVec3::Z), true, wo), Direct::default());
    assert_eq!(lit(front.map(|p| p - DVec3::Z), true, wo), Direct::default());
    let rect = RectLight::new(front, false).expect("the oracle converges on valid input");
    assert_eq!(direct_light(wo, &ggx, &rect, 0, 5), Direct::default());
    assert_eq!(direct_light_visible(wo, &ggx, &rect, 256, 5, |_| false), Direct::default());
    // Half of the light is hidden: by symmetry half of the diffuse light is left.
    let half = direct_light_visible(wo, &ggx, &rect, 4096, 5, |hit| hit.wi.y > 0.0);
    assert!((half.diffuse / lit(front, false, wo).diffuse - 0.5).abs() < 1e-2);
    assert_eq!(direct_light(wo, &ggx, &rect, 64, 9), direct_light(wo, &ggx, &rect, 64, 9));
    assert_ne!(direct_light(wo, &ggx, &rect, 64, 9), direct_light(wo, &ggx, &rect, 64, 10));
}

#[test]
fn hits_and_samples_of_a_light_agree() {
    let mut random = SplitMix64::new(41);
    for _ in 0..200 {
        let wo = view_direction(0.6, TAU * random.next_f64());
        let corners = light(&mut random, wo);
        let rect = RectLight::new(corners, true).expect("the oracle converges on valid input");
        assert!(rect.corners().iter().zip(corners).all(|(a, b)| (*a - b).length() < 1e-12));
        let side = (corners[1] - corners[0]).length();
        assert!((rect.area() - side * side).abs() < 1e-12 * rect.area());
        let u = [0.01 + 0.98 * random.next_f64(), 0.01 + 0.98 * random.next_f64()];
        let drawn = rect.sample(u).expect("the oracle converges on valid input");
        let found = rect.hit(drawn.wi).expect("the oracle converges on valid input");
        assert!((drawn.distance - found.distance).abs() < 1e-9 * drawn.distance);
        assert!((drawn.pdf - found.pdf).abs() < 1e-9 * drawn.pdf);
        assert!(rect.hit(-drawn.wi).is_none());
        let missed = (corners[0] + 1.01 * (corners[1] - corners[0])).normalize_or(DVec3::Z);
        assert!(rect.hit(missed).is_none());
    }
}

#[test]
fn lights_without_area_are_dark_and_bad_corners_are_errors() {
    let flat = RectLight::new([DVec3::Z, DVec3::Z, DVec3::X, DVec3::X], true)
        .expect("the oracle converges on valid input");
    assert!(!flat.faces_origin() && flat.sample([0.5; 2]).is_none() && flat.hit(DVec3::Z).is_none());
    let kite = [dvec3(0., 0., 1.), dvec3(1., 0., 1.), dvec3(2., 2., 1.), dvec3(0., 1., 1.)];
    assert!(matches!(RectLight::new(kite, true), Err(ReferenceError::NotAParallelogram { .. })));
    let nan = [DVec3::Z, DVec3::NAN, DVec3::X, DVec3::Y];
    assert!(matches!(RectLight::new(nan, true), Err(ReferenceError::NonFiniteInput { .. })));
    // The contact of light and surface: nothing blows up.
    let touching = [dvec3(0., -1., 0.), dvec3(0., 1., 0.), dvec3(1., 1., 1.), dvec3(1., -1., 1.)];
    for shift in [0.0, 1e-12, 1e-6, 1e-3] {
        let rect = RectLight::new(touching.map(|p| p + shift * DVec3::X), true)
            .expect("the oracle converges on valid input");
        let got = direct_light(
            view_direction(0.3, PI),
            &Ggx::isotropic(0.3).expect("the oracle converges on valid input"),
            &rect,
            64,
            3,
        );
        for value in [got.magnitude, got.fresnel, got.diffuse] {
            assert!((0.0..=1.5).contains(&value), "{shift}: {got:?}");
        }
    }
}
