//! The table itself, in `f64`.

use glam::DMat3;
use ltc_core::{Ltc, Matrix};

use crate::{Axis, ClosedForm, Folded, Lobe, Lookup, Quantity, Query, TableError, direction, lookup::Corner};

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
/// Entries are in C order of the axes: the last axis varies fastest. Magnitude and Fresnel term are values at the entries, with
/// a [`ClosedForm`] or without: it changes what is interpolated between them, see [`Table::lookup`].
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    axes: Vec<Axis>,
    m: Vec<DMat3>,
    magnitude: Vec<f64>,
    fresnel: Vec<f64>,
    cells: CellStats,
    remainders: Option<Remainders>,
}

/// What a closed form leaves of the channels.
#[derive(Clone, Debug, PartialEq)]
struct Remainders {
    form: ClosedForm,
    /// Magnitude and Fresnel term of each entry less the form's values there.
    values: Vec<[f64; 2]>,
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
        Ok(Self { axes, m, magnitude, fresnel, cells, remainders: None })
    }

    /// The table with another closed form, or none: its entries are the same, lookups between them are not.
    ///
    /// # Errors
    /// [`TableError::NoClosedForm`] for an isotropic table, unless there is to be none.
    pub fn with_closed_form(mut self, form: Option<ClosedForm>) -> Result<Self, TableError> {
        self.remainders = match form {
            None => None,
            Some(form) => {
                let entries = self.magnitude.iter().zip(&self.fresnel);
                let values =
                    entries.zip(form.at_entries(&self.axes)?).map(|((n, f), g)| [n - g[0], f - g[1]]);
                Some(Remainders { form, values: values.collect() })
            }
        };
        Ok(self)
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

    /// The formula that lookups add to what they interpolate, if the table has one.
    pub fn closed_form(&self) -> Option<ClosedForm> {
        self.remainders.as_ref().map(|r| r.form)
    }

    /// Magnitude and Fresnel term of each entry less the closed form's values there: what lookups interpolate. `None` without
    /// a closed form.
    pub fn remainders(&self) -> Option<&[[f64; 2]]> {
        self.remainders.as_ref().map(|r| &r.values[..])
    }

    /// What the closed form leaves of magnitude and Fresnel term at a query, interpolated. `None` without a closed form.
    ///
    /// # Errors
    /// [`TableError::Input`] for an invalid query.
    pub fn lookup_remainders(&self, query: &Query) -> Result<Option<[f64; 2]>, TableError> {
        let folded = query.fold()?;
        Ok(self.remainders.as_ref().map(|r| r.interpolate(&self.axes, &folded, [0.0; 2])))
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
    /// With a [closed form](ClosedForm) `g`, magnitude and Fresnel term are `clamp(g(query) + Σ wᵢ (entryᵢ − g(nodeᵢ)), 0, 1)`. `g` is
    /// taken at the widths asked for, also where they lie outside of the axes.
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
                let values = [folded.theta, folded.phi, folded.alpha, folded.lambda];
                let (m, mut magnitude, mut fresnel) = self.interpolate(values);
                if let Some(remainders) = &self.remainders {
                    [magnitude, fresnel] = remainders.lookup(&self.axes, &folded);
                }
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

impl Remainders {
    /// Magnitude and Fresnel term of a query.
    fn lookup(&self, axes: &[Axis], query: &Folded) -> [f64; 2] {
        let Folded { theta, phi, alpha, lambda, .. } = *query;
        // The form is the same for the folded query, and so for all that fold to it, to the last bit.
        let form = self.form.at(direction(theta, phi), alpha, alpha * lambda);
        self.interpolate(axes, query, form).map(|x| x.clamp(0.0, 1.0))
    }

    /// `sum` and what the form leaves of both.
    fn interpolate(&self, axes: &[Axis], query: &Folded, mut sum: [f64; 2]) -> [f64; 2] {
        let Folded { theta, phi, alpha, lambda, .. } = *query;
        for Corner { index, weight } in crate::lookup::corners(axes, [theta, phi, alpha, lambda]) {
            for (sum, remainder) in sum.iter_mut().zip(self.values[index]) {
                *sum += weight * remainder;
            }
        }
        sum
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

    /// The table with the form, and its lookup of `query` worked out from corners and formula.
    fn by_hand(table: &Table, query: &Query) -> [f64; 2] {
        let Folded { theta, phi, alpha, lambda, .. } = query.fold().unwrap();
        let form = ClosedForm::GgxSmith;
        let mut sum = form.at(direction(query.theta, query.phi), query.alpha_x, query.alpha_y);
        for Corner { index, weight } in crate::lookup::corners(table.axes(), [theta, phi, alpha, lambda]) {
            let [t, p, a, l] = [0, 1, 2, 3].map(|k| table.nodes_of(index)[k].1);
            let at = form.at(direction(t, p), a, a * l);
            sum[0] += weight * (table.magnitude()[index] - at[0]);
            sum[1] += weight * (table.fresnel()[index] - at[1]);
        }
        sum.map(|x| x.clamp(0.0, 1.0))
    }

    #[test]
    fn with_a_closed_form_remainders_are_interpolated() {
        let plain = anisotropic();
        let table = plain.clone().with_closed_form(Some(ClosedForm::GgxSmith)).unwrap();
        let mut random = ltc_core::points::SplitMix64::new(1);
        let mut differ = 0;
        for i in 0..2000 {
            let mut width = || 10.0_f64.powf(-4.0 * random.unit());
            let (alpha_x, alpha_y) = (width(), width());
            let theta = if i % 10 == 0 { FRAC_PI_2 } else { random.range(0.0, FRAC_PI_2) };
            let query = query(theta, random.range(-9.0, 9.0), alpha_x, alpha_y);
            let (found, without) = (table.lookup(&query).unwrap(), plain.lookup(&query).unwrap());
            let [n, f] = by_hand(&table, &query);
            assert!((found.magnitude - n).abs() < 1e-13 && (found.fresnel - f).abs() < 1e-13, "{query:?}");
            assert_eq!(found.lobes, without.lobes);
            let mirrored = Query { phi: -query.phi, ..query };
            let swapped = Query { phi: FRAC_PI_2 - query.phi, alpha_x: alpha_y, alpha_y: alpha_x, ..query };
            for other in [mirrored, swapped] {
                let other = table.lookup(&other).unwrap();
                assert!((other.magnitude - n).abs() < 1e-12 && (other.fresnel - f).abs() < 1e-12);
            }
            differ += u32::from((found.fresnel - without.fresnel).abs() > 1e-3);
        }
        assert!(differ > 500, "the form changes too little to be seen: {differ}");
        let back = table.with_closed_form(None).unwrap();
        assert_eq!(back, plain);
    }

    #[test]
    fn at_entries_a_closed_form_changes_nothing() {
        let plain = anisotropic();
        let table = plain.clone().with_closed_form(Some(ClosedForm::GgxSmith)).unwrap();
        assert_ne!(table, plain);
        for (index, [g_n, g_f]) in
            ClosedForm::GgxSmith.at_entries(plain.axes()).unwrap().into_iter().enumerate()
        {
            assert_eq!(
                table.remainders().unwrap()[index],
                [plain.magnitude[index] - g_n, plain.fresnel[index] - g_f]
            );
            let [theta, phi, alpha, lambda] = [0, 1, 2, 3].map(|k| plain.nodes_of(index)[k].1);
            // The made-up table's first nodes of α and λ are 0, which a query has no names for.
            if alpha > 0.0 && lambda > 0.0 {
                let found = table.lookup(&query(theta, phi, alpha, alpha * lambda)).unwrap();
                assert!((found.magnitude - plain.magnitude[index]).abs() < 1e-9);
                assert!((found.fresnel - plain.fresnel[index]).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn an_isotropic_table_has_no_closed_form() {
        let error = isotropic().with_closed_form(Some(ClosedForm::GgxSmith)).unwrap_err();
        assert!(matches!(error, TableError::NoClosedForm));
        assert_eq!(isotropic().with_closed_form(None).unwrap(), isotropic());
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
