//! Samples of polygonal lights: χ² tests, corrected for their number, and estimates of the closed forms.

#![expect(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

use std::f64::consts::PI;

use glam::{DMat3, DVec3, dvec3};
use ltc_core::points::{SplitMix64, r2};
use ltc_core::{
    Horizon, InputError, Light, LinearlyTransformed, Ltc, Polygon, PolygonSampler, SampleLight, Sides,
    UniformSphere,
};
use ltc_reference::{CapChart, ChiSquare, ChiSquareOptions, ChiSquareSuite, chi_square};

/// An outline in the plane x–y, laid into the plane through `centre` with these axes.
fn laid(outline: &[[f64; 2]], centre: DVec3, frame: DMat3) -> Vec<DVec3> {
    outline.iter().map(|&[x, y]| centre + frame.x_axis * x + frame.y_axis * y).collect()
}

const L: [[f64; 2]; 6] = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
const COMB: [[f64; 2]; 7] =
    [[-2.0, -1.0], [2.0, -1.0], [2.0, 1.0], [1.5, -0.9], [1.0, 1.0], [0.5, -0.9], [0.0, 1.0]];
const TRIANGLE: [[f64; 2]; 3] = [[-1.0, -0.5], [1.0, -0.5], [0.2, 1.0]];
const SLIVER: [[f64; 2]; 3] = [[-1.0, 0.0], [1.0, 0.0], [0.9, 0.02]];
const SQUARE: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];

/// Lights by name: convex and not, wound either way, near, far, grazing, around the shading point's foot.
fn lights() -> Vec<(&'static str, Vec<DVec3>)> {
    let facing = DMat3::from_diagonal(dvec3(1.0, -1.0, -1.0));
    let tilted = DMat3::from_rotation_y(0.7) * DMat3::from_rotation_x(0.4);
    vec![
        ("L overhead", laid(&L, DVec3::Z, facing)),
        ("L tilted", laid(&L, dvec3(0.3, -2.0, 1.0), tilted)),
        ("comb", laid(&COMB, dvec3(0.5, 0.2, 0.8), tilted)),
        ("triangle", laid(&TRIANGLE, dvec3(0.0, 1.0, 1.5), DMat3::from_rotation_z(0.5))),
        ("triangle far away", laid(&TRIANGLE, dvec3(3e3, -1e3, 2e3), tilted)),
        ("triangle at 1e6", laid(&TRIANGLE, dvec3(3e5, -1e5, 9e5), tilted)),
        ("sliver", laid(&SLIVER, dvec3(0.0, 0.0, 0.3), tilted)),
        ("square all around", laid(&SQUARE, dvec3(0.1, 0.2, 0.05), facing)),
        ("square seen grazingly", laid(&SQUARE, dvec3(3.0, 0.0, 0.1), facing)),
        ("L below the horizon", laid(&L, dvec3(0.4, -2.0, -1.0), tilted)),
    ]
}

/// A cap that holds the light, but not more than twice as much as it must.
fn cap(vertices: &[DVec3]) -> CapChart {
    let units: Vec<DVec3> = vertices.iter().filter_map(|v| v.try_normalize()).collect();
    let axis = units.iter().sum::<DVec3>().try_normalize().unwrap_or(DVec3::Z);
    let angle = |w: &DVec3| 2.0 * (0.5 * (*w - axis).length()).asin();
    let widest = units.iter().map(angle).fold(0.0, f64::max);
    // An edge may bulge out between its ends where the light spans more than a hemisphere.
    CapChart::cap(axis, if widest > 0.7 { PI } else { 1.05 * widest }).unwrap()
}

fn test(sampler: &impl SampleLight<f64>, vertices: &[DVec3], seed: u64) -> ChiSquare {
    // A sample on an edge may be rounded off the light.
    let options = ChiSquareOptions { samples: 50_000, seed, allowed_stray: 2, ..ChiSquareOptions::default() };
    chi_square(|u| Some(sampler.sample(u)?.wi), |w| sampler.pdf(w), &cap(vertices), options).unwrap()
}

#[test]
fn directions_follow_their_density_over_area_and_over_solid_angle() {
    let mut suite = ChiSquareSuite::new(0.01);
    for (seed, (name, vertices)) in lights().into_iter().enumerate() {
        let polygon = Polygon::<f64>::new(&vertices, Sides::Two).unwrap();
        for (measure, sampler) in [
            ("area", PolygonSampler::by_area(&polygon)),
            ("solid angle", PolygonSampler::by_solid_angle(&polygon)),
        ] {
            let outcome = test(&sampler.unwrap(), &vertices, seed as u64);
            assert!((outcome.mass - 1.0).abs() < 1e-3, "{name} by {measure}: {outcome:?}");
            assert!(outcome.dof > 20, "{name} by {measure}: {outcome:?}");
            suite.add(format!("{name} by {measure}"), outcome);
        }
    }
    assert!(suite.rejected().is_empty(), "{:#?}", suite.rejected());
}

