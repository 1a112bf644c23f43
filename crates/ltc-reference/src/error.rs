//! What can go wrong in a reference integration.

use std::fmt;

use crate::quadrature::Estimate;

/// Error of the reference integrators. An integrator that cannot keep its promise says so; it never returns NaN.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ReferenceError {
    /// An input is NaN or infinite.
    NonFiniteInput {
        /// Which input.
        what: &'static str,
    },
    /// The integrand was NaN or infinite at a point where it was evaluated.
    NonFiniteIntegrand {
        /// First coordinate of the point in the integrator's own parameters.
        u: f64,
        /// Second coordinate (0 for one-dimensional integrals).
        v: f64,
    },
    /// A GGX width is negative.
    InvalidAlpha {
        /// The rejected width.
        alpha: f64,
    },
    /// A vector that must have length 1 has not.
    NotUnit {
        /// Which vector.
        what: &'static str,
        /// Its length.
        length: f64,
    },
    /// The matrix of a lobe has no inverse.
    SingularMatrix {
        /// Its determinant.
        determinant: f64,
    },
    /// A polygon has fewer than three vertices.
    TooFewVertices {
        /// How many it has.
        count: usize,
    },
    /// Four corners do not form a parallelogram.
    NotAParallelogram {
        /// Length of `c0 + c2 - c1 - c3`, which is zero for a parallelogram.
        gap: f64,
    },
    /// The tolerance was not reached within the allowed number of evaluations.
    NotConverged {
        /// The best estimate so far, with its error.
        best: Estimate,
    },
}

impl fmt::Display for ReferenceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NonFiniteInput { what } => write!(f, "{what} is not finite"),
            Self::NonFiniteIntegrand { u, v } => write!(f, "the integrand is not finite at ({u}, {v})"),
            Self::InvalidAlpha { alpha } => write!(f, "a GGX width must not be negative, got {alpha}"),
            Self::NotUnit { what, length } => write!(f, "{what} must have length 1, got {length}"),
            Self::SingularMatrix { determinant } => {
                write!(f, "the matrix has no inverse (determinant {determinant})")
            }
            Self::TooFewVertices { count } => write!(f, "a polygon needs three vertices, got {count}"),
            Self::NotAParallelogram { gap } => {
                write!(f, "the four corners miss a parallelogram by {gap}")
            }
            Self::NotConverged { best } => write!(
                f,
                "not converged after {} evaluations: {} with an error of {}",
                best.evaluations, best.value, best.error
            ),
        }
    }
}

impl std::error::Error for ReferenceError {}
