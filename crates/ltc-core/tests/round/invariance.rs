//! What must not change a value, and what must change it continuously.

use glam::{DMat3, DVec3, dvec3};
use ltc_core::{Disk, Ellipse, Horizon, Light, Ltc, Polygon, Sides};

use super::support::{HORIZONS, Random, Shape, shape};

impl Shape {
    /// Each vector moved by a similarity of this scale.
    fn moved(&self, rotation: DMat3, scale: f64) -> Self {
        let m = rotation * scale;
        match *self {
            Self::Disk { centre, normal, radius } => {
                Self::Disk { centre: m * centre, normal: rotation * normal, radius: radius * scale }
            }
            Self::Ellipse { centre, u, v } => Self::Ellipse { centre: m * centre, u: m * u, v: m * v },
            Self::Sphere { centre, radius } => Self::Sphere { centre: m * centre, radius: radius * scale },
            Self::Cylinder { ends, radius, caps } => {
                Self::Cylinder { ends: ends.map(|p| m * p), radius: radius * scale, caps }
            }
        }
    }

    fn shifted(&self, by: DVec3) -> Self {
        match *self {
            Self::Disk { centre, normal, radius } => Self::Disk { centre: centre + by, normal, radius },
            Self::Ellipse { centre, u, v } => Self::Ellipse { centre: centre + by, u, v },
            Self::Sphere { centre, radius } => Self::Sphere { centre: centre + by, radius },
            Self::Cylinder { ends, radius, caps } => {
                Self::Cylinder { ends: ends.map(|p| p + by), radius, caps }
            }
        }
    }
}

#[test]
fn turning_the_scene_about_the_normal_changes_nothing() {
    let mut random = Random::new(2);
    for i in 0..4000 {
        let m = random.matrix(100.0);
        let distance = random.decades(0.1, 10.0);
        let light = shape(&mut random, i % 4, m, distance);
        let turn = DMat3::from_rotation_z(random.range(0.0, 6.0));
        let horizon = HORIZONS[i / 4 % 4];
        let (before, after) = (light.exact(m, horizon), light.moved(turn, 1.0).exact(turn * m, horizon));
        assert!((before - after).abs() < 1e-11, "{before} {after}: {light:?}");
        // Negative control: a turn of the light alone is seen.
        let crooked = light.moved(DMat3::from_rotation_x(0.5), 1.0).exact(m, Horizon::BOTH);
        assert!(i != 1 || (crooked - before).abs() > 1e-6);
    }
}

#[test]
fn scaling_the_scene_changes_nothing() {
    let mut random = Random::new(3);
    for i in 0..2000 {
        let m = random.matrix(100.0);
        let distance = random.decades(0.1, 10.0);
        let light = shape(&mut random, i % 4, m, distance);
        let expected = light.exact(m, Horizon::BOTH);
        for scale in [1e-100, 1e-6, 1e6, 1e100] {
            let scaled = light.moved(DMat3::IDENTITY, scale).exact(m, Horizon::BOTH);
            assert!((scaled - expected).abs() < 1e-10, "{scale}: {scaled} {expected} {light:?}");
        }
        let single = light.single(m, Horizon::BOTH);
        for scale in [1e-30, 1e-6, 1e6, 1e30] {
            let scaled = light.moved(DMat3::IDENTITY, scale).single(m, Horizon::BOTH);
            assert!((scaled - single).abs() < 2e-4, "{scale}: {scaled} {single} {light:?}");
        }
    }
}

#[test]
fn sides_and_axes() {
    let mut random = Random::new(5);
    for _ in 0..2000 {
        let ltc = Ltc::<f64>::new(random.matrix(30.0)).unwrap();
        let (centre, u, v) = (random.direction() * 2.0, random.direction(), random.direction());
        let ellipse =
            |u: DVec3, v: DVec3, sides| Ellipse::<f64>::new(centre, u, v, sides).unwrap().integrate(&ltc);
        let both = ellipse(u, v, Sides::Two);
        let (front, back) = (ellipse(u, v, Sides::One), ellipse(v, u, Sides::One));
        assert!(front == 0.0 || back == 0.0, "{front} {back}");
        assert!((front + back - both).abs() < 1e-13, "{front} {back} {both}");
        // Any two conjugate half-axes are the same ellipse.
        let (sin, cos) = random.range(0.0, 6.0).sin_cos();
        let turned = ellipse(u * cos + v * sin, v * cos - u * sin, Sides::One);
        assert!((turned - front).abs() < 1e-11, "{turned} {front}");
        // The disk's normal decides its side.
        let normal = u.cross(v);
        let disk = |n: DVec3| Disk::<f64>::new(centre, n, 0.7, Sides::One).unwrap().integrate(&ltc);
        assert!(if normal.dot(centre) < 0.0 { disk(-normal) == 0.0 } else { disk(normal) == 0.0 });
    }
}

