//! The freedom that leaves a lobe as it is, fixed so that matrices can be interpolated (KT et al. 2022, §5).

use glam::DMat3;
use ltc_table::Axis;

use crate::{Lattice, Pattern};

/// `M R_z` with the rotation that brings it nearest to the identity's orientation: it maximises `tr(M R_z)`.
///
/// With `R_z(a) = [[cos a, −sin a], [sin a, cos a]]`, `tr(M R_z(a)) = (m00 + m11) cos a + (m01 − m10) sin a + m22`, so
/// `a = atan2(m01 − m10, m00 + m11)`. Of the paper's flips only those that keep det M > 0 remain, and they are rotations.
pub fn aligned(m: DMat3) -> DMat3 {
    let (m00, m10, m01, m11) = (m.x_axis.x, m.x_axis.y, m.y_axis.x, m.y_axis.y);
    let (sine, cosine) = (m01 - m10, m00 + m11);
    if sine == 0.0 && cosine == 0.0 {
        return m;
    }
    m * DMat3::from_rotation_z(sine.atan2(cosine))
}

/// `M R_z` with the rotation that brings it nearest to `target`: it minimises `‖M R_z − T‖`, i.e. maximises
/// `tr(Tᵀ M R_z)`.
pub fn aligned_to(m: DMat3, target: DMat3) -> DMat3 {
    // tr(Tᵀ M R_z) has the form of tr(N R_z) with N = Tᵀ M.
    let n = target.transpose() * m;
    let (sine, cosine) = (n.y_axis.x - n.x_axis.y, n.x_axis.x + n.y_axis.y);
    if sine == 0.0 && cosine == 0.0 {
        return m;
    }
    m * DMat3::from_rotation_z(sine.atan2(cosine))
}

/// Turns every entry of a table towards its neighbours along all axes, a few times over: what is interpolated between
/// entries is then as little distorted as the gauge allows.
///
/// The alignment of each entry with the identity ([`aligned`], the paper's) is where this starts; it leaves entries of
/// strongly bent lobes turned against their neighbours. Entries whose symmetry fixes their gauge stay.
pub fn smooth(axes: &[Axis], lattice: &Lattice, m: &mut [DMat3]) {
    const SWEEPS: usize = 12;
    let phi_stride: usize = axes.iter().skip(2).map(|a| a.len).product();
    for sweep in 0..SWEEPS {
        for (index, tie) in lattice.ties.iter().enumerate() {
            if tie.owner != index || tie.pattern != Pattern::General {
                continue;
            }
            // First from φ = 0, where the symmetry fixes the gauge, onwards; then each among all of its neighbours.
            let target = if sweep == 0 {
                m[index - phi_stride]
            } else {
                neighbours(axes, index).fold(DMat3::ZERO, |sum, n| sum + m[n])
            };
            m[index] = aligned_to(m[index], target);
        }
        lattice.follow(m);
    }
}

/// The entries one step away along each axis.
pub(crate) fn neighbours(axes: &[Axis], index: usize) -> impl Iterator<Item = usize> {
    let mut stride = 1;
    let mut found = Vec::with_capacity(2 * axes.len());
    for axis in axes.iter().rev() {
        let position = index / stride % axis.len;
        if position > 0 {
            found.push(index - stride);
        }
        if position + 1 < axis.len {
            found.push(index + stride);
        }
        stride *= axis.len;
    }
    found.into_iter()
}

/// Scales every entry by `1/√(dx/du)` of each of its axes, so that interpolation along unevenly spaced nodes bends with them.
///
/// A lobe does not depend on the scale of its matrix, but a mixture of two does: between entries of scales `s₀`, `s₁` it runs
/// as the Möbius transform `(s₀ x₀ (1 − t) + s₁ x₁ t) / (s₀ (1 − t) + s₁ t)` from `x₀` to `x₁`, whose slopes at the two ends are as
/// `s₁² : s₀²`. With the scales above they are as those of the mapping `x(u)`. For lobes much narrower than a step of the
/// table, whose width is proportional to α, this is all that interpolation can
/// do wrong along α.
pub fn scale(axes: &[Axis], lattice: &Lattice, m: &mut [DMat3]) {
    for (m, node) in m.iter_mut().zip(&lattice.nodes) {
        let slopes = axes.iter().map(|axis| axis.mapping.slope(node.value(axis.quantity)));
        *m *= 1.0 / slopes.product::<f64>().sqrt();
    }
}

/// `M` or `M R_z(π)`, whichever has the entry across the plane of symmetry above 0: the symmetry leaves no other choice,
/// and neighbours that chose differently would interpolate to a singular matrix.
pub fn signed(m: DMat3, pattern: Pattern) -> DMat3 {
    let across = match pattern {
        Pattern::General => return m,
        Pattern::MirrorY => m.y_axis.y,
        Pattern::MirrorX | Pattern::Diagonal | Pattern::Round => m.x_axis.x,
    };
    if across < 0.0 { DMat3::from_cols(-m.x_axis, -m.y_axis, m.z_axis) } else { m }
}

