//! Number formats of exported tables.

use glam::DMat3;
use half::f16;
use serde::{Deserialize, Serialize};

use crate::{Table, TableError};

/// The number format of an exported array.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Precision {
    /// IEEE half: 11 bits, 6·10⁻⁸ … 65504.
    F16,
    /// IEEE single.
    F32,
    /// IEEE double, as fitted.
    F64,
}

impl Precision {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::F16, Self::F32, Self::F64];

    /// The name in URLs and options.
    pub fn name(self) -> &'static str {
        match self {
            Self::F16 => "f16",
            Self::F32 => "f32",
            Self::F64 => "f64",
        }
    }

    /// The precision of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|p| p.name() == name)
    }

    /// Bytes of one number.
    pub fn bytes(self) -> usize {
        match self {
            Self::F16 => 2,
            Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// `value` as it survives a trip through this precision.
    pub fn round(self, value: f64) -> f64 {
        match self {
            Self::F16 => f16::from_f64(value).to_f64(),
            Self::F32 => f64::from(value as f32),
            Self::F64 => value,
        }
    }

    /// The value of little-endian bytes; 0 where there are not as many as [`Precision::bytes`].
    pub fn get(self, bytes: &[u8]) -> f64 {
        match self {
            Self::F16 => bytes.try_into().map_or(0.0, |b| f16::from_le_bytes(b).to_f64()),
            Self::F32 => bytes.try_into().map_or(0.0, |b| f64::from(f32::from_le_bytes(b))),
            Self::F64 => bytes.try_into().map_or(0.0, f64::from_le_bytes),
        }
    }

    /// Appends the little-endian bytes of `value`.
    pub fn put(self, value: f64, out: &mut Vec<u8>) {
        match self {
            Self::F16 => out.extend(f16::from_f64(value).to_le_bytes()),
            Self::F32 => out.extend((value as f32).to_le_bytes()),
            Self::F64 => out.extend(value.to_le_bytes()),
        }
    }
}

impl Table {
    /// The table with every number rounded to `precision`: what a user of the exported file will interpolate.
    ///
    /// # Errors
    /// [`TableError::PrecisionLoss`] for a number that overflows, [`TableError::BadEntry`] for a matrix that rounding
    /// makes singular: neither leaves the workspace unreported.
    pub fn rounded(&self, precision: Precision) -> Result<Self, TableError> {
        let round = |array: &'static str, index: usize, value: f64| {
            let rounded = precision.round(value);
            if rounded.is_finite() {
                Ok(rounded)
            } else {
                Err(TableError::PrecisionLoss { array, index, value, precision: precision.name() })
            }
        };
        let m = self.m().iter().enumerate().map(|(i, m)| {
            let mut entries = m.to_cols_array();
            for entry in &mut entries {
                *entry = round("m", i, *entry)?;
            }
            Ok(DMat3::from_cols_array(&entries))
        });
        let channel = |name: &'static str, values: &[f64]| -> Result<Vec<f64>, TableError> {
            values.iter().enumerate().map(|(i, v)| round(name, i, *v)).collect()
        };
        Self::new(
            self.axes().to_vec(),
            m.collect::<Result<_, TableError>>()?,
            channel("magnitude", self.magnitude())?,
            channel("fresnel", self.fresnel())?,
            self.cells().clone(),
        )?
        .with_closed_form(self.closed_form())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{CellStats, testing::isotropic};

    #[test]
    fn rounding_is_what_the_bytes_say() {
        for precision in Precision::ALL {
            assert_eq!(Precision::from_name(precision.name()), Some(precision));
            let mut bytes = Vec::new();
            precision.put(0.1, &mut bytes);
            assert_eq!(bytes.len(), precision.bytes());
            assert_eq!(precision.get(&bytes), precision.round(0.1));
        }
        assert_eq!(Precision::F32.round(0.1), f64::from(0.1_f32));
        assert!((Precision::F16.round(0.1) - 0.1).abs() < 3e-5);
    }

    #[test]
    fn what_half_floats_cannot_hold_is_an_error() {
        let table = isotropic();
        assert!(table.rounded(Precision::F16).is_ok());
        let scaled = |scale: f64| {
            let mut m = table.m().to_vec();
            m[2] *= scale;
            let (n, f) = (table.magnitude().to_vec(), table.fresnel().to_vec());
            Table::new(table.axes().to_vec(), m, n, f, CellStats::default()).unwrap()
        };
        assert!(matches!(
            scaled(1e6).rounded(Precision::F16),
            Err(TableError::PrecisionLoss { index: 2, .. })
        ));
        assert!(matches!(scaled(1e-9).rounded(Precision::F16), Err(TableError::BadEntry { index: 2, .. })));
    }
}
