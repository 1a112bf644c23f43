//! What of a matrix a reader of the table interpolates.

use glam::DMat3;
use ltc_table::{DropIn, Lookup, Query, Table, TableError, drop_in};

use crate::FitError;

/// What of a matrix a reader of the table interpolates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Layout {
    /// `M` itself, as this workspace's tables are read.
    #[default]
    Matrix,
    /// `M⁻¹` divided by its middle entry: the textures that engines ship, see [`ltc_table::drop_in`].
    DropIn,
}

/// A table as its readers see it.
pub enum Reader<'a> {
    /// Interpolates `M`.
    Matrix(&'a Table),
    /// Interpolates the textures.
    DropIn(Box<DropIn>),
}

impl Layout {
    /// Whether this is the layout of all tables but drop-ins.
    pub fn is_matrix(&self) -> bool {
        *self == Self::Matrix
    }

    /// What is interpolated of an entry.
    pub fn stored(self, m: DMat3) -> DMat3 {
        match self {
            Self::Matrix => m,
            Self::DropIn => drop_in::stored(m).map_or(DMat3::NAN, drop_in::inverse),
        }
    }

    /// The matrix of something interpolated.
    pub fn matrix(self, stored: DMat3) -> DMat3 {
        match self {
            Self::Matrix => stored,
            Self::DropIn => stored.inverse(),
        }
    }

    /// A derivative by [`Layout::matrix`]'s result, turned into one by its argument: `dM = −M dB M`.
    pub fn by_stored(self, m: DMat3, by_m: DMat3) -> DMat3 {
        match self {
            Self::Matrix => by_m,
            Self::DropIn => m.transpose() * by_m * m.transpose() * -1.0,
        }
    }

    /// A derivative by [`Layout::stored`]'s result, turned into one by its argument: for `B = k N` with `N = M⁻¹`, `k = m₁₁`,
    /// `dB = dm₁₁ N − k N dM N`.
    pub fn by_matrix(self, m: DMat3, by_stored: DMat3) -> DMat3 {
        match self {
            Self::Matrix => by_stored,
            Self::DropIn => {
                let n = m.inverse();
                let mut by_m = n.transpose() * by_stored * n.transpose() * -m.y_axis.y;
                by_m.y_axis.y += dot(by_stored, n);
                by_m
            }
        }
    }

    /// The table's reader.
    ///
    /// # Errors
    /// [`FitError::Table`] for a table that is no drop-in.
    pub fn reader(self, table: &Table) -> Result<Reader<'_>, FitError> {
        Ok(match self {
            Self::Matrix => Reader::Matrix(table),
            Self::DropIn => Reader::DropIn(Box::new(DropIn::of(table)?)),
        })
    }
}

impl Reader<'_> {
    /// What the reader gets for a query.
    ///
    /// # Errors
    /// Those of [`Table::lookup`] or [`DropIn::lookup`].
    pub fn lookup(&self, query: &Query) -> Result<Lookup, TableError> {
        match self {
            Self::Matrix(table) => table.lookup(query),
            Self::DropIn(textures) => textures.lookup(query),
        }
    }
}

fn dot(a: DMat3, b: DMat3) -> f64 {
    a.x_axis.dot(b.x_axis) + a.y_axis.dot(b.y_axis) + a.z_axis.dot(b.z_axis)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A function of the interpolation of two entries, differentiated through both layouts.
    #[test]
    fn gradients_are_difference_quotients() {
        let entries = [
            DMat3::from_cols_array(&[0.3, 0.0, 0.1, 0.0, 0.4, 0.0, -0.5, 0.0, 0.8]),
            DMat3::from_cols_array(&[0.2, 0.0, 0.2, 0.0, 0.3, 0.0, -0.6, 0.0, 0.7]),
        ];
        let weights = [0.3, 0.7];
        let by_m = DMat3::from_cols_array(&[0.3, 0.0, -0.2, 0.0, 0.5, 0.0, 0.7, 0.0, 0.4]);
        for layout in [Layout::Matrix, Layout::DropIn] {
            let between =
                |m: &[DMat3; 2]| layout.stored(m[0]) * weights[0] + layout.stored(m[1]) * weights[1];
            let value = |m: &[DMat3; 2]| dot(layout.matrix(between(m)), by_m);
            let by_stored = layout.by_stored(layout.matrix(between(&entries)), by_m);
            for (i, weight) in weights.into_iter().enumerate() {
                let gradient = layout.by_matrix(entries[i], by_stored * weight);
                for (column, row) in [(0, 0), (0, 2), (1, 1), (2, 0), (2, 2)] {
                    let step = |h: f64| {
                        let mut m = entries;
                        m[i].col_mut(column)[row] += h;
                        value(&m)
                    };
                    let quotient = (step(1e-6) - step(-1e-6)) / 2e-6;
                    let found = gradient.col(column)[row];
                    assert!(
                        (quotient - found).abs() < 1e-6,
                        "{layout:?} {i} {column}{row}: {quotient} {found}"
                    );
                }
            }
        }
    }
}
