//! What one evaluation of each shape costs.

use std::hint::black_box;
use std::time::Instant;

use glam::DMat3;
use ltc_core::{
    AnyLight, Cylinder, Disk, Ellipse, InputError, Light, Line, Ltc, Matrix, Polygon, Quad, Real, Sides,
    Sphere, Strip, Vector, points::SplitMix64,
};

use super::{Form, Sweep};

const COUNT: usize = 512;
const ROUNDS: usize = 60;

/// Nanoseconds of one integration of `form` over a lobe, shapes and lobes ready made: the best of some rounds over a few
/// hundred moderate cases.
///
/// # Errors
/// None for the cases that it makes.
pub fn nanoseconds<R: Real>(form: Form) -> Result<f64, InputError> {
    let mut rng = SplitMix64::new(9);
    let cases: Vec<_> = (0..COUNT).map(|_| Sweep::Scale.case(1.0, form, &mut rng)).collect();
    let lobes: Result<Vec<Ltc<R>>, InputError> =
        cases.iter().map(|case| Ltc::new(matrix::<R>(DMat3::from_row_array(case.m)))).collect();
    let lobes = lobes?;
    let lights: Vec<&AnyLight> = cases.iter().map(|case| &case.light).collect();
    let corners: Vec<Vec<R::Vec3>> = lights.iter().map(|light| corners::<R>(light)).collect();
    let mut shapes: Vec<Box<dyn Light<R> + '_>> = Vec::with_capacity(COUNT);
    for (light, corners) in lights.iter().zip(&corners) {
        shapes.push(match corners[..] {
            [a, b, c, d] if form == Form::Quad => Box::new(Quad::new([a, b, c, d], Sides::Two)?),
            _ => shape(light, corners)?,
        });
    }
    let mut best = f64::INFINITY;
    for _ in 0..ROUNDS {
        let start = Instant::now();
        for (shape, lobe) in shapes.iter().zip(&lobes) {
            black_box(shape.integrate(black_box(lobe)));
        }
        best = best.min(start.elapsed().as_secs_f64());
    }
    Ok(best * 1e9 / COUNT as f64)
}

fn matrix<R: Real>(m: DMat3) -> R::Mat3 {
    R::Mat3::from_row_array(m.to_row_array().map(R::of))
}

fn vector<R: Real>([x, y, z]: &[f64; 3]) -> R::Vec3 {
    R::Vec3::new(R::of(*x), R::of(*y), R::of(*z))
}

fn corners<R: Real>(light: &AnyLight) -> Vec<R::Vec3> {
    match light {
        AnyLight::Polygon { vertices, .. } => vertices.iter().map(vector::<R>).collect(),
        _ => Vec::new(),
    }
}

fn shape<'a, R: Real>(
    light: &AnyLight,
    corners: &'a [R::Vec3],
) -> Result<Box<dyn Light<R> + 'a>, InputError> {
    let (v, r) = (vector::<R>, |x: &f64| R::of(*x));
    Ok(match light {
        AnyLight::Polygon { sides, .. } => Box::new(Polygon::new(corners, *sides)?),
        AnyLight::Line { p0, p1, radius } => Box::new(Line::new(v(p0), v(p1), r(radius))?),
        AnyLight::Strip { p0, p1, width, normal, sides } => {
            Box::new(Strip::new(v(p0), v(p1), r(width), v(normal), *sides)?)
        }
        AnyLight::Cylinder { p0, p1, radius, caps } => {
            Box::new(Cylinder::new(v(p0), v(p1), r(radius), *caps)?)
        }
        AnyLight::Disk { center, normal, radius, sides } => {
            Box::new(Disk::new(v(center), v(normal), r(radius), *sides)?)
        }
        AnyLight::Ellipse { center, axis_u, axis_v, sides } => {
            Box::new(Ellipse::new(v(center), v(axis_u), v(axis_v), *sides)?)
        }
        AnyLight::Sphere { center, radius } => Box::new(Sphere::new(v(center), r(radius))?),
    })
}
