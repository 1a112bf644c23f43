//! The part of a table that a scene needs.

use std::borrow::Cow;

use crate::{CellStats, Quantity, Table, TableError, TableVersion};

/// Ranges of axes: which part of a table to keep. None of them: all of it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Part(pub Vec<(Quantity, [f64; 2])>);

impl Part {
    /// Whether this is the whole table.
    pub fn is_whole(&self) -> bool {
        self.0.is_empty()
    }

    /// The part of `table`: see [`Table::crop`].
    ///
    /// # Errors
    /// Those of [`Table::crop`].
    pub fn of<'a>(&self, table: &'a Table) -> Result<Cow<'a, Table>, TableError> {
        let mut table = Cow::Borrowed(table);
        for (quantity, [low, high]) in &self.0 {
            table = Cow::Owned(table.crop(*quantity, *low, *high)?);
        }
        Ok(table)
    }

    /// The manifest to travel within a file of the part `table` of `version`, as JSON: it has the part's axes and says
    /// under `"part"` which ranges were asked for. Its digest still names the version it is a part of.
    ///
    /// # Errors
    /// [`TableError::Manifest`], which no manifest gives.
    pub fn manifest(&self, version: &TableVersion, table: &Table) -> Result<String, TableError> {
        let mut manifest = serde_json::to_value(version.manifest())?;
        if !self.is_whole() {
            manifest["axes"] = serde_json::to_value(table.axes())?;
            let ranges = self.0.iter().map(|(q, range)| (q.name().to_owned(), (*range).into()));
            manifest["part"] = serde_json::Value::Object(ranges.collect());
        }
        Ok(manifest.to_string())
    }
}

impl Table {
    /// The smallest table whose nodes still surround `[low, high]` of a quantity, its entries unchanged.
    ///
    /// Lookups inside the range give what the whole table gives (to rounding); outside it they go to its ends
    /// (but for its closed form, which is taken at the query).
    ///
    /// # Errors
    /// [`TableError::BadAxis`] when the table has no such axis, or the range is empty, not finite, or outside of it.
    pub fn crop(&self, quantity: Quantity, low: f64, high: f64) -> Result<Self, TableError> {
        let bad = |reason| TableError::BadAxis { quantity: quantity.name(), reason };
        let position = self
            .axes()
            .iter()
            .position(|a| a.quantity == quantity)
            .ok_or_else(|| bad("is not in this table"))?;
        let axis = &self.axes()[position];
        let inside = |x: f64| x >= axis.domain[0] && x <= axis.domain[1];
        if !(low <= high && inside(low) && inside(high)) {
            return Err(bad("cannot be cropped to a range that is empty or outside its domain"));
        }
        let first = axis.locate(low).0;
        let (cell, t) = axis.locate(high);
        let last = if t > 0.0 { cell + 1 } else { cell }.max(first + 1);

        let mut axes = self.axes().to_vec();
        axes[position].domain = [axis.node(first), axis.node(last)];
        axes[position].len = last - first + 1;
        let inner: usize = self.axes()[position + 1..].iter().map(|a| a.len).product();
        let keep = |index: usize| (first..=last).contains(&(index / inner % axis.len));
        Self::new(
            axes,
            kept(self.m(), keep),
            kept(self.magnitude(), keep),
            kept(self.fresnel(), keep),
            CellStats {
                tv: kept(&self.cells().tv, keep),
                leak: kept(&self.cells().leak, keep),
                condition: kept(&self.cells().condition, keep),
            },
        )?
        .with_closed_form(self.closed_form())
    }
}

fn kept<T: Copy>(values: &[T], keep: impl Fn(usize) -> bool) -> Vec<T> {
    values.iter().enumerate().filter(|(i, _)| keep(*i)).map(|(_, v)| *v).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        ClosedForm, Query,
        testing::{anisotropic, isotropic},
    };

    #[test]
    fn a_crop_answers_as_the_whole_does() {
        let whole = anisotropic();
        let part = whole.crop(Quantity::Alpha, 0.4, 0.9).unwrap().crop(Quantity::Theta, 0.0, 0.5).unwrap();
        assert_eq!(part.shape(), [2, 3, 3, 3]);
        let query = Query { theta: 0.3, phi: 2.2, alpha_x: 0.45, alpha_y: 0.85 };
        let (a, b) = (whole.lookup(&query).unwrap(), part.lookup(&query).unwrap());
        assert!((a.magnitude - b.magnitude).abs() < 1e-14);
        for (x, y) in a.lobes[0].m.iter().zip(b.lobes[0].m) {
            assert!((x - y).abs() < 1e-14);
        }
        let curved = isotropic().crop(Quantity::Alpha, 0.3, 0.6).unwrap();
        let query = Query { theta: 0.3, phi: 0.0, alpha_x: 0.5, alpha_y: 0.5 };
        let (a, b) = (isotropic().lookup(&query).unwrap(), curved.lookup(&query).unwrap());
        assert!((a.magnitude - b.magnitude).abs() < 1e-14);
    }

    #[test]
    fn a_crop_keeps_the_closed_form() {
        let whole = anisotropic().with_closed_form(Some(ClosedForm::GgxSmith)).unwrap();
        let part = whole.crop(Quantity::Alpha, 0.4, 0.9).unwrap();
        assert_eq!(part.closed_form(), whole.closed_form());
        let query = Query { theta: 1.3, phi: 2.2, alpha_x: 0.45, alpha_y: 0.85 };
        let (a, b) = (whole.lookup(&query).unwrap(), part.lookup(&query).unwrap());
        assert!((a.magnitude - b.magnitude).abs() < 1e-14 && (a.fresnel - b.fresnel).abs() < 1e-14);
        let plain = part.with_closed_form(None).unwrap().lookup(&query).unwrap();
        assert!((a.magnitude - plain.magnitude).abs() > 1e-3, "the form changes nothing here");
    }

    #[test]
    fn a_part_says_in_its_manifest_which_it_is() {
        let version = crate::testing::version("a", 1, anisotropic());
        let part = Part(vec![(Quantity::Alpha, [0.4, 0.9]), (Quantity::Theta, [0.0, 0.5])]);
        let table = part.of(version.table()).unwrap();
        assert_eq!(table.shape(), [2, 3, 3, 3]);
        let manifest: serde_json::Value =
            serde_json::from_str(&part.manifest(&version, &table).unwrap()).unwrap();
        assert_eq!(manifest["part"], serde_json::json!({ "alpha": [0.4, 0.9], "theta": [0.0, 0.5] }));
        assert_eq!(manifest["axes"][0]["len"], 2);
        assert_eq!(manifest["digest"], version.manifest().digest);
        let whole = Part::default().manifest(&version, version.table()).unwrap();
        assert!(!whole.contains("\"part\""));
    }

    #[test]
    fn impossible_crops_are_refused() {
        let table = isotropic();
        assert!(table.crop(Quantity::Phi, 0.0, 1.0).is_err());
        assert!(table.crop(Quantity::Alpha, 0.6, 0.5).is_err());
        assert!(table.crop(Quantity::Alpha, 0.5, 1.5).is_err());
        assert!(table.crop(Quantity::Alpha, f64::NAN, 1.0).is_err());
        assert_eq!(table.crop(Quantity::Alpha, 1.0, 1.0).unwrap().shape(), [4, 2]);
    }
}
