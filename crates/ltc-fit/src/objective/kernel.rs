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
        for (k, lane) in sum.iter_mut().enumerate() {
            let share = s.over_z[k] * s.w[2][k].max(0.0);
            *lane += term(lobe.weight[i + k], share, lobe.inverse[i + k]);
        }
    }
    Some(sum.iter().sum())
}

/// The same with `term` giving its value and its derivative by the share: the sum, and its derivative by every entry of
/// `M`.
pub fn sum_with_gradient(
    lobe: &Lobe,
    m: DMat3,
    term: impl Fn(f64, f64, f64) -> (f64, f64),
) -> Option<(f64, DMat3)> {
    let kernel = Kernel::new(m)?;
    let mut value = [0.0; LANES];
    let mut covered = [0.0; LANES];
    let mut outer = [[[0.0; LANES]; 3]; 3];
    for i in (0..lobe.len()).step_by(LANES) {
        let s = kernel.sample(lobe, i);
        for k in 0..LANES {
            let share = s.over_z[k] * s.w[2][k].max(0.0);
            let (term, by_share) = term(lobe.weight[i + k], share, lobe.inverse[i + k]);
            value[k] += term;
            // Below the LTC's own horizon q stays 0.
            let a = if s.w[2][k] > 0.0 { -by_share * s.over_z[k] } else { 0.0 };
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
    Some((sum(&value), kernel.gradient_by_m(by_inverse, sum(&covered))))
}

/// What is the same for all samples: `B = M⁻¹`, and `|det B| / π`.
struct Kernel {
    rows: [DVec3; 3],
    inverse: DMat3,
    scale: f64,
}

/// `LANES` samples: `w = B ω`, `1/|w|²`, `share / w_z`.
struct Sample {
    w: [Lanes; 3],
    inverse_square: Lanes,
    over_z: Lanes,
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
        let inverse = &lobe.inverse[range];
        let mut s = Sample { w: [[0.0; LANES]; 3], inverse_square: [0.0; LANES], over_z: [0.0; LANES] };
        for k in 0..LANES {
            for r in 0..3 {
                s.w[r][k] = self.rows[r].x * x[k] + self.rows[r].y * y[k] + self.rows[r].z * z[k];
            }
            let square = s.w[0][k] * s.w[0][k] + s.w[1][k] * s.w[1][k] + s.w[2][k] * s.w[2][k];
            s.inverse_square[k] = 1.0 / square;
            s.over_z[k] = inverse[k] * self.scale * s.inverse_square[k] * s.inverse_square[k];
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
