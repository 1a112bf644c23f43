//! An anisotropic table with more nodes along λ, in the layout that lets the texture unit interpolate all else at once.

use glam::DMat3;
use ltc_core::Matrix as _;
use ltc_table::{Kind, Precision, Table, ktx2};

/// Steps a cell of λ is taken in at most: an 8⁴ table has 12 where a texture may have 2,048 layers.
const MOST_STEPS: usize = 16;

/// The entries of a table along a finer λ.
pub(crate) struct Refined {
    /// One for each node of the finer λ: all entries of it, θ the slowest and α the fastest.
    pub slices: Vec<Vec<[f64; 12]>>,
    /// Nodes of α, φ and θ.
    pub nodes: [usize; 3],
}

impl Refined {
    /// Of an anisotropic table, rounded, with as many nodes along λ as `layers` of a texture can hold; `None` for an isotropic
    /// one, and where not even the table's own fit.
    pub fn of(table: &Table, precision: Precision, layers: usize) -> Option<Self> {
        let (Kind::Anisotropic, &[thetas, phis, alphas, lambdas]) = (table.kind(), &table.shape()[..]) else {
            return None;
        };
        let cells = lambdas - 1;
        let steps =
            (1..=MOST_STEPS).rev().find(|steps| ktx2::GROUPS * thetas * (cells * steps + 1) <= layers)?;
        let texels = ktx2::texels(table);
        let count = thetas * phis * alphas * lambdas;
        let entry =
            |place: usize| -> [f64; 12] { core::array::from_fn(|k| texels[place + count * (k / 4)][k % 4]) };
        let between = |first: usize, step: usize| {
            let (cell, t) = ((step / steps).min(cells.saturating_sub(1)), step as f64 / steps as f64);
            let (low, high) = (entry(first + cell), entry(first + (cell + 1).min(cells)));
            blend([&low, &high], t - cell as f64, precision)
        };
        let slice = |step: usize| (0..count / lambdas).map(|k| between(k * lambdas, step)).collect();
        let slices = (0..=cells * steps).map(slice).collect();
        Some(Self { slices, nodes: [alphas, phis, thetas] })
    }
}

/// Linear, but for matrices that would lose the sign of their determinant, or nearly so that rounding may take it: the nearer
/// one's then, as in a lookup.
fn blend([a, b]: [&[f64; 12]; 2], t: f64, precision: Precision) -> [f64; 12] {
    let mut between: [f64; 12] = core::array::from_fn(|k| precision.round(a[k] + t * (b[k] - a[k])));
    let [m @ .., _, _, _] = between;
    if DMat3::from_row_array(m).determinant() <= 0.0 {
        let nearer = if t > 0.5 { b } else { a };
        for k in 0..9 {
            between[k] = precision.round(nearer[k]);
        }
    }
    between
}
