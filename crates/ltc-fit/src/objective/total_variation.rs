//! Total variation between a lobe and an LTC, and its gradient.

use glam::DMat3;

use super::kernel;
use crate::Lobe;

/// `TV(p, q) = ½∫|p − q| = ∫ max(0, p − q)` over the samples of `p`, with `q` the LTC of `M = target_from_cosine`.
///
/// In [0, 1] up to the error of the samples; 1 for a singular matrix, which covers nothing.
pub fn total_variation(lobe: &Lobe, m: DMat3) -> f64 {
    kernel::sum(lobe, m, |weight, share, _| (weight - share).max(0.0)).unwrap_or(1.0)
}

/// The same, and its derivative by every entry of `M`.
pub fn total_variation_gradient(lobe: &Lobe, m: DMat3) -> (f64, DMat3) {
    // Only where p > q does the value change with q.
    let term = |weight: f64, share: f64, _, scale: f64| {
        let excess = weight - share;
        (excess.max(0.0), if excess > 0.0 { scale } else { 0.0 })
    };
    kernel::sum_with_gradient(lobe, m, term).unwrap_or((1.0, DMat3::ZERO))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::objective::testing::{lobe, matrix};
    use ltc_core::Ltc;

    #[test]
    fn value_is_the_expectation_of_one_minus_the_ratio() {
        let lobe = lobe(1000);
        let ltc = Ltc::<f64>::new(matrix()).unwrap();
        let direct: f64 = (0..lobe.len())
            .filter(|i| lobe.weight[*i] > 0.0)
            .map(|i| {
                let p = lobe.weight[i] / lobe.inverse[i];
                lobe.weight[i] * (1.0 - ltc.density(lobe.direction(i)) / p).max(0.0)
            })
            .sum();
        assert!((total_variation(&lobe, matrix()) - direct).abs() < 1e-12);
        assert!((total_variation_gradient(&lobe, matrix()).0 - direct).abs() < 1e-12);
        assert!(direct > 0.05 && direct < 0.9);
    }

    #[test]
    fn a_singular_matrix_covers_nothing() {
        assert_eq!(total_variation(&lobe(64), DMat3::ZERO), 1.0);
    }
}
