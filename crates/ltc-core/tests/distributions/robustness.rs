//! Degenerate, adversarial and single-precision inputs.

use glam::{DMat3, DVec3, Mat3, Vec3, dvec3};
use ltc_core::points::SplitMix64;
use ltc_core::{
    Base, ClampedCosine, ClampedCosineSquared, Horizon, LinearlyTransformed, Ltc, LtcMixture, Polygon,
    PolygonBase, Sides, UniformHemisphere, UniformSphere,
};

use crate::support::{matrix, rotation, star};

/// Runs `$body` with `$base` standing for each base in turn.
macro_rules! for_each_base {
    ($base:ident => $body:block) => {{
        {
            type $base = UniformSphere;
            $body
        }
        {
            type $base = UniformHemisphere;
            $body
        }
        {
            type $base = ClampedCosine;
            $body
        }
        {
            type $base = ClampedCosineSquared;
            $body
        }
    }};
}

fn dark<B: PolygonBase<f64>>(m: DMat3, polygon: &[DVec3], name: &str) {
    let distribution = LinearlyTransformed::<f64, B>::new(m).unwrap();
    let value = distribution.integrate_polygon(&Polygon::new(polygon, Sides::Two).unwrap(), Horizon::BOTH);
    assert_eq!(value, 0.0, "{name}, {}", core::any::type_name::<B>());
}

#[test]
fn lights_of_no_measure_are_exactly_dark() {
    let mut random = SplitMix64::new(41);
    let p = dvec3(0.3, 0.2, 1.0);
    let on = |a: f64, b: f64| p * a + dvec3(1.0, -0.5, 0.2) * b;
    for condition in [1.0, 30.0, 1e4] {
        let m = matrix(&mut random, condition);
        for_each_base!(B => {
            dark::<B>(m, &[p; 5], "all vertices in one point");
            dark::<B>(m, &[DVec3::ZERO; 3], "all vertices at the shading point");
            dark::<B>(m, &[p, p * 2.0, p * 3.0], "a line through the shading point");
            dark::<B>(m, &[dvec3(0.0, 1.0, 1.0), dvec3(1.0, 1.0, 1.0), dvec3(2.0, 1.0, 1.0)], "a line");
            dark::<B>(m, &[p, dvec3(1.0, 0.0, 0.5), p, dvec3(1.0, 0.0, 0.5)], "run through both ways");
            dark::<B>(m, &[on(1.0, 1.0), on(1.0, -1.0), on(-1.0, -1.0), on(-1.0, 1.0)], "around the shading point, edge-on");
            dark::<B>(m, &[on(2.0, 1.0), on(2.0, -1.0), on(1.0, 0.0)], "edge-on");
            dark::<B>(m, &[on(0.0, 0.0), on(1.0, 1.0), on(1.0, -1.0)], "the shading point on a vertex");
            dark::<B>(m, &[on(1.0, 0.0), on(-1.0, 0.0), on(0.0, 1.0)], "the shading point on an edge");
            dark::<B>(m, &[-p, dvec3(1.0, 0.0, -0.1), dvec3(0.0, 1.0, -2.0)], "below the surface");
        });
    }
}

/// Values are finite, in [0, 1], and about the same in f32 as in f64, whatever the input.
fn hammer<B: PolygonBase<f32> + PolygonBase<f64>>(seed: u64) {
    let mut random = SplitMix64::new(seed);
    for i in 0..40_000 {
        let extreme = |random: &mut SplitMix64| {
            let magnitude = 10f64.powf(random.range(-37.0, 37.0));
            [0.0, magnitude, -magnitude, 1.0, random.range(-1.0, 1.0)][random.bits() as usize % 5] as f32
        };
        let m = if i % 2 == 0 {
            Mat3::from_cols_array(&[0; 9].map(|_| extreme(&mut random)))
        } else {
            matrix(&mut random, 10f64.powf(0.001 * f64::from(i % 8000))).as_mat3()
        };
        let count = 3 + random.bits() as usize % 5;
        let vertices: Vec<Vec3> =
            (0..count).map(|_| Vec3::from_array([0; 3].map(|_| extreme(&mut random)))).collect();
        let sides = if i % 3 == 0 { Sides::One } else { Sides::Two };
        let horizon = Horizon { surface: i % 5 != 0, cosine: i % 7 != 0 };
        if let Ok(distribution) = LinearlyTransformed::<f32, B>::new(m) {
            let value = distribution.integrate_polygon(&Polygon::new(&vertices, sides).unwrap(), horizon);
            assert!((0.0..=1.0).contains(&value), "{value}: {m} {vertices:?}");
            let w = distribution.sample([random.unit() as f32, random.unit() as f32]);
            let density = distribution.density(w);
            assert!(w.is_normalized() && density.is_finite() && density >= 0.0, "{density} at {w}: {m}");
        }
        if let Ok(distribution) = LinearlyTransformed::<f64, B>::new(m.as_dmat3()) {
            let vertices: Vec<DVec3> = vertices.iter().map(|v| v.as_dvec3()).collect();
            let value = distribution.integrate_polygon(&Polygon::new(&vertices, sides).unwrap(), horizon);
            assert!((0.0..=1.0).contains(&value), "{value}: {m} {vertices:?}");
            let w = distribution.sample([random.unit(), random.unit()]);
            let density = distribution.density(w);
            assert!(w.is_normalized() && density.is_finite() && density >= 0.0, "{density} at {w}: {m}");
        }
    }
}

