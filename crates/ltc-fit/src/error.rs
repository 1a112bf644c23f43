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
