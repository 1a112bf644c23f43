//! Lobes over polygons: textbook form factors, two routes, Monte Carlo, and every degenerate configuration.

mod common;

use std::f64::consts::PI;

use glam::{DMat3, DVec3, dvec3};
use ltc_reference::{
    AboveHorizon, CosineLobe, Ggx, GgxLobe, Lobe, LtcLobe, PolygonOptions, R2, ReferenceError, SplitMix64,
    Tolerance, directional_albedo, integrate_polygon, integrate_polygon_boundary, view_direction,
};

const ONE_SIDED: PolygonOptions = PolygonOptions {
    two_sided: false,
    tolerance: Tolerance { absolute: 1e-8, relative: 0.0, max_evaluations: 50_000_000 },
};
const TWO_SIDED: PolygonOptions = PolygonOptions { two_sided: true, ..ONE_SIDED };

fn value(lobe: &impl Lobe, polygon: &[DVec3], options: PolygonOptions) -> f64 {
    integrate_polygon(lobe, polygon, options).expect("the oracle converges on valid input").value
}

fn boundary(lobe: &LtcLobe, above_horizon: bool, polygon: &[DVec3], options: PolygonOptions) -> f64 {
    integrate_polygon_boundary(lobe, above_horizon, polygon, options)
        .expect("the oracle converges on valid input")
        .value
}

/// The rectangle [x0, x1] × [y0, y1] at height z, its front down.
fn overhead(x: [f64; 2], y: [f64; 2], z: f64) -> [DVec3; 4] {
    [dvec3(x[0], y[0], z), dvec3(x[0], y[1], z), dvec3(x[1], y[1], z), dvec3(x[1], y[0], z)]
}

/// Configuration factor of a differential element to a parallel a × b rectangle with a corner straight above at
/// height c (Howell's catalogue, B-4).
fn parallel_factor(a: f64, b: f64, c: f64) -> f64 {
    let (a, b) = (a / c, b / c);
    let (ra, rb) = ((1.0 + a * a).sqrt(), (1.0 + b * b).sqrt());
    (a / ra * (b / ra).atan() + b / rb * (a / rb).atan()) / (2.0 * PI)
}

/// The same for a rectangle that stands on the element's plane at distance c, b wide, a high (B-5).
fn standing_factor(a: f64, b: f64, c: f64) -> f64 {
    let r = (a * a + c * c).sqrt();
    ((b / c).atan() - c / r * (b / r).atan()) / (2.0 * PI)
}

#[test]
fn textbook_factor_of_a_parallel_rectangle() {
    let identity = LtcLobe::new(DMat3::IDENTITY).expect("the oracle converges on valid input");
    for (a, b, c) in [(1.0, 1.0, 1.0), (3.0, 0.2, 0.5), (1.0, 1.0, 1e-6), (1.0, 2.0, 1e4), (1e6, 1e6, 1.0)] {
        let exact = parallel_factor(a, b, c);
        let corner = overhead([0.0, a], [0.0, b], c);
        for got in [
            value(&CosineLobe, &corner, ONE_SIDED),
            value(&identity, &corner, ONE_SIDED),
            boundary(&identity, false, &corner, ONE_SIDED),
        ] {
            assert!((got - exact).abs() < 1e-8, "({a}, {b}, {c}): {got} {exact}");
        }
        // All four quarters at once: the origin is below the middle.
        let whole = value(&CosineLobe, &overhead([-a, a], [-b, b], c), ONE_SIDED);
        assert!((whole - 4.0 * exact).abs() < 1e-8, "({a}, {b}, {c}): {whole}");
    }
    // Negative control: without the receiver's cosine, or at 1 % more distance, it does not fit.
    let exact = parallel_factor(1.0, 1.0, 1.0);
    let square = overhead([0.0, 1.0], [0.0, 1.0], 1.0);
    assert!((value(&|_: DVec3| 1.0 / PI, &square, ONE_SIDED) - exact).abs() > 1e-2);
    assert!((value(&CosineLobe, &overhead([0.0, 1.0], [0.0, 1.0], 1.01), ONE_SIDED) - exact).abs() > 1e-4);
}

