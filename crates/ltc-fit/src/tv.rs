//! Total variation between a lobe and an LTC, and its gradient.

use glam::{DMat3, DVec3};

use crate::lobe::{LANES, Lobe};

type Lanes = [f64; LANES];

/// `TV(p, q) = ½∫|p − q| = ∫ max(0, p − q)` over the samples of `p`, with `q` the LTC of `M = target_from_cosine`.
pub fn total_variation(lobe: &Lobe, m: DMat3) -> f64 {
    let Some(kernel) = Kernel::new(m) else { return 1.0 };
    let mut sum = [0.0; LANES];
    for i in (0..lobe.len()).step_by(LANES) {
        let s = kernel.sample(lobe, i);
        for (lane, excess) in sum.iter_mut().zip(s.excess) {
            *lane += excess.max(0.0);
        }
    }
    sum.iter().sum()
}

/// The same, and its derivative by every entry of `M`.
pub fn total_variation_gradient(lobe: &Lobe, m: DMat3) -> (f64, DMat3) {
    let Some(kernel) = Kernel::new(m) else { return (1.0, DMat3::ZERO) };
    let mut value = [0.0; LANES];
    let mut covered = [0.0; LANES];
    let mut outer = [[[0.0; LANES]; 3]; 3];
    for i in (0..lobe.len()).step_by(LANES) {
        let s = kernel.sample(lobe, i);
        for k in 0..LANES {
            value[k] += s.excess[k].max(0.0);
            // Only where p > q > 0 does the value change with q.
            let a = if s.excess[k] > 0.0 && s.w[2][k] > 0.0 { s.over_z[k] } else { 0.0 };
            let b = 4.0 * a * s.w[2][k] * s.inverse_square[k];
            covered[k] += a * s.w[2][k];
            let rows = [-b * s.w[0][k], -b * s.w[1][k], a - b * s.w[2][k]];
            let l = [lobe.x[i + k], lobe.y[i + k], lobe.z[i + k]];
            for r in 0..3 {
                for c in 0..3 {
                    outer[r][c][k] += rows[r] * l[c];
                }
            }
        }
    }
    let sum = |lanes: &Lanes| lanes.iter().sum::<f64>();
    let column = |c: usize| DVec3::new(sum(&outer[0][c]), sum(&outer[1][c]), sum(&outer[2][c]));
    let by_inverse = DMat3::from_cols(column(0), column(1), column(2));
    (sum(&value), kernel.gradient_by_m(by_inverse, sum(&covered)))
}

/// What is the same for all samples: `B = M⁻¹`, and `|det B| / π`.
struct Kernel {
    rows: [DVec3; 3],
    inverse: DMat3,
    scale: f64,
}

/// `LANES` samples: `w = B ω`, `1/|w|²`, `inverse · q / w_z`, `weight − inverse · q`.
struct Sample {
    w: [Lanes; 3],
    inverse_square: Lanes,
    over_z: Lanes,
    excess: Lanes,
}

impl Kernel {
    fn new(m: DMat3) -> Option<Self> {
        let determinant = m.determinant();
        let inverse = m.inverse();
        (determinant != 0.0 && inverse.is_finite()).then(|| {
            let transposed = inverse.transpose();
            let rows = [transposed.x_axis, transposed.y_axis, transposed.z_axis];
            Self { rows, inverse, scale: 1.0 / (core::f64::consts::PI * determinant.abs()) }
        })
    }

    /// `q = z₊ |det B| / (π |w|⁴)` (2016 paper, eq. 1).
    #[inline(always)]
    fn sample(&self, lobe: &Lobe, i: usize) -> Sample {
        let range = i..i + LANES;
        let (x, y, z) = (&lobe.x[range.clone()], &lobe.y[range.clone()], &lobe.z[range.clone()]);
        let (weight, inverse) = (&lobe.weight[range.clone()], &lobe.inverse[range]);
        let mut s = Sample {
            w: [[0.0; LANES]; 3],
            inverse_square: [0.0; LANES],
            over_z: [0.0; LANES],
            excess: [0.0; LANES],
        };
        for k in 0..LANES {
            for r in 0..3 {
                s.w[r][k] = self.rows[r].x * x[k] + self.rows[r].y * y[k] + self.rows[r].z * z[k];
            }
            let square = s.w[0][k] * s.w[0][k] + s.w[1][k] * s.w[1][k] + s.w[2][k] * s.w[2][k];
            s.inverse_square[k] = 1.0 / square;
            s.over_z[k] = inverse[k] * self.scale * s.inverse_square[k] * s.inverse_square[k];
            s.excess[k] = weight[k] - s.over_z[k] * s.w[2][k].max(0.0);
        }
        s
    }

    /// From `S = Σ a (e_z − 4 w_z w/|w|²) ωᵀ` and `c = Σ a w_z`, the sums over `p > q` of `∂(inverse·q)/∂B` less its
    /// part from det B: the derivative by `B` is `−(S + c Mᵀ)`, and `dB = −B dM B`.
    fn gradient_by_m(&self, outer: DMat3, covered: f64) -> DMat3 {
        let bt = self.inverse.transpose();
        bt * outer * bt + bt * covered
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Brdf, DiskPoints, GgxFamily};
    use ltc_core::{Alpha, Ltc};

    fn lobe(n: usize) -> Lobe {
        let mut lobe = Lobe::default();
        let alpha = Alpha::new(0.5, 0.2).unwrap();
        GgxFamily.sample_lobe(crate::direction(0.8, 0.6), alpha, &DiskPoints::new(n, [0.5, 0.5]), &mut lobe);
        lobe
    }

    fn matrix() -> DMat3 {
        DMat3::from_cols_array(&[0.4, 0.05, 0.1, -0.02, 0.2, 0.1, -0.6, -0.4, 0.7])
    }

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
    fn gradient_is_the_difference_quotient() {
        let lobe = lobe(2000);
        let (_, gradient) = total_variation_gradient(&lobe, matrix());
        for c in 0..3 {
            for r in 0..3 {
                let h = 1e-6;
                let step = |sign: f64| {
                    let mut m = matrix();
                    m.col_mut(c)[r] += sign * h;
                    total_variation(&lobe, m)
                };
                let quotient = (step(1.0) - step(-1.0)) / (2.0 * h);
                assert!(
                    (quotient - gradient.col(c)[r]).abs() < 1e-4,
                    "{r}{c}: {quotient} {}",
                    gradient.col(c)[r]
                );
            }
        }
    }

    #[test]
    fn a_singular_matrix_covers_nothing() {
        assert_eq!(total_variation(&lobe(64), DMat3::ZERO), 1.0);
    }
}
