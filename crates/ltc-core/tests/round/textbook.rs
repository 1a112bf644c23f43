//! Closed forms that textbooks give for Lambert's lobe.

use core::f64::consts::PI;

use glam::{DVec3, dvec3};
use ltc_core::{Cylinder, Disk, Light, Sides, Sphere};

use super::support::Random;

fn disk(centre: DVec3, normal: DVec3, radius: f64) -> f64 {
    Disk::<f64>::new(centre, normal, radius, Sides::One).unwrap().irradiance()
}

fn sphere(centre: DVec3, radius: f64) -> f64 {
    Sphere::<f64>::new(centre, radius).unwrap().irradiance()
}

/// Howell's catalogue, B-12: an element and a parallel disk on its axis, r²/(r² + d²).
#[test]
fn disk_overhead() {
    for (r, d) in [(1.0, 1.0), (1e-6, 1.0), (1e6, 1.0), (1.0, 1e-7), (3.0, 0.2)] {
        let exact = r * r / (r * r + d * d);
        let value = disk(dvec3(0.0, 0.0, d), -DVec3::Z, r);
        assert!((value / exact - 1.0).abs() < 1e-14, "{r} {d}: {value} {exact}");
    }
}

/// B-13: a parallel disk of radius r at height h, its centre a to the side.
#[test]
fn disk_parallel_and_aside() {
    for (r, h, a) in
        [(1.0_f64, 1.0_f64, 0.5_f64), (1.0, 0.1, 1.0), (0.3, 2.0, 5.0), (1.0, 1e-3, 0.999), (1e-4, 1.0, 2.0)]
    {
        let (h2, r2) = ((h / a) * (h / a), (r / a) * (r / a));
        let z = 1.0 + h2 + r2;
        // ½ (1 − (Z − 2R²)/√(Z² − 4R²)) without its cancellation.
        let near = (1.0 - r / a).powi(2) + h2;
        let root = (near * (z + 2.0 * r / a)).sqrt();
        let exact = 2.0 * r2 * h2 / (root * (root + 1.0 + h2 - r2));
        let value = disk(dvec3(a, 0.0, h), -DVec3::Z, r);
        assert!((value / exact - 1.0).abs() < 1e-11, "{r} {h} {a}: {value} {exact}");
    }
}

/// B-14: a disk at right angles to the element's plane, its axis at height h ≥ r above the element, at distance d:
/// `(d/2h) ((d² + h² + r²)/√((d² + h² + r²)² − 4 h² r²) − 1)`.
#[test]
fn disk_at_right_angles() {
    for (r, h, d) in [(0.5_f64, 1.0_f64, 1.0_f64), (1.0, 1.0, 0.3), (0.2, 3.0, 0.5), (1.0, 1.0, 10.0)] {
        let z = d * d + h * h + r * r;
        let exact = 0.5 * d / h * (z / (z * z - 4.0 * h * h * r * r).sqrt() - 1.0);
        let value = disk(dvec3(d, 0.0, h), -DVec3::X, r);
        assert!((value - exact).abs() < 1e-14, "{r} {h} {d}: {value} {exact}");
    }
}

/// A disk that faces the element along the horizon, which cuts it in half. In polar coordinates (s, t) around its centre
/// the form factor's integrand is `s sin t · d / (π (d² + s²)²)`, which is elementary.
#[test]
fn half_a_disk_on_the_horizon() {
    for (r, d) in [(1.0_f64, 1.0_f64), (2.0, 0.3), (0.1, 1.0)] {
        // 2d/π ∫ s²/(d² + s²)² ds
        let exact = 2.0 * d / PI * (0.5 * ((r / d).atan() / d - r / (r * r + d * d)));
        let value = disk(dvec3(d, 0.0, 0.0), -DVec3::X, r);
        assert!((value - exact).abs() < 1e-14, "{r} {d}: {value} {exact}");
    }
}

/// Above the horizon (r/d)² cos θ. Cut by it, with h = d/r, x = √(h² − 1), y = −x cot θ, w = √(1 − h² cos² θ):
/// `((cos θ arccos y − x w)/h² + arctan(w/x))/π` (Snyder 1996, "Area Light Sources for Real-Time Graphics").
#[test]
fn sphere_above_and_across_the_horizon() {
    let mut random = Random::new(1);
    let (mut above, mut across) = (0, 0);
    for _ in 0..2000 {
        let towards = random.direction();
        let h = random.decades(1.001, 100.0);
        let (cos, sin) = (towards.z, towards.z.mul_add(-towards.z, 1.0).sqrt());
        let value = sphere(towards * h, 1.0);
        let exact = if h * cos >= 1.0 {
            above += 1;
            cos / (h * h)
        } else if h * cos <= -1.0 {
            0.0
        } else {
            across += 1;
            let x = (h * h - 1.0).sqrt();
            let y = -x * (cos / sin);
            let w = sin * (1.0 - y * y).max(0.0).sqrt();
            ((cos * y.clamp(-1.0, 1.0).acos() - x * w) / (h * h) + (w / x).atan()) / PI
        };
        assert!((value - exact).abs() < 1e-11, "{towards} {h}: {value} {exact}");
    }
    assert!(above > 500 && across > 100, "{above} {across}");
}

/// An infinite cylinder of radius r whose axis is parallel to the element's plane, straight overhead at distance d: its
/// form factor is that of a strip seen between the two tangents, sin of the half-angle: r/d.
#[test]
fn long_cylinder_overhead() {
    for (r, d) in [(0.5, 1.0), (0.1, 3.0), (0.99, 1.0)] {
        for caps in [false, true] {
            let end = |x: f64| dvec3(x, 0.0, d);
            let light = Cylinder::<f64>::new(end(-1e6), end(1e6), r, caps).unwrap();
            assert!((light.irradiance() - r / d).abs() < 1e-9, "{r} {d}: {}", light.irradiance());
        }
    }
}

/// Upright and straight overhead only the lower cap is seen, and it is a disk.
#[test]
fn upright_cylinder_overhead_is_its_cap() {
    let (low, high) = (dvec3(0.2, 0.0, 1.0), dvec3(0.2, 0.0, 3.0));
    let solid = Cylinder::<f64>::new(low, high, 0.5, true).unwrap().irradiance();
    assert!((solid - disk(low, -DVec3::Z, 0.5)).abs() < 1e-15);
    assert_eq!(Cylinder::<f64>::new(low, high, 0.5, false).unwrap().irradiance(), 0.0);
}
