//! What holds for every line and strip: cuts add up, frames and units do not matter, nothing jumps.

use std::f64::consts::TAU;

use glam::{DMat3, DVec3};
use ltc_core::{Horizon, Light, Line, LineCylinder, Sides, Strip};

use crate::draw::{Draw, HORIZONS, ltc};

fn line([p0, p1]: [DVec3; 2], radius: f64) -> Line<f64> {
    Line::new(p0, p1, radius).unwrap()
}

fn capped([p0, p1]: [DVec3; 2], radius: f64) -> LineCylinder<f64> {
    LineCylinder::new(p0, p1, radius).unwrap().with_caps(true)
}

fn strip([p0, p1]: [DVec3; 2], width: f64, normal: DVec3) -> Strip<f64> {
    Strip::new(p0, p1, width, normal, Sides::Two).unwrap()
}

/// A scene, thin enough for most of its values to stay below the clamp.
struct Scene {
    matrix: DMat3,
    ends: [DVec3; 2],
    width: f64,
    normal: DVec3,
}

impl Scene {
    fn draw(draw: &mut Draw) -> Self {
        let condition = draw.log_range(1.0, 100.0);
        let matrix = draw.lobe_matrix(condition);
        let ends = draw.aimed_ends(matrix);
        Self { matrix, ends, width: draw.log_range(1e-4, 0.1), normal: draw.across(ends[1] - ends[0]) }
    }

    /// The values of a line, a capped line and a strip.
    fn values(&self, horizon: Horizon) -> [f64; 3] {
        let lobe = ltc(self.matrix);
        [
            line(self.ends, self.width).integrate_within(&lobe, horizon),
            capped(self.ends, self.width).integrate_within(&lobe, horizon),
            strip(self.ends, self.width, self.normal).integrate_within(&lobe, horizon),
        ]
    }

    fn assert_like(&self, other: &Scene, tolerance: f64) {
        for horizon in HORIZONS {
            for (a, b) in self.values(horizon).into_iter().zip(other.values(horizon)) {
                assert!((a - b).abs() < tolerance, "{horizon:?}: {a} {b}");
            }
        }
    }
}

#[test]
fn a_line_cut_in_two_sums_to_the_whole() {
    let mut draw = Draw::new(31);
    let mut lit = 0;
    for _ in 0..3000 {
        let scene = Scene::draw(&mut draw);
        let [a, b] = scene.ends;
        let cut = a + (b - a) * draw.unit();
        let lobe = ltc(scene.matrix);
        for horizon in [Horizon::BOTH, Horizon::COSINE] {
            let of = |ends| {
                let wall = line(ends, scene.width).integrate_within(&lobe, horizon);
                let flat = strip(ends, scene.width, scene.normal).integrate_within(&lobe, horizon);
                [wall, flat]
            };
            let (whole, first, second) = (of([a, b]), of([a, cut]), of([cut, b]));
            for i in 0..2 {
                if whole[i] < 1.0 {
                    let sum = first[i] + second[i];
                    assert!((whole[i] - sum).abs() < 1e-12, "{whole:?} {first:?} {second:?}");
                    lit += usize::from(first[i] > 1e-4 && second[i] > 1e-4);
                }
            }
        }
    }
    assert!(lit > 1000, "{lit}");
}

#[test]
fn the_order_of_the_ends_does_not_matter() {
    let mut draw = Draw::new(32);
    for _ in 0..3000 {
        let scene = Scene::draw(&mut draw);
        let [a, b] = scene.ends;
        scene.assert_like(&Scene { ends: [b, a], ..scene }, 1e-13);
    }
}

#[test]
fn a_rotation_about_the_normal_of_lobe_and_light_changes_nothing() {
    let mut draw = Draw::new(33);
    for _ in 0..3000 {
        let scene = Scene::draw(&mut draw);
        let turn = DMat3::from_rotation_z(draw.range(0.0, TAU));
        let turned = Scene {
            matrix: turn * scene.matrix,
            ends: scene.ends.map(|p| turn * p),
            normal: turn * scene.normal,
            ..scene
        };
        scene.assert_like(&turned, 1e-10);
    }
}

