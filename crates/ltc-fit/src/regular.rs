//! det M > 0 between the entries too.

use glam::DMat3;
use ltc_core::points::SplitMix64;
use ltc_table::{
    Axis, Quantity,
    lookup::{Corner, corners},
};
use rayon::prelude::*;

use crate::joint::interpolate;

/// Smallest volume `det M / (|c₀||c₁||c₂|)` that the directions of the columns may span before entries are pushed.
const MIN_VOLUME: f64 = 0.02;
/// How hard they are pushed, against the total variation of one query: the force is this × what the volume lacks.
const STIFFNESS: f64 = 40.0;
/// Random points of the grid in one step.
const POINTS: usize = 8192;

/// Adds to `by_entry` the derivative of `weight · STIFFNESS/2 · Σ max(0, MIN_VOLUME − v)²` over random points of the grid.
///
/// Entries with det M > 0 can interpolate to a matrix without: between lobes that are thin and lie askew. Queries of the
/// draw come by the corners where it happens too seldom to see it.
pub fn push_apart(axes: &[Axis], m: &[DMat3], seed: u64, weight: f64, by_entry: &mut [DMat3]) {
    for corners in find_flat(axes, m, seed) {
        let now = interpolate(m, &corners);
        let push = volume_gradient(now) * (weight * STIFFNESS * (volume(now) - MIN_VOLUME));
        for corner in corners {
            by_entry[corner.index] += push * corner.weight;
        }
    }
}

/// Those of [`POINTS`] random points whose interpolated matrix spans less than [`MIN_VOLUME`].
fn find_flat(axes: &[Axis], m: &[DMat3], seed: u64) -> Vec<Vec<Corner>> {
    const CHUNK: usize = 512;
    let chunks: Vec<Vec<Vec<Corner>>> = (0..POINTS.div_ceil(CHUNK))
        .into_par_iter()
        .map(|chunk| {
            let mut rng = SplitMix64::new(seed ^ (chunk as u64).wrapping_mul(0x9E37_79B9));
            (0..CHUNK)
                .map(|_| random_corners(axes, &mut rng))
                .filter(|corners| volume(interpolate(m, corners)) < MIN_VOLUME)
                .collect()
        })
        .collect();
    chunks.concat()
}

/// A point anywhere in the grid: even in node numbers, or, half of the time, crowded towards α = 0 and λ = 0.
fn random_corners(axes: &[Axis], rng: &mut SplitMix64) -> Vec<Corner> {
    let crowded = rng.unit() < 0.5;
    let mut value = |k: usize| {
        let axis: &Axis = &axes[k];
        let [low, high] = axis.domain.map(|x| axis.mapping.coordinate(x));
        let u = rng.unit();
        let width = matches!(axis.quantity, Quantity::Alpha | Quantity::Lambda);
        axis.mapping.value(low + (high - low) * if crowded && width { u * u * u } else { u })
    };
    if axes.len() == 2 {
        corners(axes, [value(0), value(1)]).collect()
    } else {
        corners(axes, [value(0), value(1), value(2), value(3)]).collect()
    }
}

fn volume(m: DMat3) -> f64 {
    m.determinant() / lengths(m)
}

fn lengths(m: DMat3) -> f64 {
    (m.x_axis.length() * m.y_axis.length() * m.z_axis.length()).max(f64::MIN_POSITIVE)
}

/// The derivative of [`volume`] with the columns' lengths held.
pub fn volume_gradient(m: DMat3) -> DMat3 {
    let cofactors =
        DMat3::from_cols(m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis));
    cofactors * (1.0 / lengths(m))
}
