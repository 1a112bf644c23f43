//! Random pairs of a material and a light.

use core::f64::consts::TAU;

use glam::{DMat3, DVec3};
use ltc_core::points::SplitMix64;
use ltc_core::{Matrix as _, Sides};
use ltc_fit::draw;
use ltc_table::{Kind, Query, Table};

use crate::{Job, shapes};

/// A light of which a lobe sees more counts as lit.
const LIT: f64 = 0.01;

/// `count` queries of the standard draw, each with a quad as [`lit`] has it.
pub fn pairs(table: &Table, count: usize, seed: u64) -> Vec<(Query, Job)> {
    lit(table, &draw::standard(count, seed, table.kind() == Kind::Isotropic), seed)
}

/// Queries of a domain wider than the standard draw's: α down to 0, λ down to `lambda` (1 for an isotropic table), θ up to
/// `theta`, more of them near these ends; any φ, and either width the larger.
pub fn wide(count: usize, lambda: f64, theta: f64, seed: u64) -> Vec<Query> {
    let mut rng = SplitMix64::new(seed);
    let one = |_| {
        let alpha = rng.unit().powi(2);
        let ratio = lambda + (1.0 - lambda) * rng.unit().powi(2);
        let theta = theta * (1.0 - rng.unit().powi(2));
        let (alpha_x, alpha_y) =
            if rng.unit() < 0.5 { (alpha, alpha * ratio) } else { (alpha * ratio, alpha) };
        Query { theta, phi: rng.range(-TAU, 2.0 * TAU), alpha_x, alpha_y }
    };
    (0..count).map(one).collect()
}

/// The lobes of these queries with a quad each, most of them around the mirror direction: 0.1 to 10 away, their half-sides
/// 0.03 to 1.5 of that, tilted anywhere, one in ten seen from behind.
///
/// # Panics
/// When the table refuses a query.
pub fn lit(table: &Table, queries: &[Query], seed: u64) -> Vec<(Query, Job)> {
    let mut rng = SplitMix64::new(seed);
    let pair = |query: &Query| {
        let lookup = match table.lookup(query) {
            Ok(lookup) => lookup,
            Err(error) => panic!("{query:?}: {error}"),
        };
        let m = DMat3::from_row_array(lookup.lobes[0].m);
        (*query, Job::new(m, &quad(query, &mut rng), sides(&mut rng)))
    };
    queries.iter().map(pair).collect()
}

/// The share of fractions that are more than 0.01.
pub fn lit_share(fractions: &[f64]) -> f64 {
    fractions.iter().filter(|v| **v > LIT).count() as f64 / fractions.len() as f64
}

fn sides(rng: &mut SplitMix64) -> Sides {
    if rng.unit() < 0.5 { Sides::One } else { Sides::Two }
}

fn quad(query: &Query, rng: &mut SplitMix64) -> [DVec3; 4] {
    let wo = ltc_fit::direction(query.theta, query.phi);
    let mirror = DVec3::new(-wo.x, -wo.y, wo.z);
    let distance = 0.1 * 100.0_f64.powf(rng.unit());
    let spread = if rng.unit() < 0.8 { 0.4 } else { 2.0 };
    let centre = (mirror + shapes::in_cube(rng) * spread) * distance;
    let size = |rng: &mut SplitMix64| distance * 0.03 * 50.0_f64.powf(rng.unit());
    let (u, v) = shapes::tangents(shapes::in_cube(rng));
    let (u, v) = (u * size(rng), v * size(rng));
    let quad = shapes::parallelogram(centre, u, v);
    let from_front = shapes::faces_origin(&quad) == (rng.unit() < 0.9);
    if from_front { quad } else { shapes::reversed(quad) }
}
