//! The table itself, in `f64`.

use glam::DMat3;
use ltc_core::{Ltc, Matrix};

use crate::{Axis, Lobe, Lookup, Quantity, Query, TableError, lookup::Corner};

/// Error statistics of each entry, in table order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CellStats {
    /// Total variation between the entry's lobe and the BRDF's at the entry, in [0, 1].
    pub tv: Vec<f64>,
    /// Mass of the entry's lobe below the surface's horizon, in [0, 1].
    pub leak: Vec<f64>,
    /// Condition number of the entry's matrix (2-norm).
    pub condition: Vec<f64>,
}

/// A table of LTCs: for every node of the axes a matrix, a magnitude and a Fresnel term.
///
/// Entries are in C order of the axes: the last axis varies fastest.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    axes: Vec<Axis>,
    m: Vec<DMat3>,
    magnitude: Vec<f64>,
    fresnel: Vec<f64>,
    cells: CellStats,
}

/// The two kinds of tables there are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// 2D: θ, α.
    Isotropic,
    /// 4D: θ, φ, α, λ.
    Anisotropic,
}

impl Table {
    /// A table of these arrays; `cells` may have empty arrays.
    ///
    /// # Errors
    /// [`TableError`] for axes that are no table's, arrays of another length than the axes ask for, NaN or infinite
    /// entries, and matrices with det ≤ 0.
    pub fn new(
        axes: Vec<Axis>,
        m: Vec<DMat3>,
        magnitude: Vec<f64>,
        fresnel: Vec<f64>,
        cells: CellStats,
    ) -> Result<Self, TableError> {
        kind(&axes)?;
        for axis in &axes {
            axis.validate()?;
        }
        let expected = axes.iter().map(|a| a.len).product();
        let check_length = |array: &str, found: usize, optional: bool| {
            let fits = found == expected || (optional && found == 0);
            if fits {
                Ok(())
            } else {
                Err(TableError::WrongLength { array: array.to_owned(), expected, found })
            }
        };
        check_length("m", m.len(), false)?;
        check_length("magnitude", magnitude.len(), false)?;
        check_length("fresnel", fresnel.len(), false)?;
        check_length("cell_tv", cells.tv.len(), true)?;
        check_length("cell_leak", cells.leak.len(), true)?;
        check_length("cell_condition", cells.condition.len(), true)?;
        check_entries(&m, &magnitude, &fresnel)?;
        Ok(Self { axes, m, magnitude, fresnel, cells })
    }

    /// The axes, slowest first.
    pub fn axes(&self) -> &[Axis] {
        &self.axes
    }

    /// Isotropic or anisotropic.
    pub fn kind(&self) -> Kind {
        if self.axes.len() == 2 { Kind::Isotropic } else { Kind::Anisotropic }
    }

    /// Nodes along each axis.
    pub fn shape(&self) -> Vec<usize> {
        self.axes.iter().map(|a| a.len).collect()
    }

    /// `M` (`target_from_cosine`) of each entry.
    pub fn m(&self) -> &[DMat3] {
        &self.m
    }

    /// `∫ ρ cos` at F = 1 of each entry.
    pub fn magnitude(&self) -> &[f64] {
        &self.magnitude
    }

    /// `∫ (1 − ωo·ωh)^5 ρ cos` of each entry.
    pub fn fresnel(&self) -> &[f64] {
        &self.fresnel
    }

    /// Statistics of each entry; arrays may be empty.
    pub fn cells(&self) -> &CellStats {
        &self.cells
    }

    /// The values of the axes' quantities at entry `index`.
    pub fn nodes_of(&self, index: usize) -> Vec<(Quantity, f64)> {
        let mut rest = index;
        let mut nodes: Vec<_> = self
            .axes
            .iter()
            .rev()
            .map(|axis| {
                let value = axis.node(rest % axis.len);
                rest /= axis.len;
                (axis.quantity, value)
            })
            .collect();
        nodes.reverse();
        nodes
    }

