//! The errors that the fast forms state, over the domain they state, and what the horizons cost.

#![expect(clippy::unwrap_used, reason = "a test fails by a panic")]

mod common;

use common::{Statistics, across, decades, lobe};
use glam::{DMat3, DVec3, Vec3};
use ltc_core::points::SplitMix64;
use ltc_core::{Cubic, EdgeForm, Exact, Horizon, Light, Ltc, PublishedRational, Quad, Rational, Sides};

const COUNT: usize = 100_000;

/// Rectangles of half-widths 0.1 to 1.6 two units away, up to 100° off the axis of a lobe, leaning by up to 60°.
fn domain() -> impl Iterator<Item = (DMat3, [DVec3; 4])> {
    let mut rng = SplitMix64::new(23);
    (0..COUNT).map(move |_| {
        let alpha = decades(&mut rng, -1.5, 0.0);
        let theta = rng.range(0.0, 75_f64.to_radians());
        let (m, _) = lobe(&mut rng, alpha, theta);
        let axis = (m * DVec3::Z).normalize_or_zero();
        let [u, _] = across(&mut rng, axis);
        let (sin, cos) = rng.range(0.0, 100_f64.to_radians()).sin_cos();
        let centre = axis * cos + u * sin;
        let [u, v] = across(&mut rng, centre);
        let (sin, cos) = rng.range(0.0, 60_f64.to_radians()).sin_cos();
        let u = (u * cos + centre * sin) * rng.range(0.1, 1.6);
        (m, common::parallelogram(centre * 2.0, u, v * rng.range(0.1, 1.6)))
    })
}

struct Errors {
    all: Statistics,
    /// Of the lights alone that the horizon of cosine space cuts.
    cut: Statistics,
}

fn errors(value: impl Fn(&Quad<f32>, &Ltc<f32>) -> f32) -> Errors {
    let mut errors = Errors { all: Statistics::default(), cut: Statistics::default() };
    for (m, quad) in domain() {
        let rounded = quad.map(DVec3::as_vec3);
        let ltc = Ltc::<f64>::new(m.as_mat3().as_dmat3()).unwrap();
        let light = Quad::<f64>::new(rounded.map(Vec3::as_dvec3), Sides::Two).unwrap();
        let narrow = Ltc::<f32>::new(m.as_mat3()).unwrap();
        let error =
            f64::from(value(&Quad::new(rounded, Sides::Two).unwrap(), &narrow)) - light.integrate(&ltc);
        errors.all.add(error);
        if quad.iter().any(|v| (ltc.cosine_from_target() * *v).z < 0.0) {
            errors.cut.add(error);
        }
    }
    errors
}

fn form<F: EdgeForm>() -> Statistics {
    errors(|quad, ltc| quad.integrate_with::<F>(ltc, Horizon::BOTH)).all
}

/// Between half of the stated error and the whole of it.
fn assert_states(name: &str, errors: Statistics, max: f64, rms: f64) {
    println!("{name}: max {:.1e}, RMS {:.1e}", errors.max, errors.rms());
    assert!(errors.max <= max && errors.max > 0.5 * max, "{name}: max {:e}", errors.max);
    assert!(errors.rms() <= rms && errors.rms() > 0.5 * rms, "{name}: RMS {:e}", errors.rms());
}

#[test]
fn edge_forms_keep_the_errors_they_state() {
    assert_states("exact", form::<Exact>(), 1e-6, 5e-8);
    assert_states("rational", form::<Rational>(), 1e-6, 1e-7);
    assert_states("published", form::<PublishedRational>(), 2e-5, 3e-7);
    assert_states("cubic", form::<Cubic>(), 6e-4, 1e-4);
}

#[test]
fn the_proxy_keeps_the_errors_it_states() {
    let errors = errors(|quad, ltc| quad.integrate_proxy::<Rational>(ltc, true));
    assert_states("proxy", errors.all, 0.02, 8e-4);
    assert_states("proxy, cut", errors.cut, 0.02, 1e-3);
}

/// `θ / sin θ` alone.
#[test]
fn edge_terms_keep_the_errors_they_state() {
    fn largest<F: EdgeForm>(to: f64) -> f64 {
        (1..10_000)
            .map(|i| {
                let theta = to * f64::from(i) / 10_000.0;
                F::angle_over_sine(theta.cos(), theta.sin()) * theta.sin() / theta - 1.0
            })
            .fold(0.0, |m: f64, e| m.max(e.abs()))
    }
    let right = core::f64::consts::FRAC_PI_2;
    let pi = core::f64::consts::PI;
    for (error, stated) in [
        (largest::<Rational>(right), 6.9e-7),
        (largest::<PublishedRational>(right), 1.5e-6),
        (largest::<Cubic>(right), 6.9e-4),
        // The same bound on to π, where the sine tells.
        (largest::<Rational>(pi), 6.9e-7),
        (largest::<Cubic>(pi), 6.9e-4),
    ] {
        assert!(error <= stated && error > 0.9 * stated, "{error:e} {stated:e}");
    }
    assert!(largest::<Exact>(pi) < 1e-14);
    // The floor of the published form: an edge of 179.99° is lost by half, one nearer to π almost wholly.
    let lost =
        |theta: f64| 1.0 - PublishedRational::angle_over_sine(theta.cos(), theta.sin()) * theta.sin() / theta;
    assert!(lost(pi - 1.7e-4) > 0.4 && lost(pi - 1e-5) > 0.9, "{} {}", lost(pi - 1.7e-4), lost(pi - 1e-5));
}

/// What leaks without the surface's horizon, in closed form: a light that is all of what is below.
#[test]
fn the_leak_is_the_mass_below_the_surface() {
    let ground = [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0)].map(|(x, y)| DVec3::new(x, y, -1e-7));
    for (m, _) in domain().take(1000) {
        let row = m.row(2);
        let leak = 0.5 * (1.0 - row.z / row.length());
        let (ltc, light) = (Ltc::<f64>::new(m).unwrap(), Quad::<f64>::new(ground, Sides::Two).unwrap());
        let seen = light.integrate_within(&ltc, Horizon::COSINE);
        assert!((seen - leak).abs() < 1e-5, "{seen} {leak} {m}");
        assert_eq!(light.integrate(&ltc), 0.0);
    }
}
