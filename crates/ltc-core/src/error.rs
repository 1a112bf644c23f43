//! What can be wrong with an input.

use core::fmt;

/// Why a value was refused at the boundary of the library.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum InputError {
    /// A number is NaN or infinite.
    NotFinite {
        /// What the number is.
        name: &'static str,
    },
    /// A number lies outside its valid range.
    OutOfRange {
        /// What the number is.
        name: &'static str,
        /// Its value.
        value: f64,
        /// Smallest valid value.
        min: f64,
        /// Largest valid value.
        max: f64,
    },
    /// A matrix cannot be inverted, or turns space inside out (determinant not above 0).
    SingularMatrix {
        /// The determinant after scaling the largest entry to 1.
        determinant: f64,
    },
    /// A polygon has fewer than three vertices.
    TooFewVertices {
        /// How many it has.
        count: usize,
    },
    /// There must be at least one of something.
    Empty {
        /// What is empty.
        name: &'static str,
    },
    /// Two directions that must span a plane are parallel, or one is zero.
    Degenerate {
        /// What is degenerate.
        name: &'static str,
    },
}

impl fmt::Display for InputError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NotFinite { name } => write!(f, "{name} is not a finite number"),
            Self::OutOfRange { name, value, min, max } => {
                write!(f, "{name} is {value}, must be in [{min}, {max}]")
            }
            Self::SingularMatrix { determinant } => {
                write!(
                    f,
                    "matrix m must have a determinant above 0, has {determinant:e} (largest entry scaled to 1)"
                )
            }
            Self::TooFewVertices { count } => write!(f, "a polygon needs at least 3 vertices, has {count}"),
            Self::Empty { name } => write!(f, "{name} is empty"),
            Self::Degenerate { name } => write!(f, "{name} is zero or parallel to what it must differ from"),
        }
    }
}

impl core::error::Error for InputError {}

/// `Ok` when `value` is finite and in `[min, max]`.
///
/// # Errors
/// [`InputError::NotFinite`] or [`InputError::OutOfRange`], with `name`.
pub fn check_range(name: &'static str, value: f64, min: f64, max: f64) -> Result<f64, InputError> {
    if !value.is_finite() {
        Err(InputError::NotFinite { name })
    } else if value < min || value > max {
        Err(InputError::OutOfRange { name, value, min, max })
    } else {
        Ok(value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn range_is_closed_and_nan_is_refused() {
        assert_eq!(check_range("x", 1.0, 0.0, 1.0), Ok(1.0));
        assert!(matches!(check_range("x", 1.1, 0.0, 1.0), Err(InputError::OutOfRange { .. })));
        let error = check_range("x", f64::NAN, 0.0, 1.0).unwrap_err();
        assert_eq!(error.to_string(), "x is not a finite number");
    }
}
