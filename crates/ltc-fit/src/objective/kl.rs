//! Kullback and Leibler's divergence of an LTC from a lobe, and its gradient.

use glam::DMat3;

use super::kernel;
use crate::Lobe;

/// The share of the lobe itself that [`kl`] mixes into the LTC, so that the logarithm stays finite.
pub const KL_FLOOR: f64 = 0.01;

/// `KL(p ‖ q) = ∫ p ln(p/q)` in nats, with `q` the LTC of `M = target_from_cosine`: +∞ as soon as `q` is 0 at a sample of `p`.
///
/// An LTC lives on a hemisphere. GGX lives on all of the hemisphere above the surface, so the divergence is finite only if the
/// two are the same: the third row of `M` must be (0, 0, m₂₂). Hardly any LTC that is good otherwise is of this form,
/// which is why fits lower [`kl`] instead.
pub fn kullback_leibler(lobe: &Lobe, m: DMat3) -> f64 {
    let term = |weight: f64, share: f64, _| {
        if weight <= 0.0 {
            0.0
        } else if share > 0.0 {
            weight * (weight / share).ln()
        } else {
            f64::INFINITY
        }
    };
    kernel::sum(lobe, m, term).unwrap_or(f64::INFINITY)
}

/// `KL(p ‖ (1 − ε) q + ε p)` in nats with ε = [`KL_FLOOR`] (the skew divergence of Lee 1999): where `q` covers `p` it
/// is the divergence itself less a few ε, and each share of `p` that `q` leaves bare costs `ln 1/ε` = 4.6 times itself, where the
/// divergence is infinite.
///
/// In [0, ln 1/ε] up to the error of the samples; ln 1/ε for a singular matrix.
pub fn kl(lobe: &Lobe, m: DMat3) -> f64 {
    kernel::sum(lobe, m, |weight, share, _| term(weight, share).0).unwrap_or(-KL_FLOOR.ln())
}

/// The same, and its derivative by every entry of `M`.
pub fn kl_gradient(lobe: &Lobe, m: DMat3) -> (f64, DMat3) {
    kernel::sum_with_gradient(lobe, m, |weight, share, _, scale| {
        let (value, by_share) = term(weight, share);
        (value, -by_share * scale)
    })
    .unwrap_or((-KL_FLOOR.ln(), DMat3::ZERO))
}

fn term(weight: f64, share: f64) -> (f64, f64) {
    if weight <= 0.0 {
        return (0.0, 0.0);
    }
    let mixed = (1.0 - KL_FLOOR) * share + KL_FLOOR * weight;
    (weight * (weight / mixed).ln(), -(1.0 - KL_FLOOR) * weight / mixed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::objective::testing::{lobe, matrix};
    use ltc_core::Matrix as _;

    /// A lobe without leak: its third row is (0, 0, 1).
    fn upright() -> DMat3 {
        DMat3::from_row_array([0.6, 0.1, -0.8, 0.05, 0.4, -0.4, 0.0, 0.0, 1.0])
    }

    #[test]
    fn it_is_finite_on_the_same_hemisphere_only() {
        let lobe = lobe(4096);
        let exact = kullback_leibler(&lobe, upright());
        assert!(exact > 0.01 && exact < 2.0, "{exact}");
        let floored = kl(&lobe, upright());
        // By convexity at most (1 − ε) of it.
        assert!(floored <= (1.0 - KL_FLOOR) * exact && floored > 0.95 * exact, "{floored} {exact}");

        let mut leaking = upright();
        leaking.x_axis.z = 0.2;
        assert_eq!(kullback_leibler(&lobe, leaking), f64::INFINITY);
        assert!(kl(&lobe, leaking) < -KL_FLOOR.ln());
        assert_eq!(kullback_leibler(&lobe, matrix()), f64::INFINITY);
    }

    #[test]
    fn it_is_what_the_definition_says() {
        let (lobe, m) = (lobe(1000), matrix());
        let ltc = ltc_core::Ltc::<f64>::new(m).unwrap();
        let direct: f64 = (0..lobe.len())
            .filter(|i| lobe.weight[*i] > 0.0)
            .map(|i| {
                let p = lobe.weight[i] / lobe.inverse[i];
                let q = (1.0 - KL_FLOOR) * ltc.density(lobe.direction(i)) + KL_FLOOR * p;
                lobe.weight[i] * (p / q).ln()
            })
            .sum();
        assert!((kl(&lobe, m) - direct).abs() < 1e-12);
    }

    #[test]
    fn a_singular_matrix_covers_nothing() {
        assert_eq!(kl(&lobe(64), DMat3::ZERO), -KL_FLOOR.ln());
        assert_eq!(kullback_leibler(&lobe(64), DMat3::ZERO), f64::INFINITY);
    }
}