/// Negative controls.
#[test]
fn wrong_samplers_are_caught() {
    struct Swapped<'a>(&'a PolygonSampler<f64>, &'a PolygonSampler<f64>);
    impl SampleLight<f64> for Swapped<'_> {
        fn sample(&self, u: [f64; 2]) -> Option<ltc_core::LightSample<f64>> {
            self.0.sample(u)
        }
        fn pdf(&self, wi: DVec3) -> f64 {
            self.1.pdf(wi)
        }
    }
    let mut suite = ChiSquareSuite::new(0.01);
    for (seed, (name, vertices)) in lights().into_iter().enumerate().take(4) {
        let polygon = Polygon::new(&vertices, Sides::Two).unwrap();
        let (area, solid) =
            (PolygonSampler::by_area(&polygon).unwrap(), PolygonSampler::by_solid_angle(&polygon).unwrap());
        suite.add(
            format!("{name}: area for solid angle"),
            test(&Swapped(&area, &solid), &vertices, seed as u64),
        );
        suite.add(
            format!("{name}: solid angle for area"),
            test(&Swapped(&solid, &area), &vertices, seed as u64),
        );
        // The hull in place of the notched light.
        if name.starts_with('L') {
            let hull: Vec<DVec3> = [0, 1, 2, 4, 5].map(|i| vertices[i]).to_vec();
            let hull = PolygonSampler::by_area(&Polygon::new(&hull, Sides::Two).unwrap()).unwrap();
            suite.add(format!("{name}: hull"), test(&Swapped(&hull, &area), &vertices, seed as u64));
        }
    }
    assert_eq!(suite.rejected().len(), suite.len(), "only {:#?} were caught", suite.rejected());
}

#[test]
fn the_total_solid_angle_is_that_of_the_uniform_sphere() {
    let sphere = LinearlyTransformed::<f64, UniformSphere>::identity();
    for (name, vertices) in lights() {
        for sides in [Sides::Two, Sides::One] {
            let polygon = Polygon::new(&vertices, sides).unwrap();
            let total = PolygonSampler::by_solid_angle(&polygon).unwrap().total();
            let closed = 4.0 * PI * sphere.integrate_polygon(&polygon, Horizon::NONE);
            assert!((total - closed).abs() < 1e-12, "{name}: {total} {closed}");
            assert!((total - closed).abs() <= 1e-8 * closed, "{name}: {total} {closed}");
        }
    }
    let area =
        |v: &[DVec3]| PolygonSampler::by_area(&Polygon::<f64>::new(v, Sides::Two).unwrap()).unwrap().total();
    assert!((area(&lights()[1].1) - 3.0).abs() < 1e-12, "an L of three squares");
}

#[test]
fn estimates_meet_the_closed_form() {
    let ltc = Ltc::new(DMat3::from_cols(dvec3(0.6, 0.0, 0.1), dvec3(0.2, 0.4, 0.0), dvec3(-0.3, 0.3, 0.8)))
        .unwrap();
    for (name, vertices) in lights() {
        let polygon = Polygon::<f64>::new(&vertices, Sides::Two).unwrap();
        let closed = polygon.integrate(&ltc);
        let solid = PolygonSampler::by_solid_angle(&polygon).unwrap();
        let area = PolygonSampler::by_area(&polygon).unwrap();
        for sampler in [&solid, &area] {
            let n = 1 << 14;
            let weight = |i| {
                let sample = sampler.sample(r2(i, [0.5, 0.5]))?;
                let above = if sample.wi.z > 0.0 { ltc.density(sample.wi) } else { 0.0 };
                // What a sample says of itself agrees with the light.
                assert!(
                    (sampler.pdf(sample.wi) / sample.pdf - 1.0).abs() < 1e-6 || sampler.pdf(sample.wi) == 0.0
                );
                Some(above / sample.pdf)
            };
            let estimate = (0..n).filter_map(weight).sum::<f64>() / n as f64;
            let tolerance = 1e-2 * closed + 1e-5;
            // By area a light that nearly touches the point is too wild.
            if name != "square all around" || sampler == &solid {
                assert!((estimate - closed).abs() < tolerance, "{name}: {estimate} {closed}");
            }
        }
    }
}