#[test]
fn adversarial_inputs_give_values_in_range() {
    for_each_base!(B => { hammer::<B>(42); });
}

/// The largest error of f32 against f64 for the same, rounded, input, condition numbers to 1e4.
fn worst_f32<B: PolygonBase<f32> + PolygonBase<f64>>(seed: u64) -> f64 {
    let mut random = SplitMix64::new(seed);
    let mut worst = 0.0f64;
    for _ in 0..20_000 {
        let condition = 10f64.powf(random.range(0.0, 4.0));
        let m = matrix(&mut random, condition).as_mat3();
        let distance = 10f64.powf(random.range(-0.5, 3.0));
        let centre = rotation(&mut random).x_axis * distance;
        let vertices: Vec<Vec3> = star(&mut random, centre, 1.0).iter().map(|v| v.as_vec3()).collect();
        let (Ok(single), Ok(double)) =
            (LinearlyTransformed::<f32, B>::new(m), LinearlyTransformed::<f64, B>::new(m.as_dmat3()))
        else {
            continue;
        };
        let wide: Vec<DVec3> = vertices.iter().map(|v| v.as_dvec3()).collect();
        let got = single.integrate_polygon(&Polygon::new(&vertices, Sides::Two).unwrap(), Horizon::BOTH);
        let expected = double.integrate_polygon(&Polygon::new(&wide, Sides::Two).unwrap(), Horizon::BOTH);
        worst = worst.max((f64::from(got) - expected).abs());
    }
    worst
}

#[test]
fn single_precision_keeps_its_bound() {
    // The clamped cosine is the polygon light's own business.
    for (name, worst) in [
        ("uniform sphere", worst_f32::<UniformSphere>(43)),
        ("uniform hemisphere", worst_f32::<UniformHemisphere>(43)),
        ("clamped cosine²", worst_f32::<ClampedCosineSquared>(43)),
    ] {
        assert!(worst < 2e-6, "{name}: {worst:e}");
    }
}

#[test]
fn samples_at_the_borders_of_the_unit_square_are_directions() {
    fn check<B: Base<f32>>() {
        let flat =
            LinearlyTransformed::<f32, B>::new(Mat3::from_diagonal(Vec3::new(1e-15, 1.0, 1.0))).unwrap();
        for distribution in [LinearlyTransformed::identity(), flat] {
            for a in [0.0, f32::MIN_POSITIVE, 0.5, 1.0 - 0.5 * f32::EPSILON, 1.0] {
                for b in [0.0, 0.25, 0.5, 1.0] {
                    let w = distribution.sample([a, b]);
                    let density = distribution.density(w);
                    assert!(
                        w.is_normalized() && density.is_finite() && density >= 0.0,
                        "{a} {b}: {w} {density}"
                    );
                }
            }
        }
    }
    for_each_base!(B => { check::<B>(); });
}

#[test]
fn what_has_no_direction_has_no_density_to_fear() {
    let mixture = LtcMixture::from(Ltc::<f64>::cosine());
    for w in [DVec3::ZERO, -DVec3::Z, DVec3::X] {
        for_each_base!(B => {
            let density = LinearlyTransformed::<f64, B>::identity().density(w);
            assert!(!density.is_nan() && density >= 0.0);
        });
        assert_eq!(mixture.density(w), 0.0);
    }
}