#[test]
fn horizon_cuts_a_standing_rectangle() {
    for (a, b, c) in [(1.0, 1.0, 1.0), (0.1, 3.0, 0.5), (5.0, 0.3, 0.01)] {
        let exact = standing_factor(a, b, c);
        for below in [0.0, 0.5, 10.0] {
            let wall = [dvec3(c, 0.0, -below), dvec3(c, 0.0, a), dvec3(c, b, a), dvec3(c, b, -below)];
            let wall = common::reversed(&wall);
            let facing = value(&CosineLobe, &wall, ONE_SIDED)
                + value(&CosineLobe, &common::reversed(&wall), ONE_SIDED);
            assert!((facing - exact).abs() < 1e-8, "({a}, {b}, {c}) {below}: {facing} {exact}");
            // Negative control: a lobe that goes on below the horizon sees the lower part, too.
            let unclipped = value(&|w: DVec3| w.z.abs() / PI, &wall, TWO_SIDED);
            assert_eq!(unclipped > exact + 1e-3, below > 0.0, "{unclipped} {exact}");
        }
    }
}

#[test]
fn both_routes_agree_up_to_condition_1e4() {
    let mut random = SplitMix64::new(7);
    let mut seen = 0;
    for condition in [1.0, 10.0, 100.0, 1e3, 1e4] {
        for _ in 0..60 {
            let ltc = common::ltc(&mut random, condition);
            let distance = common::log_uniform(&mut random, 0.1, 10.0);
            let polygon = common::star(&mut random, distance, 1.0);
            for above in [false, true] {
                let by_boundary = boundary(&ltc, above, &polygon, TWO_SIDED);
                let by_area = if above {
                    value(&AboveHorizon(ltc), &polygon, TWO_SIDED)
                } else {
                    value(&ltc, &polygon, TWO_SIDED)
                };
                assert!(
                    (by_area - by_boundary).abs() < 1e-7,
                    "{condition}: {by_area} {by_boundary} {polygon:?}"
                );
                assert!((-1e-9..=1.0 + 1e-9).contains(&by_area), "{by_area}");
                seen += usize::from(by_area > 1e-6);
            }
        }
    }
    assert!(seen > 200, "too many of the draws saw nothing: {seen}");
}

#[test]
fn a_planted_error_shows_in_the_comparison() {
    let mut random = SplitMix64::new(7);
    let (mut jacobian, mut clipping) = (0.0f64, 0.0f64);
    for _ in 0..40 {
        let ltc = common::ltc(&mut random, 10.0);
        let polygon = common::star(&mut random, 1.0, 1.0);
        let by_boundary = boundary(&ltc, true, &polygon, TWO_SIDED);
        // The exponent 3 of the Jacobian off by a thousandth: far more than the 1e-7 that the routes differ by.
        let bent = |w: DVec3| {
            let length = (ltc.cosine_from_target() * w).length();
            AboveHorizon(ltc).density(w) * length.powf(1e-3)
        };
        let options = PolygonOptions { tolerance: Tolerance::absolute(1e-6), ..TWO_SIDED };
        jacobian = jacobian.max((value(&bent, &polygon, options) - by_boundary).abs());
        // The surface's horizon forgotten.
        clipping = clipping.max((value(&ltc, &polygon, TWO_SIDED) - by_boundary).abs());
    }
    assert!(jacobian > 1e-5, "{jacobian}");
    assert!(clipping > 1e-2, "{clipping}");
}

/// Is the direction in the cone over a triangle?
fn in_cone(w: DVec3, [a, b, c]: [DVec3; 3]) -> bool {
    let sides = [w.dot(a.cross(b)), w.dot(b.cross(c)), w.dot(c.cross(a))];
    let facing = a.dot(b.cross(c)).signum();
    sides.iter().all(|s| s * facing > 0.0)
}

#[test]
fn samples_of_the_lobe_hit_the_light_as_often_as_integrated() {
    let mut random = SplitMix64::new(13);
    let mut told_apart = 0;
    for _ in 0..30 {
        let ltc = common::ltc(&mut random, 100.0);
        // Lights around a direction of the lobe above the horizon, so that they are hit.
        let mut directions = (0..1000).map(|_| ltc.sample(random.next_2d()));
        let Some(towards) = directions.find(|w| w.z > 0.3) else { continue };
        let frame = common::rotation(&mut random);
        let corner = |x: f64, y: f64| towards + 0.3 * (x * frame.x_axis + y * frame.y_axis);
        let triangle = [corner(1.0, 0.0), corner(-0.6, 0.8), corner(-0.6, -0.8)];
        let n = 100_000;
        let hits = (0..n)
            .map(|_| ltc.sample(random.next_2d()))
            .filter(|&w| w.z > 0.0 && in_cone(w, triangle))
            .count();
        let fraction = hits as f64 / f64::from(n);
        let got = value(&AboveHorizon(ltc), &triangle, TWO_SIDED);
        let sigma = (got * (1.0 - got) / f64::from(n)).sqrt().max(1.0 / f64::from(n));
        assert!((got - fraction).abs() < 5.0 * sigma, "{got} {fraction}");
        let transposed =
            LtcLobe::new(ltc.target_from_cosine().transpose()).expect("the oracle converges on valid input");
        let wrong = value(&AboveHorizon(transposed), &triangle, TWO_SIDED);
        told_apart += usize::from((wrong - fraction).abs() > 5.0 * sigma);
    }
    assert!(told_apart > 20, "the transposed matrix must be told apart: {told_apart}");
}

