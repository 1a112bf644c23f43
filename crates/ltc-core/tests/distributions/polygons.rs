//! Integrals of the four bases over polygons, against adaptive cubature of the density.

use glam::{DMat3, DVec3, dvec3};
use ltc_core::points::SplitMix64;
use ltc_core::{
    ClampedCosine, ClampedCosineSquared, Horizon, LinearlyTransformed, Polygon, PolygonBase, Sides,
    UniformHemisphere, UniformSphere,
};
use ltc_reference::{
    AboveHorizon, BaseShape, Lobe, PolygonOptions, Tolerance, TransformedLobe, integrate_polygon,
};

use crate::support::{faces, matrix, rotation, star};

fn with<B: PolygonBase<f64>>(m: DMat3, vertices: &[DVec3], sides: Sides, horizon: Horizon) -> f64 {
    let polygon = Polygon::new(vertices, sides).unwrap();
    LinearlyTransformed::<f64, B>::new(m).unwrap().integrate_polygon(&polygon, horizon)
}

/// The closed form of one of the bases.
fn closed(shape: BaseShape, m: DMat3, vertices: &[DVec3], sides: Sides, horizon: Horizon) -> f64 {
    match shape {
        BaseShape::UniformSphere => with::<UniformSphere>(m, vertices, sides, horizon),
        BaseShape::UniformHemisphere => with::<UniformHemisphere>(m, vertices, sides, horizon),
        BaseShape::ClampedCosine => with::<ClampedCosine>(m, vertices, sides, horizon),
        BaseShape::ClampedCosineSquared => with::<ClampedCosineSquared>(m, vertices, sides, horizon),
    }
}

/// The oracle's value.
fn cubature(lobe: &impl Lobe, vertices: &[DVec3], sides: Sides) -> f64 {
    let options = PolygonOptions { two_sided: sides == Sides::Two, tolerance: Tolerance::absolute(2e-10) };
    integrate_polygon(lobe, vertices, options).unwrap().value
}

/// A matrix and a polygon that its lobe hits, above the surface, below it, or across.
fn case(random: &mut SplitMix64, condition: f64) -> (DMat3, Vec<DVec3>) {
    let m = matrix(random, condition);
    let towards = (m * dvec3(random.range(-0.8, 0.8), random.range(-0.8, 0.8), 1.0)).try_normalize().unwrap();
    let size = 10f64.powf(random.range(-1.5, 1.0));
    (m, star(random, towards, size))
}

#[test]
fn every_base_matches_the_cubature() {
    let mut random = SplitMix64::new(1);
    let mut told_apart = 0;
    for i in 0..120 {
        let condition = [1.0, 5.0, 30.0, 100.0][i % 4];
        let (m, polygon) = case(&mut random, condition);
        let sides = if i % 3 == 0 { Sides::One } else { Sides::Two };
        let values = BaseShape::ALL.map(|shape| {
            let lobe = TransformedLobe::new(shape, m).unwrap();
            let expected = cubature(&AboveHorizon(lobe), &polygon, sides);
            let got = closed(shape, m, &polygon, sides, Horizon::BOTH);
            assert!((got - expected).abs() < 1e-9, "case {i}, {shape:?}: {got} {expected}");
            let leaking = closed(shape, m, &polygon, sides, Horizon::COSINE);
            let expected = cubature(&lobe, &polygon, sides);
            assert!((leaking - expected).abs() < 1e-9, "case {i}, {shape:?}: {leaking} {expected}");
            got
        });
        // Negative control: neither the other bases nor the inverse matrix would pass.
        let swapped = closed(BaseShape::ClampedCosineSquared, m.inverse(), &polygon, sides, Horizon::BOTH);
        told_apart += usize::from(
            values[1..].windows(2).all(|v| (v[0] - v[1]).abs() > 1e-6) && (swapped - values[3]).abs() > 1e-6,
        );
    }
    assert!(told_apart > 40, "{told_apart}");
}