#[test]
fn samples_lie_on_the_light() {
    let mut random = SplitMix64::new(3);
    for (name, vertices) in lights() {
        let normal =
            vertices.windows(2).map(|e| (e[0] - vertices[0]).cross(e[1] - vertices[0])).sum::<DVec3>();
        let normal = normal.try_normalize().unwrap();
        let reach = vertices.iter().map(|v| v.length()).fold(0.0, f64::max);
        let polygon = Polygon::<f64>::new(&vertices, Sides::Two).unwrap();
        for sampler in [PolygonSampler::by_area(&polygon), PolygonSampler::by_solid_angle(&polygon)] {
            let sampler = sampler.unwrap();
            let mut off = 0;
            for _ in 0..2000 {
                let sample = sampler.sample([random.unit(), random.unit()]).unwrap();
                let point = sample.wi * sample.distance;
                assert!((point - vertices[0]).dot(normal).abs() < 1e-14 * reach, "{name}");
                off += usize::from(sampler.pdf(sample.wi) <= 0.0);
            }
            assert!(off <= 1, "{name}: {off} samples miss the light");
            for u in [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0], [1.0 - f64::EPSILON, 0.5]] {
                let sample = sampler.sample(u).unwrap();
                assert!(
                    sample.wi.is_normalized() && sample.pdf > 0.0 && sample.pdf.is_finite(),
                    "{name}: {sample:?}"
                );
            }
        }
    }
}

#[test]
fn what_is_not_seen_is_not_sampled_and_what_is_no_polygon_is_an_error() {
    let front: Vec<DVec3> = laid(&L, DVec3::Z, DMat3::from_diagonal(dvec3(1.0, -1.0, -1.0)));
    let back: Vec<DVec3> = front.iter().rev().copied().collect();
    let sampler =
        |v: &[DVec3], sides| PolygonSampler::by_solid_angle(&Polygon::<f64>::new(v, sides).unwrap());
    assert!(sampler(&front, Sides::One).unwrap().sample([0.5, 0.5]).is_some());
    let dark = sampler(&back, Sides::One).unwrap();
    assert_eq!(
        (dark.sample([0.5, 0.5]), dark.pdf(dvec3(0.3, 0.3, 1.0).try_normalize().unwrap())),
        (None, 0.0)
    );
    assert_eq!(dark.total(), 0.0);
    assert!(sampler(&back, Sides::Two).unwrap().sample([0.5, 0.5]).is_some());
    let edge_on: Vec<DVec3> = L.iter().map(|&[x, y]| dvec3(x + 1.0, 0.0, y)).collect();
    assert_eq!(sampler(&edge_on, Sides::Two).unwrap().sample([0.5, 0.5]), None);
    let flat = [DVec3::Z; 3];
    assert_eq!(sampler(&flat, Sides::Two), Err(InputError::Degenerate { name: "polygon" }));
    let bow = [dvec3(0.0, 0.0, 1.0), dvec3(1.0, 1.0, 1.0), dvec3(1.0, 0.0, 1.0), dvec3(0.0, 1.5, 1.0)];
    assert!(matches!(sampler(&bow, Sides::Two), Err(InputError::Degenerate { .. })));
    // The polygon itself draws by area, and nothing where the sampler is refused.
    let polygon = Polygon::<f64>::new(&front, Sides::One).unwrap();
    let area = PolygonSampler::by_area(&polygon).unwrap();
    assert_eq!(polygon.sample([0.3, 0.8]), area.sample([0.3, 0.8]));
    assert_eq!(Polygon::<f64>::new(&bow, Sides::Two).unwrap().sample([0.3, 0.8]), None);
    assert_eq!(Polygon::<f64>::new(&flat, Sides::Two).unwrap().pdf(DVec3::Z), 0.0);
}

#[test]
fn nothing_is_nan_for_adversarial_polygons() {
    let mut random = SplitMix64::new(9);
    for i in 0..20_000 {
        let extreme = |random: &mut SplitMix64| {
            let magnitude = 10f64.powf(random.range(-37.0, 37.0));
            [0.0, magnitude, -magnitude, 1.0, random.range(-1.0, 1.0)][random.bits() as usize % 5] as f32
        };
        let count = 3 + random.bits() as usize % 4;
        let vertices: Vec<glam::Vec3> =
            (0..count).map(|_| glam::Vec3::from_array([0; 3].map(|_| extreme(&mut random)))).collect();
        let polygon = Polygon::<f32>::new(&vertices, Sides::Two).unwrap();
        let sampler = if i % 2 == 0 {
            PolygonSampler::by_area(&polygon)
        } else {
            PolygonSampler::by_solid_angle(&polygon)
        };
        let Ok(sampler) = sampler else { continue };
        let Some(sample) = sampler.sample([random.unit() as f32, random.unit() as f32]) else { continue };
        assert!(
            sample.wi.is_normalized() && sample.pdf >= 0.0 && sample.distance >= 0.0,
            "{sample:?} {vertices:?}"
        );
        assert!(sample.pdf.is_finite() && sample.distance.is_finite(), "{sample:?} {vertices:?}");
        assert!(sampler.pdf(sample.wi).is_finite() && sampler.total().is_finite());
    }
}
