//! Millions of lights made to break things: every answer is a fraction, that of a light without measure is 0, and the laws
//! that hold for integrals hold.
//!
//! In release, as `cargo xtask test` runs it: ten million inputs in both precisions.

#![expect(clippy::unwrap_used, reason = "a test fails by a panic")]
#![expect(
    clippy::redundant_closure_for_method_calls,
    reason = "a method's path is not general in its lifetimes"
)]

mod generator;

use generator::{Generator, Input};
use ltc_core::{AnyLight, Horizon, InputError, Ltc, Matrix, Real, Sides, points::SplitMix64};

/// Inputs of the unrestricted kind.
const INPUTS: u64 = if cfg!(debug_assertions) { 300_000 } else { 10_000_000 };
/// Inputs on which laws are tried.
const LAWFUL: u64 = INPUTS / 20;

fn fraction<R: Real>(m: &[f64; 9], light: &AnyLight) -> Result<f64, InputError> {
    let ltc = Ltc::<R>::new(R::Mat3::from_row_array(m.map(R::of)))?;
    Ok(light.integrate(&ltc, Horizon::BOTH)?.to_f64())
}

/// Runs `body` for numbers 0 to `count`, shared out among the processors.
fn in_parallel(count: u64, body: impl Fn(u64) + Sync) {
    let threads = std::thread::available_parallelism().map_or(1, |n| n.get() as u64);
    std::thread::scope(|scope| {
        for thread in 0..threads {
            let body = &body;
            scope.spawn(move || (thread..count).step_by(threads as usize).for_each(body));
        }
    });
}

fn with_generator<T>(seed: u64, make: impl FnOnce(&mut Generator<'_>) -> T) -> T {
    let mut rng = SplitMix64::new(seed);
    let mut word = move || rng.bits();
    make(&mut Generator::new(&mut word))
}

fn assert_is_a_fraction<R: Real>(input: &Input, seed: u64) -> bool {
    let precision = std::any::type_name::<R>();
    match fraction::<R>(&input.m, &input.light) {
        Ok(value) => {
            assert!((0.0..=1.0).contains(&value), "seed {seed}, {precision}: {value} for {input:?}");
            assert!(!input.is_nothing || value == 0.0, "seed {seed}, {precision}: {value} for {input:?}");
            true
        }
        Err(_) => false,
    }
}

#[test]
fn every_answer_is_a_fraction() {
    let answered = std::sync::atomic::AtomicU64::new(0);
    in_parallel(INPUTS, |seed| {
        let input = with_generator(seed, |g| g.input());
        let ok = assert_is_a_fraction::<f64>(&input, seed) & assert_is_a_fraction::<f32>(&input, seed);
        answered.fetch_add(u64::from(ok), std::sync::atomic::Ordering::Relaxed);
    });
    // Most inputs are valid: otherwise this test tests nothing.
    assert!(answered.into_inner() > INPUTS / 2);
}

#[test]
fn lights_without_measure_are_dark() {
    in_parallel(INPUTS / 10, |seed| {
        let input = with_generator(seed, |g| g.nothing());
        assert_is_a_fraction::<f64>(&input, seed);
        assert_is_a_fraction::<f32>(&input, seed);
    });
}

/// A lobe and a rectangle, neither extreme.
struct Moderate {
    m: [f64; 9],
    corners: [[f64; 3]; 4],
}

fn moderate(g: &mut Generator<'_>) -> Moderate {
    let mut r = |low: f64, high: f64| low + (high - low) * g.unit();
    let (a, b) = (r(0.02, 1.0), r(0.02, 1.0));
    let m = [a, r(-0.3, 0.3) * b, r(-1.0, 1.0), 0.0, b, r(-1.0, 1.0), r(-0.2, 0.2) * a, 0.0, r(0.3, 1.0)];
    let (c, u, v) = (
        [r(-3.0, 3.0), r(-3.0, 3.0), r(-2.0, 3.0)],
        [r(-1.0, 1.0), r(-1.0, 1.0), r(-1.0, 1.0)],
        [r(-1.0, 1.0), r(-1.0, 1.0), r(-1.0, 1.0)],
    );
    let corner = |s: f64, t: f64| [0, 1, 2].map(|k| c[k] + s * u[k] + t * v[k]);
    Moderate { m, corners: [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)] }
}

