//! What can go wrong with a store.

/// Why a store did not do what it was asked.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StoreError {
    /// There is no such thing.
    #[error("there is no {what} \"{name}\"")]
    NotFound {
        /// What kind of thing.
        what: &'static str,
        /// Its name.
        name: String,
    },
    /// Somebody else was first, or the state does not allow it.
    #[error("{reason}")]
    Conflict {
        /// What stands in the way.
        reason: String,
    },
    /// As many as may be are there already.
    #[error("{what} is full: {limit} at most")]
    Full {
        /// Of what.
        what: &'static str,
        /// How many.
        limit: u64,
    },
    /// The device has no room, or may not be written to. Reads go on.
    #[error("the store cannot be written: {reason}")]
    Unwritable {
        /// Why.
        reason: String,
    },
    /// What was read is not what was written.
    #[error("{what} is damaged: {reason}")]
    Damaged {
        /// What.
        what: String,
        /// How it shows.
        reason: String,
    },
    /// The store was made by a newer program.
    #[error("the store has schema {found}; this program knows up to {known}: use a newer one")]
    TooNew {
        /// Its schema.
        found: i64,
        /// The newest one known here.
        known: i64,
    },
    /// Anything else that the machinery below says.
    #[error("the store failed: {0}")]
    Backend(String),
}
