//! Samplers against the densities that they claim, and against the integrals.

use glam::{DVec3, dvec3};
use ltc_core::{Cylinder, Disk, Ellipse, Light, Ltc, SampleLight, Sides, Sphere};
use ltc_reference::{CapChart, ChiSquareOptions, ChiSquareSuite, chi_square};

use super::support::Random;

/// Named lights, each seen from some side.
fn lights() -> Vec<(&'static str, Box<dyn SampledLight>)> {
    let centre = dvec3(0.4, -0.3, 1.2);
    let (u, v) = (dvec3(0.8, 0.1, 0.3), dvec3(-0.2, 0.5, 0.1));
    let low = dvec3(0.9, -0.4, 0.5);
    let cylinder = |p0: DVec3, p1: DVec3, caps| Cylinder::<f64>::new(p0, p1, 0.4, caps).unwrap();
    vec![
        ("disk", Box::new(Disk::<f64>::new(centre, dvec3(0.1, 0.3, -1.0), 0.7, Sides::One).unwrap())),
        ("near disk", Box::new(Disk::<f64>::new(dvec3(0.3, 0.0, 0.6), DVec3::Z, 1.0, Sides::Two).unwrap())),
        ("ellipse", Box::new(Ellipse::<f64>::new(centre, u, v, Sides::Two).unwrap())),
        ("sphere", Box::new(Sphere::<f64>::new(centre, 0.6).unwrap())),
        ("sphere from near", Box::new(Sphere::<f64>::new(centre, 1.29).unwrap())),
        ("sphere from inside", Box::new(Sphere::<f64>::new(centre, 2.0).unwrap())),
        ("tube", Box::new(cylinder(low, low + dvec3(0.3, 1.0, 0.8), false))),
        ("tube, its end seen", Box::new(cylinder(low, low + dvec3(0.9, 0.5, 0.3), false))),
        ("solid cylinder", Box::new(cylinder(low, low + dvec3(0.9, 0.5, 0.3), true))),
        ("cylinder in line", Box::new(cylinder(dvec3(0.1, 0.0, 0.8), dvec3(0.1, 0.0, 2.0), true))),
        ("cylinder from inside", Box::new(cylinder(dvec3(0.1, 0.0, -0.8), dvec3(0.1, 0.0, 2.0), true))),
    ]
}

/// A cap around the light with as much again beside it.
fn chart(light: &dyn SampledLight) -> CapChart {
    let draw = |i: usize| light.sample(ltc_core::points::r2(i, [0.5, 0.5])).map(|s| s.wi);
    let drawn: Vec<DVec3> = (0..500).filter_map(draw).collect();
    let axis = drawn.iter().sum::<DVec3>().normalize_or(DVec3::Z);
    let reach = drawn.iter().map(|w| w.angle_between(axis)).fold(0.0, f64::max);
    CapChart::cap(axis, (1.3 * reach).min(core::f64::consts::PI)).unwrap()
}

trait SampledLight: SampleLight<f64> + Light<f64> {}
impl<T: SampleLight<f64> + Light<f64>> SampledLight for T {}

#[test]
fn every_sampler_draws_from_its_density() {
    let mut suite = ChiSquareSuite::new(0.01);
    for (name, light) in lights() {
        let options =
            ChiSquareOptions { allowed_stray: 2, mass_tolerance: 1e-3, ..ChiSquareOptions::default() };
        let sample = |u: [f64; 2]| light.sample(u).map(|s| s.wi);
        let outcome = chi_square(sample, |w| light.pdf(w), &chart(&*light), options).unwrap();
        assert!((outcome.mass - 1.0).abs() < 1e-3, "{name}: {outcome:?}");
        suite.add(name, outcome);
    }
    assert!(suite.rejected().is_empty(), "{:?}", suite.rejected());
    // Negative control: uniform over the cap is not uniform over the disk's area.
    let disk = Disk::<f64>::new(dvec3(0.5, 0.0, 0.2), DVec3::Z, 1.0, Sides::Two).unwrap();
    let crooked = |u: [f64; 2]| disk.sample([u[0] * u[0], u[1]]).map(|s| s.wi);
    let outcome =
        chi_square(crooked, |w| disk.pdf(w), &CapChart::sphere(), ChiSquareOptions::default()).unwrap();
    assert!(outcome.p_value < 1e-6, "{outcome:?}");
}

/// A small, far sphere: its cone is narrower than any chart of the sphere.
#[test]
fn narrow_cones_keep_their_digits() {
    let towards = dvec3(0.6, 0.0, 0.8);
    let light = Sphere::<f64>::new(towards * 1e4, 1.0).unwrap();
    let chart = CapChart::cap(towards, 2e-4).unwrap();
    let sample = |u: [f64; 2]| light.sample(u).map(|s| s.wi);
    let outcome = chi_square(sample, |w| light.pdf(w), &chart, ChiSquareOptions::default()).unwrap();
    assert!(outcome.p_value > 1e-3, "{outcome:?}");
}

