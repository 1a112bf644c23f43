//! f64 against cubature over the light itself.

use ltc_core::Horizon;

use super::support::{HORIZONS, OracleLobe, Random, Shape, condition, shape};

/// Compares and returns the error; `None` where the oracle gives up.
fn error(shape: &Shape, m: glam::DMat3, horizon: Horizon) -> Option<(f64, f64)> {
    let value = shape.exact(m, horizon);
    assert!((0.0..=1.0).contains(&value), "{value}: {shape:?}");
    let reference = shape.reference(&OracleLobe::new(m, horizon), 1e-10)?;
    Some((reference, (value - reference).abs()))
}

#[test]
fn matches_cubature_within_all_horizons() {
    let mut random = Random::new(5);
    for kind in 0..4 {
        let (mut worst, mut partial, mut given_up) = (0.0_f64, 0, 0);
        let n = 64;
        for i in 0..n {
            let m = random.matrix(100.0);
            let distance = random.decades(0.01, 100.0);
            let light = shape(&mut random, kind, m, distance);
            let Some((value, error)) = error(&light, m, HORIZONS[i % 4]) else {
                given_up += 1;
                continue;
            };
            assert!(error < 1e-9, "{error:e}: {light:?} {:?} {m}", HORIZONS[i % 4]);
            worst = worst.max(error);
            partial += usize::from(value > 1e-6 && value < 1.0 - 1e-6);
        }
        println!("kind {kind}: largest error {worst:.1e}, {partial} of {n} partly lit, {given_up} given up");
        assert!(partial > n / 4 && given_up < n / 10, "kind {kind}: {partial} {given_up}");
    }
}

/// The decades of the sweep: roughness from 1e-4, aspect to 1e5, distance to the light's plane from 1e-7, at 89.99°.
#[test]
fn keeps_its_digits_over_the_decades() {
    let mut random = Random::new(7);
    for kind in [0, 1, 2, 3] {
        let (mut worst, mut given_up) = (0.0_f64, 0);
        let n = 24;
        for i in 0..n {
            let m = random.ggx_like(if i % 2 == 0 { 1e-2 } else { 1e-4 });
            let light = swept(&mut random, kind, i);
            let Some((_, error)) = error(&light, m, Horizon::BOTH) else {
                given_up += 1;
                continue;
            };
            let bound = 1e-9 * (condition(m) / 100.0).max(1.0);
            assert!(error < bound, "{error:e}: {light:?} {m}");
            worst = worst.max(error);
        }
        println!("kind {kind}: largest error {worst:.1e}, {given_up} of {n} given up");
        assert!(given_up < n / 5, "kind {kind}: the oracle gave up {given_up} times");
    }
}

/// A light at one of the sweep's settings, at any scale and mostly in any orientation.
pub fn swept(random: &mut Random, kind: usize, setting: usize) -> Shape {
    let frame = if setting.is_multiple_of(4) { glam::DMat3::IDENTITY } else { random.rotation() };
    let scale = random.decades(1e-6, 1e6);
    let turn = random.range(0.0, core::f64::consts::TAU);
    let (height, offset, aspect) = match setting % 3 {
        // Next to the light.
        0 => (random.decades(1e-7, 1.0), random.range(0.0, 0.9), 1.0),
        // A needle.
        1 => (random.decades(0.1, 1.0), random.decades(0.01, 10.0), random.decades(1e-5, 1.0)),
        // Near or far.
        _ => {
            let distance = random.decades(1e-3, 1e3);
            (distance, distance * random.decades(0.01, 1.0), 1.0)
        }
    };
    let place = |x: f64, y: f64, z: f64| frame * glam::dvec3(x, y, z) * scale;
    let centre = place(offset * turn.cos(), offset * turn.sin(), height);
    match kind {
        0 => Shape::Disk { centre, normal: frame.z_axis, radius: scale },
        1 => Shape::Ellipse { centre, u: place(1.0, 0.0, 0.0), v: place(0.0, aspect, 0.0) },
        2 => Shape::Sphere { centre: place(0.0, 0.0, 1.0 + height), radius: scale },
        _ => {
            let (length, at) = (1.0 / aspect, random.range(-0.2, 1.2));
            let aside = 1.0 + height;
            let end = |z: f64| place(aside * turn.cos(), aside * turn.sin(), z);
            let ends = [end(-at * length), end((1.0 - at) * length)];
            Shape::Cylinder { ends, radius: scale, caps: setting.is_multiple_of(2) }
        }
    }
}

/// Negative controls: what a wrong formula would say is seen at once.
#[test]
fn the_oracle_tells_wrong_integrals_apart() {
    let mut random = Random::new(11);
    let (mut leaks, mut transposed, mut shrunk) = (0, 0, 0);
    for i in 0..40 {
        let m = random.matrix(20.0);
        let light = shape(&mut random, i % 4, m, 1.5);
        let lobe = OracleLobe::new(m, Horizon::BOTH);
        let reference = light.reference(&lobe, 1e-8).unwrap();
        let differs = |value: f64| usize::from((value - reference).abs() > 1e-6);
        leaks += differs(light.exact(m, Horizon::COSINE));
        transposed += differs(light.exact(m.transpose(), Horizon::BOTH));
        let smaller = match light {
            Shape::Disk { centre, normal, radius } => Shape::Disk { centre, normal, radius: radius * 0.999 },
            Shape::Ellipse { centre, u, v } => Shape::Ellipse { centre, u: u * 0.999, v },
            Shape::Sphere { centre, radius } => Shape::Sphere { centre, radius: radius * 0.999 },
            Shape::Cylinder { ends, radius, caps } => Shape::Cylinder { ends, radius: radius * 0.999, caps },
        };
        shrunk += differs(smaller.exact(m, Horizon::BOTH));
    }
    assert!(leaks > 10 && transposed > 20 && shrunk > 10, "{leaks} {transposed} {shrunk}");
}
