//! What every objective over densities needs: the LTC's share of each sample, and the way back to `M`.

use glam::{DMat3, DVec3};

use crate::lobe::{LANES, Lobe};

type Lanes = [f64; LANES];

/// Adds up `term(weight, share, inverse)` over the samples of a lobe, `share = inverse · q` what the LTC of
/// `M = target_from_cosine` puts where the lobe puts `weight`. `None` for a singular `M`.
pub fn sum(lobe: &Lobe, m: DMat3, term: impl Fn(f64, f64, f64) -> f64) -> Option<f64> {
    let kernel = Kernel::new(m)?;
    let mut sum = [0.0; LANES];
    for i in (0..lobe.len()).step_by(LANES) {
        let s = kernel.sample(lobe, i);
        sum = core::array::from_fn(|k| sum[k] + term(s.weight[k], s.share[k], s.inverse[k]));
    }
    Some(sum.iter().sum())
}

/// The same with `term(weight, share, inverse, scale)` giving its value and minus its derivative by the share, times `scale`:
/// the sum, and its derivative by every entry of `M`.
pub fn sum_with_gradient(
    lobe: &Lobe,
    m: DMat3,
    term: impl Fn(f64, f64, f64, f64) -> (f64, f64),
) -> Option<(f64, DMat3)> {
    let kernel = Kernel::new(m)?;
    let mut value = [0.0; LANES];
    let mut covered = [0.0; LANES];
    let mut outer = [[[0.0; LANES]; 3]; 3];
    for i in (0..lobe.len()).step_by(LANES) {
        let s = kernel.sample(lobe, i);
        for k in 0..LANES {
            let (term, gain) = term(s.weight[k], s.share[k], s.inverse[k], s.over_z[k]);
            value[k] += term;
            // Below the LTC's own horizon q stays 0.
            let a = if s.w[2][k] > 0.0 { gain } else { 0.0 };
            let b = 4.0 * a * s.w[2][k] * s.inverse_square[k];
            covered[k] += a * s.w[2][k];
            let rows = [-b * s.w[0][k], -b * s.w[1][k], a - b * s.w[2][k]];
            for r in 0..3 {
                #[expect(clippy::needless_range_loop, reason = "an outer product reads best by its indices")]
                for c in 0..3 {
                    outer[r][c][k] += rows[r] * s.l[c][k];
                }
            }
        }
    }
    let sum = |lanes: &Lanes| lanes.iter().sum::<f64>();
    let column = |c: usize| DVec3::new(sum(&outer[0][c]), sum(&outer[1][c]), sum(&outer[2][c]));
    let by_inverse = DMat3::from_cols(column(0), column(1), column(2));
    Some((sum(&value), kernel.gradient_by_m(by_inverse, sum(&covered))))
}

/// What is the same for all samples: `B = M⁻¹`, and `|det B| / π`.
struct Kernel {
    rows: [DVec3; 3],
    inverse: DMat3,
    scale: f64,
}

/// `LANES` samples: `ω`, its weight and `1/(N pdf)`, `w = B ω`, `1/|w|²`, `inverse · q / w_z`, `inverse · q`.
struct Sample {
    l: [Lanes; 3],
    weight: Lanes,
    inverse: Lanes,
    w: [Lanes; 3],
    inverse_square: Lanes,
    over_z: Lanes,
    share: Lanes,
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
        let lanes = |array: &[f64]| -> Lanes {
            let array = &array[i..i + LANES];
            core::array::from_fn(|k| array[k])
        };
        let l = [lanes(&lobe.x), lanes(&lobe.y), lanes(&lobe.z)];
        let (weight, inverse) = (lanes(&lobe.weight), lanes(&lobe.inverse));
        let zero = [0.0; LANES];
        let mut s =
            Sample { l, weight, inverse, w: [zero; 3], inverse_square: zero, over_z: zero, share: zero };
        for k in 0..LANES {
            for r in 0..3 {
                s.w[r][k] = self.rows[r].x * l[0][k] + self.rows[r].y * l[1][k] + self.rows[r].z * l[2][k];
            }
            let square = s.w[0][k] * s.w[0][k] + s.w[1][k] * s.w[1][k] + s.w[2][k] * s.w[2][k];
            s.inverse_square[k] = 1.0 / square;
            s.over_z[k] = inverse[k] * self.scale * s.inverse_square[k] * s.inverse_square[k];
            s.share[k] = s.over_z[k] * s.w[2][k].max(0.0);
        }
        s
    }

    /// From `S = −Σ ∂/∂share · over_z (e_z − 4 w_z w/|w|²) ωᵀ` and `c = −Σ ∂/∂share · share`: the derivative by `B` is
    /// `−(S + c Mᵀ)`, and `dB = −B dM B`.
    fn gradient_by_m(&self, outer: DMat3, covered: f64) -> DMat3 {
        let bt = self.inverse.transpose();
        bt * outer * bt + bt * covered
    }
}
