//! What must hold for every polygon, quad and batch, whatever the numbers.

#![expect(clippy::unwrap_used, reason = "a test fails by a panic")]

mod common;

use common::{Case, SWEEPS, across, case, decades, lobe, unit};
use glam::{DMat3, DVec3, Vec3};
use ltc_core::points::SplitMix64;
use ltc_core::{Horizon, Light, Ltc, LtcBatch, Polygon, Quad, QuadBatch, Sides};
use ltc_reference::{LtcLobe, PolygonOptions, Tolerance, integrate_polygon_boundary};

const HORIZONS: [Horizon; 4] = [Horizon::BOTH, Horizon::SURFACE, Horizon::COSINE, Horizon::NONE];

fn fraction(m: DMat3, vertices: &[DVec3], sides: Sides) -> f64 {
    Polygon::<f64>::new(vertices, sides).unwrap().integrate(&Ltc::new(m).unwrap())
}

fn cases(seed: u64, count: usize) -> impl Iterator<Item = Case> {
    let mut rng = SplitMix64::new(seed);
    (0..count).map(move |i| case(&mut rng, SWEEPS[i % SWEEPS.len()]))
}

#[test]
fn a_light_cut_in_two_sums_to_the_whole() {
    let mut rng = SplitMix64::new(2);
    for c in cases(1, 3000) {
        let [p, q, r, s] = c.quad;
        let (t, u) = (p.lerp(q, rng.unit()), s.lerp(r, rng.unit()));
        let whole = fraction(c.m, &c.quad, Sides::Two);
        let parts = fraction(c.m, &[p, t, u, s], Sides::Two) + fraction(c.m, &[t, q, r, u], Sides::Two);
        // New vertices are rounded, which tilts the plane: near it, by as much as it is near.
        let normal = (q - p).cross(s - p);
        let height = (normal.dot(p) / normal.length()).abs() / (p.length() + r.length());
        assert!((whole - parts).abs() < 1e-13 * c.condition + 1e-15 / height, "{whole} {parts} {c:?}");
    }
}

#[test]
fn rotation_scale_and_order_do_not_matter() {
    let mut rng = SplitMix64::new(4);
    for c in cases(3, 3000) {
        let value = fraction(c.m, &c.quad, Sides::Two);
        let turn = DMat3::from_rotation_z(rng.range(0.0, 6.3));
        // A turn rounds, and moves a point near the light's plane.
        let [p, q, r, s] = c.quad;
        let normal = (q - p).cross(s - p);
        let height = (normal.dot(p) / normal.length()).abs() / (p.length() + r.length());
        let turned = fraction(turn * c.m, &c.quad.map(|v| turn * v), Sides::Two);
        assert!((value - turned).abs() < 1e-14 * c.condition + 1e-15 / height, "{value} {turned} {c:?}");
        assert_eq!(value, fraction(c.m * 4.0, &c.quad.map(|v| v * 2_f64.powi(40)), Sides::Two));
        for order in [[q, r, s, p], [s, r, q, p]] {
            let other = fraction(c.m, &order, Sides::Two);
            assert!((value - other).abs() < 1e-12, "{value} {other} {c:?}");
        }
    }
}

#[test]
fn one_side_or_the_other() {
    for c in cases(5, 3000) {
        let mut back = c.quad;
        back.reverse();
        let (one, other) = (fraction(c.m, &c.quad, Sides::One), fraction(c.m, &back, Sides::One));
        let both = fraction(c.m, &c.quad, Sides::Two);
        assert!(one.min(other) == 0.0 && (one.max(other) - both).abs() < 1e-12, "{one} {other} {both} {c:?}");
    }
}

/// Stars of 5 to 25 points, wound either way.
#[test]
fn non_convex_polygons_of_any_winding_are_the_oracle() {
    let options = PolygonOptions {
        two_sided: true,
        tolerance: Tolerance { absolute: 1e-11, relative: 0.0, max_evaluations: 1_000_000 },
    };
    let mut rng = SplitMix64::new(6);
    for round in 0..300 {
        let (alpha, theta) = (decades(&mut rng, -1.5, 0.0), rng.range(0.0, 1.3));
        let (m, _) = lobe(&mut rng, alpha, theta);
        let normal = unit(&mut rng);
        let [u, v] = across(&mut rng, normal);
        let centre = normal * decades(&mut rng, -2.0, 1.0) + u * rng.range(-2.0, 2.0);
        let count = 5 + round % 21;
        let mut star: Vec<DVec3> = (0..2 * count)
            .map(|i| {
                let (sin, cos) = (core::f64::consts::PI * i as f64 / count as f64).sin_cos();
                centre + (u * cos + v * sin) * rng.range(0.1, 2.0)
            })
            .collect();
        let lobe = LtcLobe::new(m).unwrap();
        let truth = integrate_polygon_boundary(&lobe, true, &star, options).unwrap().value;
        for _ in 0..2 {
            let value = fraction(m, &star, Sides::Two);
            assert!((value - truth).abs() < 1e-9, "{value} {truth} {star:?}");
            star.reverse();
        }
    }
}