fn polygon(vertices: &[[f64; 3]], sides: Sides) -> AnyLight {
    AnyLight::Polygon { vertices: vertices.to_vec(), sides }
}

fn between(a: [f64; 3], b: [f64; 3], t: f64) -> [f64; 3] {
    [0, 1, 2].map(|k| a[k] + t * (b[k] - a[k]))
}

/// Rounding alone separates the two sides of a law.
fn assert_same(left: f64, right: f64, law: &str, seed: u64) {
    assert!((left - right).abs() < 1e-9, "seed {seed}, {law}: {left} {right}");
}

#[test]
fn a_light_cut_in_two_sums_to_the_whole() {
    in_parallel(LAWFUL, |seed| {
        let (Moderate { m, corners: [a, b, c, d] }, t) =
            with_generator(seed, |g| (moderate(g), 0.05 + 0.9 * g.unit()));
        let seen = |light: &AnyLight| fraction::<f64>(&m, light).unwrap();
        let (p, q) = (between(a, b, t), between(d, c, t));
        let quad = |v: &[[f64; 3]]| seen(&polygon(v, Sides::Two));
        assert_same(quad(&[a, b, c, d]), quad(&[a, p, q, d]) + quad(&[p, b, c, q]), "polygon", seed);
        let line = |p0, p1| seen(&AnyLight::Line { p0, p1, radius: 1e-3 });
        assert_same(line(a, b), line(a, p) + line(p, b), "line", seed);
        let normal = [0.3, -0.5, 0.8];
        let strip = |p0, p1| seen(&AnyLight::Strip { p0, p1, width: 1e-3, normal, sides: Sides::Two });
        assert_same(strip(a, b), strip(a, p) + strip(p, b), "strip", seed);
    });
}

#[test]
fn turning_scaling_and_renumbering_change_nothing() {
    in_parallel(LAWFUL, |seed| {
        let (Moderate { m, corners }, turn, scale) =
            with_generator(seed, |g| (moderate(g), 6.3 * g.unit(), 10f64.powf(12.0 * g.unit() - 6.0)));
        let (s, c) = turn.sin_cos();
        let turned = |[x, y, z]: [f64; 3]| [c * x - s * y, s * x + c * y, z];
        let mut turned_m = m;
        for k in 0..3 {
            [turned_m[k], turned_m[3 + k], turned_m[6 + k]] = turned([m[k], m[3 + k], m[6 + k]]);
        }
        for light in lights(&corners, 1.0, &|p| p) {
            let value = fraction::<f64>(&m, &light).unwrap();
            let name = light.name();
            let index = lights(&corners, 1.0, &|p| p).iter().position(|l| *l == light).unwrap();
            let other = &lights(&corners, 1.0, &turned)[index];
            assert_same(value, fraction::<f64>(&turned_m, other).unwrap(), name, seed);
            let scaled = &lights(&corners, scale, &|p| p.map(|x| scale * x))[index];
            assert_same(value, fraction::<f64>(&m, scaled).unwrap(), name, seed);
        }
        let [p, q, r, t] = corners;
        let value = fraction::<f64>(&m, &polygon(&[p, q, r, t], Sides::One)).unwrap();
        assert_same(value, fraction::<f64>(&m, &polygon(&[r, t, p, q], Sides::One)).unwrap(), "order", seed);
        let back = fraction::<f64>(&m, &polygon(&[t, r, q, p], Sides::One)).unwrap();
        assert!(value == 0.0 || back == 0.0, "seed {seed}: both sides of a one-sided light shine");
        let both = fraction::<f64>(&m, &polygon(&[p, q, r, t], Sides::Two)).unwrap();
        assert_same(both, value + back, "sides", seed);
    });
}