    /// The lobe, magnitude and Fresnel term of a query, N-linearly interpolated in `M` between the nodes around it.
    ///
    /// An isotropic table's entries have φ = 0; its lobe is turned by φ: `M(φ) = R_z(φ) M(0) R_z(−φ)`. det M > 0 always:
    /// where interpolation comes to a matrix without, the nearest entry answers.
    ///
    /// # Errors
    /// [`TableError::Input`] for an invalid query, [`TableError::NotIsotropic`] where an isotropic table is asked for
    /// α_x ≠ α_y.
    pub fn lookup(&self, query: &Query) -> Result<Lookup, TableError> {
        let folded = query.fold()?;
        match self.kind() {
            Kind::Isotropic => {
                if folded.lambda != 1.0 {
                    let (alpha_x, alpha_y) = (query.alpha_x, query.alpha_y);
                    return Err(TableError::NotIsotropic { alpha_x, alpha_y });
                }
                let (m, magnitude, fresnel) = self.interpolate([folded.theta, folded.alpha]);
                let turn = DMat3::from_rotation_z(query.phi);
                Ok(Lookup::single(turn * m * turn.transpose(), magnitude, fresnel))
            }
            Kind::Anisotropic => {
                let (m, magnitude, fresnel) =
                    self.interpolate([folded.theta, folded.phi, folded.alpha, folded.lambda]);
                Ok(Lookup::single(folded.unfold(m), magnitude, fresnel))
            }
        }
    }

    fn interpolate<const N: usize>(&self, values: [f64; N]) -> (DMat3, f64, f64) {
        let mut result = (DMat3::ZERO, 0.0, 0.0);
        let mut nearest = Corner { index: 0, weight: -1.0 };
        let (mut most_magnitude, mut most_fresnel) = (0.0_f64, 0.0_f64);
        for corner in crate::lookup::corners(&self.axes, values) {
            let Corner { index, weight } = corner;
            result.0 += self.m[index] * weight;
            result.1 += self.magnitude[index] * weight;
            result.2 += self.fresnel[index] * weight;
            most_magnitude = most_magnitude.max(self.magnitude[index]);
            most_fresnel = most_fresnel.max(self.fresnel[index]);
            if weight > nearest.weight {
                nearest = corner;
            }
        }
        // The weights sum to 1 but for rounding, which must not make a surface reflect more than it gets.
        result.1 = result.1.min(most_magnitude);
        result.2 = result.2.min(most_fresnel);
        // Entries with det M > 0 may still interpolate to a matrix without, between very thin lobes that lie askew.
        if Ltc::<f64>::new(result.0).is_err() {
            result.0 = self.m[nearest.index];
        }
        result
    }
}

fn kind(axes: &[Axis]) -> Result<Kind, TableError> {
    use Quantity::{Alpha, Lambda, Phi, Theta};
    let quantities: Vec<_> = axes.iter().map(|a| a.quantity).collect();
    match quantities[..] {
        [Theta, Alpha] => Ok(Kind::Isotropic),
        [Theta, Phi, Alpha, Lambda] => Ok(Kind::Anisotropic),
        _ => {
            let names: Vec<_> = quantities.iter().map(|q| q.name()).collect();
            Err(TableError::UnknownAxes { found: names.join(", ") })
        }
    }
}

fn check_entries(m: &[DMat3], magnitude: &[f64], fresnel: &[f64]) -> Result<(), TableError> {
    for (index, matrix) in m.iter().enumerate() {
        Ltc::<f64>::new(*matrix).map_err(|e| TableError::BadEntry {
            array: "m",
            index,
            reason: e.to_string(),
        })?;
    }
    for (array, values) in [("magnitude", magnitude), ("fresnel", fresnel)] {
        if let Some(index) = values.iter().position(|v| !(v.is_finite() && *v >= 0.0)) {
            let reason = format!("{} is not a finite number ≥ 0", values[index]);
            return Err(TableError::BadEntry { array, index, reason });
        }
    }
    Ok(())
}