#[test]
fn quads_are_polygons_whatever_their_shape() {
    let mut rng = SplitMix64::new(7);
    for i in 0..4000 {
        let (alpha, theta) = (decades(&mut rng, -2.0, 0.0), rng.range(0.0, 1.5));
        let (m, _) = lobe(&mut rng, alpha, theta);
        let normal = unit(&mut rng);
        let [u, v] = across(&mut rng, normal);
        let foot = normal * decades(&mut rng, -3.0, 1.0);
        // Convex, darts and bow-ties as they come; a triangle; a repeated corner; three in a row.
        let mut quad = [(); 4].map(|()| foot + u * rng.range(-2.0, 2.0) + v * rng.range(-2.0, 2.0));
        match i % 8 {
            5 => quad[3] = quad[2],
            6 => quad[1] = quad[0].lerp(quad[2], 0.4),
            7 => quad[3] = quad[1],
            _ => {}
        }
        let ltc = Ltc::<f64>::new(m).unwrap();
        let light = Quad::<f64>::new(quad, Sides::Two).unwrap();
        for horizon in HORIZONS {
            let (a, b) =
                (light.integrate_within(&ltc, horizon), light.polygon().integrate_within(&ltc, horizon));
            assert!((a - b).abs() < 1e-11, "{a} {b} {horizon:?} {quad:?} {m}");
        }
    }
}

/// Coordinates of all sizes, zero, subnormal and huge ones among them, and matrices to match.
#[test]
fn no_finite_input_gives_anything_but_a_fraction() {
    let sizes = [0.0, 1e-45, 1e-40, 1e-30, 1e-7, 1.0, 1.0 + 1e-7, 1e7, 1e30, 3e38];
    let mut rng = SplitMix64::new(8);
    let number = |rng: &mut SplitMix64| {
        let size = sizes[(rng.unit() * sizes.len() as f64) as usize] as f32;
        let size = if rng.unit() < 0.5 { size } else { size * rng.unit() as f32 };
        if rng.unit() < 0.5 { -size } else { size }
    };
    let (mut quads, mut ltcs) = (QuadBatch::new(), LtcBatch::new());
    for i in 0..60_000 {
        let mut vertices = [(); 4].map(|()| Vec3::new(number(&mut rng), number(&mut rng), number(&mut rng)));
        if i % 3 == 0 {
            vertices = vertices.map(|v| Vec3::new(v.x, v.y, v.x));
        }
        let mut entries = [0.0; 9];
        entries.fill_with(|| decades(&mut rng, -12.0, 0.0) * [-1.0, 1.0][(rng.unit() * 2.0) as usize]);
        let m = DMat3::from_cols_array(&entries);
        let (Ok(ltc), Ok(wide)) = (Ltc::<f32>::new(m.as_mat3()), Ltc::<f64>::new(m)) else { continue };
        let quad = Quad::<f32>::new(vertices, Sides::Two).unwrap();
        let double = vertices.map(|v| v.as_dvec3() * if i % 2 == 0 { 1e250 } else { 1e-270 });
        let double = Quad::<f64>::new(double, Sides::Two).unwrap();
        for horizon in HORIZONS {
            for value in [
                f64::from(quad.integrate_within(&ltc, horizon)),
                f64::from(quad.polygon().integrate_within(&ltc, horizon)),
                f64::from(quad.integrate_with::<ltc_core::Rational>(&ltc, horizon)),
                f64::from(quad.integrate_proxy::<ltc_core::Cubic>(&ltc, horizon.surface)),
                double.integrate_within(&wide, horizon),
                double.polygon().integrate_within(&wide, horizon),
            ] {
                assert!((0.0..=1.0).contains(&value), "{value} for {vertices:?} {m}");
            }
        }
        quads.push(quad);
        ltcs.push(ltc);
    }
    assert!(quads.len() > 10_000, "most matrices have no inverse: {}", quads.len());
    let mut out = vec![f32::NAN; quads.len()];
    for horizon in HORIZONS {
        quads.integrate_each(&ltcs, horizon, &mut out).unwrap();
        assert!(out.iter().all(|value| (0.0..=1.0).contains(value)));
    }
}

#[test]
fn lights_without_measure_are_exactly_dark() {
    let mut rng = SplitMix64::new(9);
    for _ in 0..3000 {
        let (alpha, theta) = (decades(&mut rng, -3.0, 0.0), rng.range(0.0, 1.5));
        let (m, _) = lobe(&mut rng, alpha, theta);
        let (p, direction) = (unit(&mut rng) * decades(&mut rng, -3.0, 3.0), unit(&mut rng));
        // On a line, each rounded on its own; and a segment there and back.
        let needle = [0.0, 0.3, 1.0, 0.7].map(|t| p + direction * (t * rng.range(0.5, 2.0)));
        let there_and_back = [p, p + direction, p + direction * 2.0, p + direction];
        for quad in [needle, there_and_back, [p; 4], [DVec3::ZERO; 4]] {
            assert_eq!(fraction(m, &quad, Sides::Two), 0.0, "{quad:?}");
            let light = Quad::<f64>::new(quad, Sides::Two).unwrap();
            assert_eq!(light.integrate(&Ltc::new(m).unwrap()), 0.0, "{quad:?}");
        }
    }
}