#[test]
fn units_of_length_do_not_matter() {
    let mut draw = Draw::new(34);
    for case in 0..3000 {
        let scene = Scene::draw(&mut draw);
        let scale = [1e-200, 1e-6, 1e-3, 7.0, 1e6, 1e200][case % 6];
        let scaled = Scene { ends: scene.ends.map(|p| p * scale), width: scene.width * scale, ..scene };
        scene.assert_like(&scaled, 1e-11);
    }
}

#[test]
fn the_base_of_a_lobe_may_be_turned() {
    let mut draw = Draw::new(35);
    for _ in 0..3000 {
        let scene = Scene::draw(&mut draw);
        let turn = DMat3::from_rotation_z(draw.range(0.0, TAU));
        scene.assert_like(&Scene { matrix: scene.matrix * turn, ..scene }, 1e-11);
    }
}

#[test]
fn values_are_proportional_to_the_width_and_the_front_and_back_are_alike() {
    let mut draw = Draw::new(36);
    for _ in 0..3000 {
        let scene = Scene::draw(&mut draw);
        let lobe = ltc(scene.matrix);
        let wide = line(scene.ends, scene.width).integrate(&lobe);
        let thin = line(scene.ends, 0.25 * scene.width).integrate(&lobe);
        assert!(wide == 1.0 || (wide - 4.0 * thin).abs() < 1e-14);
        let [a, b] = scene.ends;
        let one = |normal| Strip::new(a, b, scene.width, normal, Sides::One).unwrap().integrate(&lobe);
        let both = strip(scene.ends, scene.width, scene.normal).integrate(&lobe);
        let (front, back) = (one(scene.normal), one(-scene.normal));
        assert!(front == 0.0 || back == 0.0, "{front} {back}");
        assert_eq!(front.max(back), both);
    }
}

/// As a light that is not parallel to the horizon sinks, its value changes by no more than some constant times the step, and
/// ends at exactly 0.
#[test]
fn a_light_sinks_below_the_horizon_without_a_jump() {
    let mut draw = Draw::new(37);
    let steps = 2000;
    for _ in 0..40 {
        let condition = draw.range(1.0, 5.0);
        let matrix = draw.matrix(condition);
        let mut ends = [draw.direction(), draw.direction()].map(|p| p * draw.range(0.5, 2.0));
        let axis = (ends[1] - ends[0]).normalize_or(DVec3::X);
        if axis.z.abs() < 0.2 || ends[0].cross(ends[1]).length() < 0.3 {
            continue;
        }
        let (radius, normal) = (0.02, draw.across(axis));
        let top = ends.iter().fold(f64::MIN, |m, p| m.max(p.z)) + 2.0 * radius;
        ends = ends.map(|p| p + DVec3::Z * (1.0 - top));
        for horizon in [Horizon::BOTH, Horizon::SURFACE] {
            let mut previous: Option<[f64; 3]> = None;
            for i in 0..=steps {
                // Down to where all of it, its thickness, too, is below.
                let down = DVec3::Z * (f64::from(i) / f64::from(steps));
                let scene = Scene { matrix, ends: ends.map(|p| p - down), width: radius, normal };
                let values = scene.values(horizon);
                let clear = scene.ends[0].cross(scene.ends[1]).length() > 0.1;
                if let Some(previous) = previous.filter(|_| clear) {
                    for (now, before) in values.into_iter().zip(previous) {
                        assert!((now - before).abs() < 0.01, "{horizon:?} at {i}: {before} {now}");
                    }
                }
                previous = clear.then_some(values);
            }
            let below = Scene { matrix, ends: ends.map(|p| p - DVec3::Z), width: radius, normal };
            assert_eq!(below.values(horizon), [0.0; 3]);
        }
    }
}

#[test]
fn clipping_takes_away_what_leaks() {
    let mut draw = Draw::new(38);
    let mut leaked = 0.0f64;
    for _ in 0..3000 {
        let scene = Scene::draw(&mut draw);
        let lobe = ltc(scene.matrix);
        let light = line(scene.ends, scene.width);
        let (both, cosine) = (light.integrate(&lobe), light.integrate_within(&lobe, Horizon::COSINE));
        assert!(both <= cosine + 1e-13);
        leaked = leaked.max(cosine - both);
    }
    assert!(leaked > 0.05, "{leaked}");
}