#[test]
fn an_ellipse_of_equal_axes_is_a_disk_and_both_are_limits_of_polygons() {
    let mut random = Random::new(7);
    for _ in 0..200 {
        let m = random.matrix(30.0);
        let ltc = Ltc::<f64>::new(m).unwrap();
        let frame = random.rotation();
        let (centre, radius) = (random.direction() * random.decades(0.3, 5.0), 0.8);
        let (u, v) = (frame.x_axis * radius, frame.y_axis * radius);
        let disk = Disk::<f64>::new(centre, frame.z_axis, radius, Sides::Two).unwrap();
        let ellipse = Ellipse::<f64>::new(centre, u, v, Sides::Two).unwrap();
        let squashed = Ellipse::<f64>::new(centre, u, v * 0.3, Sides::Two).unwrap();
        for horizon in HORIZONS {
            let (a, b) = (disk.integrate_within(&ltc, horizon), ellipse.integrate_within(&ltc, horizon));
            assert!((a - b).abs() < 1e-12, "{a} {b}");
        }
        // 256 corners on a circle of the same area.
        let n = 256;
        let step = core::f64::consts::TAU / f64::from(n);
        let fit = (step / step.sin()).sqrt();
        let gon = |squash: f64| -> Vec<DVec3> {
            let corner = |i| (f64::from(i) * step).sin_cos();
            (0..n).map(corner).map(|(s, c)| centre + (u * c + v * (s * squash)) * fit).collect()
        };
        for (light, corners) in [(&ellipse, gon(1.0)), (&squashed, gon(0.3))] {
            let (a, b) = (light.integrate(&ltc), Polygon::new(&corners, Sides::Two).unwrap().integrate(&ltc));
            assert!((a - b).abs() < 2e-4, "{a} {b}");
        }
    }
}

#[test]
fn sinking_below_the_horizon_is_continuous() {
    let mut random = Random::new(9);
    let mut partial = 0;
    for i in 0..200 {
        let m = random.matrix(3.0);
        // Beside the shading point, of size 0.3 at distance 1: it never comes near it.
        let turn = DMat3::from_rotation_z(random.range(0.0, 6.0));
        let start = turn * dvec3(1.0, 0.0, 0.8);
        let (u, v) = (random.direction() * 0.3, random.direction() * 0.3);
        let light = match i % 4 {
            0 => Shape::Disk { centre: start, normal: u, radius: 0.3 },
            1 => Shape::Ellipse { centre: start, u, v },
            2 => Shape::Sphere { centre: start, radius: 0.3 },
            _ => Shape::Cylinder { ends: [start - u, start + u], radius: 0.15, caps: i % 8 < 4 },
        };
        let at = |height: f64| light.shifted(dvec3(0.0, 0.0, height)).exact(m, Horizon::BOTH);
        let mut previous = at(0.0);
        for step in 1..400 {
            let value = at(-0.004 * f64::from(step));
            // A step is an angle of 0.004 or so for an outline of length 2 or so, at a density below 3³/π.
            assert!((value - previous).abs() < 0.05, "{previous} {value} at step {step}: {light:?} {m}");
            partial += usize::from(value > 0.0 && value < previous);
            previous = value;
        }
        assert_eq!(at(-1.5), 0.0);
    }
    assert!(partial > 5000, "{partial}");
}

/// Small steps, small changes: at the very crossing of the horizon and of the light's plane outside of the light.
#[test]
fn small_steps_make_small_changes() {
    let mut random = Random::new(13);
    for i in 0..4000 {
        let m = random.matrix(10.0);
        let frame = random.rotation();
        // A flat light whose plane the shading point crosses two radii from its centre.
        let offset = frame.x_axis * 2.0;
        let at = |height: f64| {
            let centre = offset + frame.z_axis * height;
            if i % 2 == 0 {
                Shape::Disk { centre, normal: frame.z_axis, radius: 1.0 }
            } else {
                Shape::Ellipse { centre, u: frame.x_axis, v: frame.y_axis * 0.3 }
            }
        };
        for height in [1e-2, 1e-4, 1e-6, 1e-8] {
            let (above, below) = (at(height), at(-height));
            let values = [above, below].map(|light| light.exact(m, Horizon::BOTH));
            // The light spans an angle of height/distance² and some; the lobe's density is below cond³.
            assert!(values.iter().all(|v| *v < 1e3 * height), "{height}: {values:?}");
        }
        assert_eq!(at(0.0).exact(m, Horizon::BOTH), 0.0);
        // A light cut by the horizon that moves by 1e-9.
        let distance = random.decades(1.5, 10.0);
        let light = shape(&mut random, i % 3, m, distance);
        let step = random.direction() * 1e-9;
        let (a, b) = (light.exact(m, Horizon::BOTH), light.shifted(step).exact(m, Horizon::BOTH));
        assert!((a - b).abs() < 1e-6, "{a} {b}: {light:?}");
    }
}