/// `M` or `M diag(1, −1, 1)`, whichever has det M > 0: the lobe is the same (2022 paper, eq. 11).
pub fn right_handed(m: DMat3) -> DMat3 {
    if m.determinant() < 0.0 { DMat3::from_cols(m.x_axis, -m.y_axis, m.z_axis) } else { m }
}

/// `M` scaled so that its last column has unit length (2022 paper, §7).
pub fn scaled(m: DMat3) -> DMat3 {
    let length = m.z_axis.length();
    if length > 0.0 { m * (1.0 / length) } else { m }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ltc_core::{Ltc, Matrix, points::r2};
    use ltc_table::{Floors, Mapping, Quantity};

    fn matrices() -> Vec<DMat3> {
        let rows = [
            [0.4, 0.05, -0.6, -0.02, 0.2, -0.2, 0.1, 0.1, 0.7],
            [0.05, 0.01, -0.9, 0.03, 0.5, -0.1, 0.2, 0.0, 0.2],
            [0.9, 0.1, 0.1, -0.1, 0.8, 0.2, 0.0, -0.1, 1.0],
        ];
        rows.iter()
            .flat_map(|r| {
                (0..5).map(|k| DMat3::from_row_array(*r) * DMat3::from_rotation_z(f64::from(k) * 1.3))
            })
            .collect()
    }

    #[test]
    fn alignment_keeps_the_lobe_and_is_unique() {
        for chunk in matrices().chunks(5) {
            let first = aligned(chunk[0]);
            for m in chunk {
                assert!(aligned(*m).abs_diff_eq(first, 1e-12), "the rotation it came with is gone");
                let (a, b) = (Ltc::<f64>::new(*m).unwrap(), Ltc::<f64>::new(aligned(*m)).unwrap());
                for i in 0..20 {
                    let w = a.sample(r2(i, [0.5, 0.5]));
                    assert!((a.density(w) / b.density(w) - 1.0).abs() < 1e-9);
                }
            }
        }
    }

    /// Round lobes as wide as α: between nodes even in √α the interpolated width is α to 0.8 %; with equal scales it is off
    /// by 12 %.
    #[test]
    fn scales_bend_interpolation_along_the_axis() {
        let axes = [Quantity::Theta, Quantity::Alpha].map(|q| Axis::full(q, Mapping::Sqrt, 8));
        let lattice = Lattice::new(&axes, &Floors { alpha: 1e-3, lambda: 0.1, theta_max: 1.5 });
        let mut m: Vec<DMat3> = lattice
            .nodes
            .iter()
            .map(|n| DMat3::from_diagonal(glam::DVec3::new(n.alpha, n.alpha, 1.0)))
            .collect();
        let worst = |m: &[DMat3]| {
            (0..50).fold(0.0_f64, |worst, i| {
                let alpha = (0.2 + 0.8 * f64::from(i) / 49.0_f64).powi(2);
                let mut between = DMat3::ZERO;
                for corner in ltc_table::lookup::corners(&axes, [0.5, alpha]) {
                    between += m[corner.index] * corner.weight;
                }
                worst.max((between.x_axis.x / between.z_axis.z / alpha - 1.0).abs())
            })
        };
        let equal = worst(&m);
        scale(&axes, &lattice, &mut m);
        assert!(equal > 0.1 && worst(&m) < 0.01, "{equal} {}", worst(&m));
    }

    /// Eq. 12 of the paper, its expectation over cosine samples as an average.
    fn misalignment(m: DMat3) -> f64 {
        let ltc = Ltc::<f64>::new(m).unwrap();
        let cosine = Ltc::<f64>::cosine();
        (0..2000)
            .map(|i| r2(i, [0.5, 0.5]))
            .map(|u| (ltc.sample(u) - cosine.sample(u)).length_squared())
            .sum()
    }

    #[test]
    fn the_closed_form_agrees_with_the_papers_search() {
        for m in matrices() {
            let closed = misalignment(aligned(m));
            let searched = (0..720)
                .map(|k| {
                    misalignment(m * DMat3::from_rotation_z(f64::from(k) * core::f64::consts::PI / 360.0))
                })
                .fold(f64::INFINITY, f64::min);
            let worst = (0..72)
                .map(|k| {
                    misalignment(m * DMat3::from_rotation_z(f64::from(k) * core::f64::consts::PI / 36.0))
                })
                .fold(0.0, f64::max);
            let excess = (closed - searched) / (worst - searched);
            assert!(excess < 0.02, "{m}: eq. 12 is {excess} of its range above its minimum");
        }
    }
}
