//! N-linear interpolation, and what a lookup returns.

use serde::{Deserialize, Serialize};

use crate::Axis;

/// One lobe of a mixture.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Lobe {
    /// Its share; the shares of a lookup's lobes sum to 1.
    pub weight: f64,
    /// `M`, row-major, cosine space → lobe, det > 0.
    pub m: [f64; 9],
}

/// What a table says about a query.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Lookup {
    /// The lobes of the mixture; one for a table of single LTCs.
    pub lobes: Vec<Lobe>,
    /// `∫ ρ cos` at F = 1.
    pub magnitude: f64,
    /// `∫ (1 − ωo·ωh)^5 ρ cos`.
    pub fresnel: f64,
}

/// An entry that takes part in an interpolation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corner {
    /// Its place in the table's arrays.
    pub index: usize,
    /// Its weight; the weights of all corners sum to 1.
    pub weight: f64,
}

/// The `2^N` entries around a point of the axes' domain (clamped to it) and their N-linear weights.
///
/// `values` are the quantities of the axes, in their order. Panics when there are not exactly `N` axes.
pub fn corners<const N: usize>(axes: &[Axis], values: [f64; N]) -> impl Iterator<Item = Corner> + use<N> {
    assert_eq!(axes.len(), N, "one value for each axis");
    let mut located = [(0, 0.0); N];
    let mut strides = [1; N];
    for k in (0..N).rev() {
        located[k] = axes[k].locate(values[k]);
        if k + 1 < N {
            strides[k] = strides[k + 1] * axes[k + 1].len;
        }
    }
    (0..1_usize << N).map(move |bits| {
        let mut corner = Corner { index: 0, weight: 1.0 };
        for k in 0..N {
            let (cell, t) = located[k];
            let upper = bits >> k & 1;
            corner.index += (cell + upper) * strides[k];
            corner.weight *= if upper == 1 { t } else { 1.0 - t };
        }
        corner
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Mapping, Quantity};

    #[test]
    fn weights_sum_to_one_and_reproduce_a_linear_function() {
        let axes = [
            Axis::full(Quantity::Theta, Mapping::Linear, 3),
            Axis::full(Quantity::Phi, Mapping::Linear, 4),
            Axis::full(Quantity::Alpha, Mapping::Linear, 5),
        ];
        let f = |t: f64, p: f64, a: f64| 1.0 + 2.0 * t - 3.0 * p + 0.5 * a;
        let (t, p, a) = (0.31, 1.2, 0.77);
        let (mut sum, mut value) = (0.0, 0.0);
        for Corner { index, weight } in corners(&axes, [t, p, a]) {
            let (i, j, k) = (index / 20, index / 5 % 4, index % 5);
            sum += weight;
            value += weight * f(axes[0].node(i), axes[1].node(j), axes[2].node(k));
        }
        assert!((sum - 1.0).abs() < 1e-14);
        assert!((value - f(t, p, a)).abs() < 1e-14);
    }
}
