//! What one evaluation of each shape costs.

use std::hint::black_box;
use std::time::Instant;

use glam::DMat3;
use ltc_core::{AnyLight, InputError, Light, Ltc, Matrix, Quad, Real, Sides, points::SplitMix64};

use super::{Form, Sweep};
use crate::ready::{matrix, ready, vector};

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
        cases.iter().map(|case| Ltc::new(matrix::<R>(&DMat3::from_row_array(case.m)))).collect();
    let lobes = lobes?;
    let lights: Vec<&AnyLight> = cases.iter().map(|case| &case.light).collect();
    let corners: Vec<Vec<R::Vec3>> = lights.iter().map(|light| corners::<R>(light)).collect();
    let mut shapes: Vec<Box<dyn Light<R> + '_>> = Vec::with_capacity(COUNT);
    for (light, corners) in lights.iter().zip(&corners) {
        shapes.push(match corners[..] {
            [a, b, c, d] if form == Form::Quad => Box::new(Quad::new([a, b, c, d], Sides::Two)?),
            _ => ready(light, corners)?,
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

fn corners<R: Real>(light: &AnyLight) -> Vec<R::Vec3> {
    match light {
        AnyLight::Polygon { vertices, .. } => vertices.iter().map(vector::<R>).collect(),
        _ => Vec::new(),
    }
}
