//! The median vector: every plane through it halves the distribution (2016 paper, §3.1).

use glam::{DMat3, DVec3};
use ltc_core::points::{SplitMix64, r2};
use ltc_core::{
    Base, ClampedCosine, ClampedCosineSquared, LinearlyTransformed, Polygon, PolygonBase, Sides,
    UniformHemisphere, UniformSphere,
};

use crate::support::{direction, faces, matrix};

/// Half-spheres as boxes: the faces of a vast half box with one face through the origin, less that face.
fn mass_beside<B: PolygonBase<f64>>(distribution: &LinearlyTransformed<f64, B>, plane: DVec3) -> f64 {
    let (x, y) = plane.any_orthonormal_pair();
    let frame = DMat3::from_cols(x, y, plane);
    let half_box = faces(DVec3::ONE).map(|face| face.map(|v| frame * v.with_z(v.z.max(0.0))));
    let lit = |face: &[DVec3; 4]| {
        let polygon = Polygon::new(face, Sides::Two).unwrap();
        distribution.integrate_polygon(&polygon, ltc_core::Horizon::COSINE)
    };
    half_box.iter().map(lit).sum()
}

fn check<B: PolygonBase<f64> + Base<f64>>() {
    let mut random = SplitMix64::new(21);
    let mut off = 0;
    for i in 0..60 {
        let distribution =
            LinearlyTransformed::<f64, B>::new(matrix(&mut random, [2.0, 20.0, 1e3][i % 3])).unwrap();
        let median = distribution.median();
        for _ in 0..5 {
            let Some(plane) = median.cross(direction(&mut random)).try_normalize() else { continue };
            let half = mass_beside(&distribution, plane);
            assert!((half - 0.5).abs() < 1e-9, "{half} beside {plane} of {distribution:?}");
            let samples = 4096;
            let count =
                (0..samples).filter(|i| distribution.sample(r2(*i, [0.5, 0.5])).dot(plane) > 0.0).count();
            assert!((count as f64 / f64::from(samples as u32) - 0.5).abs() < 0.02);
        }
        // Negative control: a plane through another direction does not halve it (a sphere is halved by all).
        let other = median.cross(direction(&mut random)).try_normalize().unwrap();
        off += usize::from(
            (mass_beside(&distribution, (other + 0.3 * median).try_normalize().unwrap()) - 0.5).abs() > 1e-3,
        );
    }
    let sphere = core::any::type_name::<B>().contains("UniformSphere");
    assert_eq!(off > 50, !sphere, "{off}");
}

#[test]
fn of_the_uniform_sphere() {
    check::<UniformSphere>();
}

#[test]
fn of_the_uniform_hemisphere() {
    check::<UniformHemisphere>();
}

#[test]
fn of_the_clamped_cosine() {
    check::<ClampedCosine>();
}

#[test]
fn of_the_clamped_squared_cosine() {
    check::<ClampedCosineSquared>();
}
