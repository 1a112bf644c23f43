//! Why a fit was refused or did not end well.

use ltc_core::InputError;
use ltc_table::TableError;

/// Why there is no table.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FitError {
    /// A field of the specification makes no sense.
    #[error("{field}: {reason}")]
    Spec {
        /// Which field.
        field: &'static str,
        /// What is wrong with it.
        reason: String,
    },
    /// There is no such preset.
    #[error("no preset named \"{name}\"; there are: {known}")]
    NoSuchPreset {
        /// The name asked for.
        name: String,
        /// The names there are.
        known: String,
    },
    /// The BRDF gave something that is no BRDF.
    #[error("BRDF \"{name}\": {what} is {value}, at theta {theta}, alpha {alpha_x}, {alpha_y}")]
    Brdf {
        /// Its name.
        name: &'static str,
        /// What was asked of it.
        what: &'static str,
        /// What it said.
        value: f64,
        /// Polar angle of the view, radians.
        theta: f64,
        /// Width along the tangent.
        alpha_x: f64,
        /// Width along the bitangent.
        alpha_y: f64,
    },
    /// The observer asked the fit to stop.
    #[error("stopped before the table was complete; nothing was written")]
    Stopped,
    /// A number is out of range.
    #[error(transparent)]
    Input(#[from] InputError),
    /// The result is no valid table.
    #[error(transparent)]
    Table(#[from] TableError),
}