impl Lookup {
    fn single(m: DMat3, magnitude: f64, fresnel: f64) -> Self {
        Self { lobes: vec![Lobe { weight: 1.0, m: m.to_row_array() }], magnitude, fresnel }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{anisotropic, isotropic};
    use core::f64::consts::{FRAC_PI_2, PI};

    fn query(theta: f64, phi: f64, alpha_x: f64, alpha_y: f64) -> Query {
        Query { theta, phi, alpha_x, alpha_y }
    }

    #[test]
    fn a_node_gives_its_entry_and_a_midpoint_the_mean() {
        let table = anisotropic();
        let at = |theta: f64| table.lookup(&query(theta, 0.0, 1.0, 1.0)).unwrap();
        let (low, high) = (at(0.0), at(FRAC_PI_2 / 2.0));
        let middle = at(FRAC_PI_2 / 4.0);
        assert!((middle.magnitude - 0.5 * (low.magnitude + high.magnitude)).abs() < 1e-14);
        for i in 0..9 {
            let mean = 0.5 * (low.lobes[0].m[i] + high.lobes[0].m[i]);
            assert!((middle.lobes[0].m[i] - mean).abs() < 1e-14);
        }
        let index = table.m().len() - 1;
        let last = table.lookup(&query(FRAC_PI_2, FRAC_PI_2, 1.0, 1.0)).unwrap();
        assert_eq!(DMat3::from_row_array(last.lobes[0].m), table.m()[index]);
    }

    #[test]
    fn mirrored_views_give_mirrored_lobes() {
        let table = anisotropic();
        let m =
            |phi, ax, ay| DMat3::from_row_array(table.lookup(&query(0.7, phi, ax, ay)).unwrap().lobes[0].m);
        let mirror = DMat3::from_diagonal(glam::DVec3::new(-1.0, 1.0, 1.0));
        let flipped = m(PI - 0.4, 0.6, 0.2);
        assert!(flipped.abs_diff_eq(mirror * m(0.4, 0.6, 0.2) * mirror, 1e-14));
        assert!(flipped.determinant() > 0.0);
        let swap = DMat3::from_cols_array(&[0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
        assert!(m(FRAC_PI_2 - 0.4, 0.2, 0.6).abs_diff_eq(swap * m(0.4, 0.6, 0.2) * swap, 1e-14));
    }

    #[test]
    fn an_isotropic_table_turns_its_lobe_and_refuses_anisotropy() {
        let table = isotropic();
        let turned = table.lookup(&query(0.7, 1.1, 0.5, 0.5)).unwrap();
        let plain = table.lookup(&query(0.7, 0.0, 0.5, 0.5)).unwrap();
        let r = DMat3::from_rotation_z(1.1);
        let expected = r * DMat3::from_row_array(plain.lobes[0].m) * r.transpose();
        assert!(DMat3::from_row_array(turned.lobes[0].m).abs_diff_eq(expected, 1e-15));
        let error = table.lookup(&query(0.7, 0.0, 0.5, 0.4)).unwrap_err();
        assert!(matches!(error, TableError::NotIsotropic { .. }));
    }

    #[test]
    fn where_interpolation_turns_space_inside_out_the_nearest_entry_answers() {
        let good = isotropic();
        // Neighbours along α that are each other's half turn about y: half-way, x and z of the lobe are parallel.
        let turn = DMat3::from_diagonal(glam::DVec3::new(-1.0, 1.0, -1.0));
        let m: Vec<DMat3> =
            (0..good.m.len()).map(|i| if i % 2 == 0 { good.m[i] } else { good.m[i] * turn }).collect();
        let table = Table::new(
            good.axes.clone(),
            m,
            good.magnitude.clone(),
            good.fresnel.clone(),
            CellStats::default(),
        );
        let table = table.unwrap();
        let mut fallbacks = 0;
        for i in 0..1000 {
            let alpha = f64::from(i) / 999.0;
            let m = DMat3::from_row_array(table.lookup(&query(0.0, 0.0, alpha, alpha)).unwrap().lobes[0].m);
            assert!(m.determinant() > 0.0, "{alpha}");
            fallbacks += u32::from(table.m.contains(&m));
        }
        assert!(fallbacks > 3, "the case never came up");
    }

    #[test]
    fn broken_entries_are_refused() {
        let good = anisotropic();
        let rebuild = |m: Vec<DMat3>, magnitude: Vec<f64>| {
            Table::new(good.axes.clone(), m, magnitude, good.fresnel.clone(), CellStats::default())
        };
        assert!(rebuild(good.m.clone(), good.magnitude.clone()).is_ok());
        let mut m = good.m.clone();
        m[3] = DMat3::from_diagonal(glam::DVec3::new(1.0, -1.0, 1.0));
        assert!(matches!(rebuild(m, good.magnitude.clone()), Err(TableError::BadEntry { index: 3, .. })));
        let mut magnitude = good.magnitude.clone();
        magnitude[5] = f64::NAN;
        assert!(matches!(rebuild(good.m.clone(), magnitude), Err(TableError::BadEntry { index: 5, .. })));
        assert!(matches!(
            rebuild(good.m[1..].to_vec(), good.magnitude.clone()),
            Err(TableError::WrongLength { .. })
        ));
    }
}