/// One light of each shape around a rectangle, each point moved by `place`, each length scaled by `scale`.
fn lights(corners: &[[f64; 3]; 4], scale: f64, place: &dyn Fn([f64; 3]) -> [f64; 3]) -> Vec<AnyLight> {
    let [a, b, c, _] = *corners;
    let (p0, p1, center) = (place(a), place(b), place(between(a, c, 0.5)));
    let difference = |p: [f64; 3], q: [f64; 3]| [0, 1, 2].map(|k| 0.5 * (q[k] - p[k]));
    let (axis_u, axis_v) = (difference(p0, p1), difference(p1, place(c)));
    let (radius, sides) = (0.3 * scale, Sides::Two);
    // A direction, so that its length is not scaled; a place that turns turns it too.
    let normal = place([0.3, -0.5, 0.8]).map(|x| x / scale);
    vec![
        polygon(&corners.map(place), sides),
        AnyLight::Line { p0, p1, radius: 0.01 * scale },
        AnyLight::Strip { p0, p1, width: 0.01 * scale, normal, sides },
        AnyLight::Cylinder { p0, p1, radius, caps: true },
        AnyLight::Cylinder { p0, p1, radius, caps: false },
        AnyLight::Disk { center, normal, radius, sides },
        AnyLight::Ellipse { center, axis_u, axis_v, sides },
        AnyLight::Sphere { center, radius },
    ]
}

/// Light `k` sinks from above the surface to below it, beside the shading point, whose plane it passes through on the way.
struct Sinking {
    m: [f64; 9],
    corners: [[f64; 3]; 4],
    k: usize,
}

impl Sinking {
    fn value<R: Real>(&self, height: f64) -> f64 {
        let corners = self.corners.map(|[x, y, z]| [x + 6.0, y, z + height]);
        fraction::<R>(&self.m, &lights(&corners, 1.0, &|p| p)[self.k]).unwrap()
    }

    /// The largest step between neighbouring heights, and then of its halves, until they are as near as numbers get.
    fn largest_step<R: Real>(&self, halvings: usize) -> f64 {
        let heights: Vec<f64> = (0..=80).map(|i| 4.0 - 0.1 * f64::from(i)).collect();
        let step = |range: &[f64; 2]| (self.value::<R>(range[0]) - self.value::<R>(range[1])).abs();
        let larger = |a: [f64; 2], b: [f64; 2]| if step(&a) >= step(&b) { a } else { b };
        let mut range = heights.windows(2).map(|w| [w[0], w[1]]).reduce(larger).unwrap();
        for _ in 0..halvings {
            let middle = 0.5 * (range[0] + range[1]);
            range = larger([range[0], middle], [middle, range[1]]);
        }
        step(&range)
    }
}

#[test]
fn lights_sink_below_the_horizon_and_pass_the_plane_of_a_point_without_a_step() {
    in_parallel(LAWFUL / 500, |seed| {
        let Moderate { m, corners } = with_generator(seed, moderate);
        for k in 0..8 {
            let sinking = Sinking { m, corners, k };
            let step = sinking.largest_step::<f64>(36);
            assert!(step < 1e-7, "seed {seed}, light {k}: a step of {step:e}");
            let step = sinking.largest_step::<f32>(14);
            assert!(step < 1e-4, "seed {seed}, light {k}, f32: a step of {step:e}");
        }
    });
}

/// The control: the search finds a step that is there.
#[test]
fn a_point_that_passes_through_a_light_does_see_a_step() {
    let corners = [[-7.0, -1.0, 0.0], [-5.0, -1.0, 0.0], [-5.0, 1.0, 0.0], [-7.0, 1.0, 0.0]];
    let m = [0.5, 0.0, 0.0, 0.0, 0.5, 0.0, 0.0, 0.0, 1.0];
    assert!(Sinking { m, corners, k: 0 }.largest_step::<f64>(36) > 0.5);
}

#[test]
fn lights_below_the_horizon_are_dark() {
    in_parallel(LAWFUL, |seed| {
        let Moderate { m, corners } = with_generator(seed, moderate);
        for light in lights(&corners.map(|[x, y, z]| [x, y, z - 6.0]), 1.0, &|p| p) {
            assert_eq!(fraction::<f64>(&m, &light).unwrap(), 0.0, "seed {seed}: {}", light.name());
            assert_eq!(fraction::<f32>(&m, &light).unwrap(), 0.0, "seed {seed}: {}", light.name());
        }
    });
}