/// A light that sinks goes out without a jump, and is dark when it is below; with the horizon of cosine space alone it
/// is not, which is the leak.
#[test]
fn a_light_sinks_without_a_jump() {
    let (m, _) = lobe(&mut SplitMix64::new(10), 0.3, 1.2);
    let axis = m * DVec3::Z;
    let ltc = Ltc::<f64>::new(m).unwrap();
    let at = |z: f64| {
        let centre = DVec3::new(axis.x, axis.y, 0.0).normalize_or_zero() * 2.0 + DVec3::Z * z;
        let side = DVec3::Z.cross(centre).normalize_or_zero();
        Quad::<f64>::new(common::parallelogram(centre, side, DVec3::Z), Sides::Two).unwrap()
    };
    let step = 1e-5;
    let (mut previous, mut leak) = (at(1.5).integrate(&ltc), 0.0_f64);
    for i in 1..=300_000 {
        let light = at(1.5 - step * f64::from(i));
        let value = light.integrate(&ltc);
        assert!((value - previous).abs() < step, "{i}: {previous} {value}");
        leak = leak.max(light.integrate_within(&ltc, Horizon::COSINE) - value);
        previous = value;
    }
    assert_eq!(previous, 0.0);
    assert!(leak > 0.05, "{leak}");
}

/// On either side of the light's plane a point near its inside sees half of all directions: of the cosine what is on
/// that side, together all of it. In the plane it is dark.
#[test]
fn a_point_that_crosses_the_plane_sees_the_halves_of_the_lobe() {
    let mut rng = SplitMix64::new(11);
    for _ in 0..300 {
        let normal = unit(&mut rng);
        let [u, v] = across(&mut rng, normal);
        let foot = u * rng.range(-0.5, 0.5) + v * rng.range(-0.5, 0.5);
        let at = |height: f64| {
            let quad = common::parallelogram(foot + normal * height, u, v);
            Quad::<f64>::new(quad, Sides::Two).unwrap().irradiance()
        };
        // A half-space over the clamped cosine: (1 + n_z)/2.
        let half = 0.5 * (1.0 + normal.z);
        let (above, below) = (at(1e-9), at(-1e-9));
        assert!((above - half).abs() < 1e-7 && (below - (1.0 - half)).abs() < 1e-7, "{above} {below} {half}");
        assert_eq!(at(0.0), 0.0);
    }
}

#[test]
fn batches_of_every_length_are_their_quads() {
    let all: Vec<Case> = cases(12, 70).collect();
    let quad = |c: &Case, i: usize| {
        let sides = if i.is_multiple_of(2) { Sides::Two } else { Sides::One };
        Quad::<f32>::new(c.quad.map(DVec3::as_vec3), sides).unwrap()
    };
    for len in 0..=all.len() {
        for horizon in HORIZONS {
            let mut quads = QuadBatch::new();
            let mut ltcs = LtcBatch::new();
            quads.extend(all[..len].iter().enumerate().map(|(i, c)| quad(c, i)));
            ltcs.extend(all[..len].iter().map(|c| Ltc::<f32>::new(c.m.as_mat3()).unwrap()));
            let mut out = vec![f32::NAN; len];
            quads.integrate_each(&ltcs, horizon, &mut out).unwrap();
            let one = Ltc::<f32>::new(all[3].m.as_mat3()).unwrap();
            let mut out_one = vec![f32::NAN; len];
            quads.integrate(&one, horizon, &mut out_one).unwrap();
            for (i, c) in all[..len].iter().enumerate() {
                let ltc = Ltc::<f32>::new(c.m.as_mat3()).unwrap();
                let single = quad(c, i).integrate_within(&ltc, horizon);
                assert!(f64::from((out[i] - single).abs()) < c.tolerance(), "{} {single}", out[i]);
                let single = quad(c, i).integrate_within(&one, horizon);
                assert!(
                    f64::from((out_one[i] - single).abs()) < all[3].tolerance(),
                    "{} {single}",
                    out_one[i]
                );
            }
        }
    }
    let mut quads = QuadBatch::new();
    quads.push(quad(&all[0], 0));
    assert!(quads.integrate(&Ltc::cosine(), Horizon::BOTH, &mut [0.0; 2]).is_err());
    assert!(quads.integrate_each(&LtcBatch::new(), Horizon::BOTH, &mut [0.0; 1]).is_err());
    assert!(quads.get(0).is_some() && quads.get(1).is_none());
}