#[test]
fn without_the_bases_horizon_the_base_goes_on_below() {
    let mut random = SplitMix64::new(2);
    for i in 0..60 {
        let (m, polygon) = case(&mut random, 10.0);
        let m = m * rotation(&mut random);
        // What lies below is the same base upside down: uniform adds, the cosine subtracts, its square adds.
        let down = m * DMat3::from_diagonal(dvec3(1.0, 1.0, -1.0));
        for (shape, sign) in [
            (BaseShape::UniformHemisphere, 1.0),
            (BaseShape::ClampedCosine, -1.0),
            (BaseShape::ClampedCosineSquared, 1.0),
        ] {
            let lobe = |m| AboveHorizon(TransformedLobe::new(shape, m).unwrap());
            let expected =
                cubature(&lobe(m), &polygon, Sides::Two) + sign * cubature(&lobe(down), &polygon, Sides::Two);
            // The signed cosine over a light around the nadir is another matter: its boundary sum wraps.
            if shape == BaseShape::ClampedCosine && expected < 0.0 {
                continue;
            }
            let got = closed(shape, m, &polygon, Sides::Two, Horizon::SURFACE);
            assert!((got - expected.clamp(0.0, 1.0)).abs() < 1e-9, "case {i}, {shape:?}: {got} {expected}");
        }
        let sphere = [Horizon::SURFACE, Horizon::BOTH]
            .map(|horizon| closed(BaseShape::UniformSphere, m, &polygon, Sides::Two, horizon));
        assert_eq!(sphere[0], sphere[1], "a sphere has no horizon");
    }
}

#[test]
fn a_box_around_the_point_holds_everything() {
    let mut random = SplitMix64::new(3);
    for i in 0..200 {
        let m = matrix(&mut random, [1.0, 30.0, 1e4][i % 3]);
        let half = dvec3(1.0, random.range(0.01, 1.0), random.range(0.1, 10.0));
        for shape in BaseShape::ALL {
            let sum = |horizon| {
                faces(half).iter().map(|face| closed(shape, m, face, Sides::One, horizon)).sum::<f64>()
            };
            assert!((sum(Horizon::COSINE) - 1.0).abs() < 1e-10, "{shape:?} {m}: {}", sum(Horizon::COSINE));
            assert!(sum(Horizon::BOTH) <= 1.0 + 1e-10);
        }
    }
}

#[test]
fn vertex_order_scale_and_the_bases_symmetry_do_not_matter() {
    let mut random = SplitMix64::new(4);
    for _ in 0..300 {
        let (m, polygon) = case(&mut random, 100.0);
        let about_z = m * DMat3::from_rotation_z(random.range(0.0, 6.0));
        let turn = DMat3::from_rotation_z(random.range(0.0, 6.0));
        let (scale, shift) = (10f64.powf(random.range(-6.0, 6.0)), random.bits() as usize % polygon.len());
        let mut rotated = polygon.clone();
        rotated.rotate_left(shift);
        let reversed: Vec<DVec3> = polygon.iter().rev().copied().collect();
        let scaled: Vec<DVec3> = polygon.iter().map(|v| *v * scale).collect();
        let turned: Vec<DVec3> = polygon.iter().map(|v| turn * *v).collect();
        for shape in BaseShape::ALL {
            let value = |m, vertices: &[DVec3]| closed(shape, m, vertices, Sides::Two, Horizon::BOTH);
            let expected = value(m, &polygon);
            for (name, got) in [
                ("first vertex", value(m, &rotated)),
                ("winding", value(m, &reversed)),
                ("scale of the light", value(m, &scaled)),
                ("scale of M", value(m * 1e-3, &polygon)),
                ("turned base", value(about_z, &polygon)),
                ("turned frame", value(turn * m, &turned)),
            ] {
                assert!((got - expected).abs() < 1e-11, "{name}, {shape:?}: {got} {expected}");
            }
            let sides = [&polygon, &reversed].map(|v| closed(shape, m, v, Sides::One, Horizon::BOTH));
            assert!(sides[0].min(sides[1]) == 0.0 && (sides[0].max(sides[1]) - expected).abs() < 1e-11);
        }
    }
}