/// The samples say what the closed form says: the mean of density over pdf is the integral.
#[test]
fn samples_estimate_the_integral() {
    let mut random = Random::new(3);
    for (name, light) in lights() {
        for _ in 0..3 {
            let ltc = Ltc::<f64>::new(random.matrix(8.0)).unwrap();
            let n = 40_000;
            let (mut sum, mut squares, mut strays) = (0.0, 0.0, 0);
            for _ in 0..n {
                let Some(sample) = light.sample([random.unit(), random.unit()]) else { continue };
                // A sample on the rim may be rounded off the light.
                let pdf = light.pdf(sample.wi);
                strays += usize::from(pdf == 0.0);
                assert!(pdf == 0.0 || (pdf / sample.pdf - 1.0).abs() < 1e-6, "{name}: {pdf} {sample:?}");
                let above = if sample.wi.z > 0.0 { ltc.density(sample.wi) } else { 0.0 };
                sum += above / sample.pdf;
                squares += (above / sample.pdf).powi(2);
            }
            assert!(strays < 3, "{name}: {strays}");
            let mean = sum / f64::from(n);
            let sigma = ((squares / f64::from(n) - mean * mean) / f64::from(n)).sqrt();
            let value = light.integrate(&ltc);
            assert!((mean - value).abs() < 5.0 * sigma + 1e-6, "{name}: {mean} ± {sigma}, {value}");
        }
    }
}

/// The distance is that of a point of the light.
#[test]
fn sampled_points_lie_on_the_light() {
    let mut random = Random::new(7);
    for _ in 0..2000 {
        let (centre, radius) = (random.direction() * random.decades(0.1, 10.0), random.decades(0.1, 3.0));
        let u = [random.unit(), random.unit()];
        let on_sphere = Sphere::<f64>::new(centre, radius).unwrap().sample(u).unwrap();
        let point = on_sphere.wi * on_sphere.distance;
        assert!((point.distance(centre) / radius - 1.0).abs() < 1e-6, "{point} {centre} {radius}");
        let normal = random.direction();
        let disk = Disk::<f64>::new(centre, normal, radius, Sides::Two).unwrap();
        if let Some(sample) = disk.sample(u) {
            let offset = sample.wi * sample.distance - centre;
            assert!(
                offset.dot(normal).abs() < 1e-12 * centre.length() && offset.length() < radius * 1.000_001
            );
        }
        let end = centre + random.direction();
        let cylinder = Cylinder::<f64>::new(centre, end, radius, true).unwrap();
        if let Some(sample) = cylinder.sample(u) {
            let p = sample.wi * sample.distance - centre;
            let axis = end - centre;
            let (height, aside) = (p.dot(axis), axis.cross(p).length());
            let on_mantle = (aside - radius).abs() < 1e-6;
            let on_end = (height.abs() < 1e-6 || (height - 1.0).abs() < 1e-6) && aside < radius * 1.000_001;
            assert!(on_mantle || on_end, "{height} {aside} {radius}");
        }
    }
    // A light that is not seen has no sample and no density.
    let behind = Disk::<f64>::new(DVec3::Z, DVec3::Z, 1.0, Sides::One).unwrap();
    assert!(behind.sample([0.3, 0.3]).is_none() && behind.pdf(DVec3::Z) == 0.0);
    let inside = Cylinder::<f64>::new(-DVec3::Z, DVec3::Z, 1.0, false).unwrap();
    assert!(inside.sample([0.3, 0.3]).is_none() && inside.pdf(DVec3::X) == 0.0);
}

/// In f32 the same directions to f32's precision.
#[test]
fn single_precision_samples_follow() {
    let mut random = Random::new(9);
    for _ in 0..2000 {
        let (centre, u) = (random.direction() * 2.0, [random.unit(), random.unit()]);
        let wide = Sphere::<f64>::new(centre, 0.5).unwrap().sample(u).unwrap();
        let single = Sphere::<f32>::new(centre.as_vec3(), 0.5).unwrap().sample(u.map(|x| x as f32)).unwrap();
        assert!((single.wi.as_dvec3() - wide.wi).length() < 1e-5, "{single:?} {wide:?}");
        assert!((f64::from(single.pdf) / wide.pdf - 1.0).abs() < 1e-5);
        let end = centre + DVec3::X;
        let wide = Cylinder::<f64>::new(centre, end, 0.3, true).unwrap().sample(u).unwrap();
        let single = Cylinder::<f32>::new(centre.as_vec3(), end.as_vec3(), 0.3, true).unwrap();
        let single = single.sample(u.map(|x| x as f32)).unwrap();
        assert!((single.wi.as_dvec3() - wide.wi).length() < 1e-4, "{single:?} {wide:?}");
    }
}