#[test]
fn a_box_around_the_point_collects_the_whole_lobe() {
    let faces = |half: f64| {
        let corner = |i: usize| {
            dvec3(
                if i & 1 == 0 { -half } else { half },
                if i & 2 == 0 { -half } else { half },
                if i & 4 == 0 { -half } else { half },
            )
        };
        [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
            .map(|face| common::reversed(&face.map(corner)))
    };
    let sum = |lobe: &dyn Fn(&[DVec3]) -> f64| faces(0.7).iter().map(|face| lobe(face)).sum::<f64>();
    for (ax, ay, theta) in
        [(1.0, 0.2, 0.4), (0.1, 0.1, 1.3), (1e-2, 0.3, 1.0), (1e-4, 1e-4, 0.8), (1e-3, 1e-4, 1.4)]
    {
        let ggx = Ggx::new(ax, ay).expect("the oracle converges on valid input");
        let wo = view_direction(theta, 0.9);
        let lobe = GgxLobe { ggx, wo };
        let options = PolygonOptions { tolerance: Tolerance::absolute(1e-7), ..TWO_SIDED };
        let collected = sum(&|face| value(&lobe, face, options));
        let albedo = directional_albedo(&ggx, wo, Tolerance::absolute(1e-7))
            .expect("the oracle converges on valid input");
        assert!((collected - albedo.magnitude.value).abs() < 1e-6, "{ggx:?}: {collected} {albedo:?}");
    }
    let mut random = SplitMix64::new(17);
    for _ in 0..5 {
        let ltc = common::ltc(&mut random, 1e3);
        let total = sum(&|face| value(&ltc, face, TWO_SIDED));
        assert!((total - 1.0).abs() < 1e-7, "{total}");
        let total = sum(&|face| boundary(&ltc, false, face, TWO_SIDED));
        assert!((total - 1.0).abs() < 1e-7, "{total}");
    }
}

#[test]
fn a_notch_counts_once_and_orientation_decides_the_side() {
    // An L: the square without its upper right quarter, front down.
    let l = [[0.0, 0.0], [0.0, 2.0], [1.0, 2.0], [1.0, 1.0], [2.0, 1.0], [2.0, 0.0]];
    // Starting at each vertex changes the fan, also to ones that leave the polygon, and must not change the value.
    let exact = parallel_factor(2.0, 2.0, 1.0)
        - (parallel_factor(2.0, 2.0, 1.0) - 2.0 * parallel_factor(2.0, 1.0, 1.0)
            + parallel_factor(1.0, 1.0, 1.0));
    for start in 0..l.len() {
        let polygon: Vec<DVec3> =
            (0..l.len()).map(|i| l[(start + i) % l.len()]).map(|[x, y]| dvec3(x, y, 1.0)).collect();
        let got = value(&CosineLobe, &polygon, ONE_SIDED);
        assert!((got - exact).abs() < 1e-8, "{start}: {got} {exact}");
        assert_eq!(value(&CosineLobe, &common::reversed(&polygon), ONE_SIDED), 0.0);
        let back = value(&CosineLobe, &common::reversed(&polygon), TWO_SIDED);
        assert!((back - exact).abs() < 1e-8, "{back}");
        // Negative control: the hull would be another light.
        let hull: Vec<DVec3> = polygon.iter().copied().filter(|p| (p.x, p.y) != (1.0, 1.0)).collect();
        assert!((value(&CosineLobe, &hull, ONE_SIDED) - exact).abs() > 1e-3);
    }
}

#[test]
fn degenerate_lights_give_zero_and_invalid_ones_an_error() {
    let identity = LtcLobe::new(DMat3::IDENTITY).expect("the oracle converges on valid input");
    let degenerate: [&[DVec3]; 7] = [
        &[DVec3::Z, DVec3::Z, DVec3::Z],
        &[dvec3(0.0, 0.0, 1.0), dvec3(1.0, 0.0, 1.0), dvec3(2.0, 0.0, 1.0)],
        &[DVec3::ZERO, DVec3::X, DVec3::Z],
        &[dvec3(-1.0, 0.0, -1.0), dvec3(1.0, 0.0, -1.0), dvec3(0.0, 0.0, 2.0)],
        &[dvec3(-1.0, -1.0, -1.0), dvec3(1.0, -1.0, -1.0), dvec3(0.0, 1.0, -1.0)],
        &[dvec3(-1.0, 1.0, 0.0), dvec3(1.0, 1.0, 0.0), dvec3(0.0, 2.0, 0.0)],
        &[DVec3::ZERO, DVec3::ZERO, DVec3::ZERO],
    ];
    for polygon in degenerate {
        for options in [ONE_SIDED, TWO_SIDED] {
            assert_eq!(value(&identity, polygon, options), 0.0, "{polygon:?}");
            assert_eq!(boundary(&identity, true, polygon, options).abs(), 0.0, "{polygon:?}");
        }
    }
    let two = integrate_polygon(&identity, &[DVec3::X, DVec3::Z], ONE_SIDED);
    assert_eq!(two, Err(ReferenceError::TooFewVertices { count: 2 }));
    for bad in [f64::NAN, f64::INFINITY] {
        let polygon = [DVec3::X, DVec3::Y, dvec3(0.0, bad, 1.0)];
        let got = integrate_polygon(&identity, &polygon, ONE_SIDED);
        assert!(matches!(got, Err(ReferenceError::NonFiniteInput { .. })), "{got:?}");
        let lobe = |_: DVec3| bad;
        let got = integrate_polygon(&lobe, &overhead([0.0, 1.0], [0.0, 1.0], 1.0), ONE_SIDED);
        assert!(matches!(got, Err(ReferenceError::NonFiniteIntegrand { .. })), "{got:?}");
    }
    let hopeless =
        PolygonOptions { tolerance: Tolerance { max_evaluations: 1000, ..ONE_SIDED.tolerance }, ..ONE_SIDED };
    let ragged = |w: DVec3| if (40.0 * w.x).sin() > 0.0 { 1.0 } else { 0.0 };
    let got = integrate_polygon(&ragged, &overhead([0.0, 1.0], [0.0, 1.0], 1.0), hopeless);
    assert!(matches!(got, Err(ReferenceError::NotConverged { .. })), "{got:?}");
}

#[test]
fn scale_of_the_scene_does_not_matter() {
    let mut random = SplitMix64::new(23);
    for _ in 0..20 {
        let ltc = common::ltc(&mut random, 100.0);
        let polygon = common::star(&mut random, 1.0, 0.8);
        let expected = value(&ltc, &polygon, TWO_SIDED);
        for scale in [1e-200, 1e-6, 1e6, 1e200] {
            let scaled: Vec<DVec3> = polygon.iter().map(|&p| p * scale).collect();
            assert!((value(&ltc, &scaled, TWO_SIDED) - expected).abs() < 1e-8, "{scale}");
        }
    }
}

#[test]
fn the_estimated_error_bounds_the_true_one_over_decades() {
    let mut random = SplitMix64::new(29);
    let points = R2::new();
    for i in 0..40 {
        let ltc = common::ltc(&mut random, 1e3);
        let towards = ltc.sample(points.point(i));
        let polygon: Vec<DVec3> = common::star(&mut random, 0.0, 0.5).iter().map(|&p| p + towards).collect();
        let exact = boundary(
            &ltc,
            false,
            &polygon,
            PolygonOptions { tolerance: Tolerance::absolute(1e-13), ..TWO_SIDED },
        );
        for absolute in [1e-3, 1e-5, 1e-7, 1e-9] {
            let options =
                PolygonOptions { tolerance: Tolerance { absolute, ..TWO_SIDED.tolerance }, ..TWO_SIDED };
            let got =
                integrate_polygon(&ltc, &polygon, options).expect("the oracle converges on valid input");
            assert!(
                got.error <= absolute && (got.value - exact).abs() <= absolute,
                "{absolute}: {got:?} {exact}"
            );
        }
    }
}
