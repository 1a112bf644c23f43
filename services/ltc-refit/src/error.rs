//! Why a refit is not taken on.

use ltc_store::StoreError;

/// Why a refit is not taken on.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RefitError {
    /// A field of the specification makes no sense.
    #[error("{}{reason}", if field.is_empty() { String::new() } else { format!("{field}: ") })]
    Spec {
        /// Which field, as a path with dots; empty for the specification as a whole.
        field: String,
        /// What is wrong with it.
        reason: String,
    },
    /// It would take more memory or time than a refit may here.
    #[error("{reason}")]
    TooLarge {
        /// Entries of the table.
        entries: u64,
        /// Memory that it would take, bytes.
        memory: u64,
        /// Seconds of one core that it would take.
        seconds: f64,
        /// The estimate and the limits, in words.
        reason: String,
    },
    /// The store says no.
    #[error(transparent)]
    Store(#[from] StoreError),
}