#[test]
fn a_light_cut_in_two_sums_to_the_whole() {
    let mut random = SplitMix64::new(5);
    let mut cuts = 0;
    for _ in 0..600 {
        let m = matrix(&mut random, 100.0);
        let towards = (m * dvec3(0.5, -0.3, 1.0)).try_normalize().unwrap();
        let polygon = star(&mut random, towards, 0.7);
        // Cut from the first vertex to the centre and on to another vertex. Where all vertices are seen from the centre, and in
        // less than half a turn each from the last, both parts are simple, and one of them may be concave at the centre.
        let normal = |v: &[DVec3]| v.windows(2).map(|e| (e[0] - v[0]).cross(e[1] - v[0])).sum::<DVec3>();
        let whole = normal(&polygon);
        let turns = (0..polygon.len()).map(|i| {
            let (a, b) = (polygon[i] - towards, polygon[(i + 1) % polygon.len()] - towards);
            a.cross(b).dot(whole)
        });
        if turns.into_iter().any(|turn| turn <= 0.0) {
            continue;
        }
        cuts += 1;
        let k = 1 + random.bits() as usize % (polygon.len() - 1);
        let parts = [[&polygon[..=k], &[towards]].concat(), [&polygon[k..], &[polygon[0], towards]].concat()];
        for shape in BaseShape::ALL {
            let value = |v: &[DVec3]| closed(shape, m, v, Sides::Two, Horizon::BOTH);
            let sum = value(&parts[0]) + value(&parts[1]);
            assert!((sum - value(&polygon)).abs() < 1e-11, "{shape:?} {k} {polygon:?}: {sum}");
        }
    }
    assert!(cuts > 200, "{cuts}");
}

#[test]
fn values_change_steadily_as_a_light_sinks_or_a_point_crosses_its_plane() {
    let m = DMat3::from_cols(dvec3(0.5, 0.0, 0.1), dvec3(0.1, 0.3, 0.0), dvec3(-0.3, 0.2, 1.0));
    let square = [dvec3(1.0, -0.5, -0.5), dvec3(1.0, 0.5, -0.5), dvec3(1.2, 0.5, 0.5), dvec3(1.2, -0.5, 0.5)];
    let ceiling =
        [dvec3(-1.0, -1.0, 0.0), dvec3(-1.0, 1.0, 0.0), dvec3(1.0, 1.0, 0.0), dvec3(1.0, -1.0, 0.0)];
    for shape in BaseShape::ALL {
        // Down through the horizon in steps of 1e-3, until nothing is left.
        let sinking: Vec<f64> = (0..=1200)
            .map(|i| square.map(|v| v - DVec3::Z * 1e-3 * f64::from(i)))
            .map(|v| closed(shape, m, &v, Sides::Two, Horizon::BOTH))
            .collect();
        assert!(sinking[0] > 1e-4 && sinking[1200] == 0.0, "{shape:?}: {} {}", sinking[0], sinking[1200]);
        assert!(sinking.windows(2).all(|v| (v[0] - v[1]).abs() < 2e-3), "{shape:?}");
        // From the middle of the light, a hair below: everything above is seen; tilted, so that the plane is no axis.
        let tilt = DMat3::from_rotation_x(0.4);
        let fill = |height: f64| {
            closed(shape, m, &ceiling.map(|v| tilt * (v + DVec3::Z * height)), Sides::Two, Horizon::BOTH)
        };
        // The cosine has the polygon light's own form, which is off by 4e-9 at a distance of 1e-9.
        let decades = if shape == BaseShape::ClampedCosine { 9 } else { 12 };
        let near: Vec<f64> = (1..=decades).map(|e| fill(10f64.powi(-e))).collect();
        assert!(
            near.windows(2).enumerate().all(|(i, v)| (v[0] - v[1]).abs() < 10f64.powi(-(i as i32))),
            "{shape:?} {near:?}"
        );
        assert_eq!(fill(0.0), 0.0);
    }
}
