//! What can go wrong.

use std::path::PathBuf;

use ltc_table::TableError;

/// Why there is no answer.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ClientError {
    /// The service cannot be reached, or the connection broke.
    #[error("{url}: {cause}")]
    Network {
        /// What was asked for.
        url: String,
        /// Why it did not come.
        cause: Box<ureq::Error>,
    },
    /// The service refused.
    #[error("{url}: {status}: {detail}")]
    Refused {
        /// What was asked for.
        url: String,
        /// HTTP status.
        status: u16,
        /// Type of the problem, `urn:ltc:problem:…`; empty where something else than the service answered.
        kind: String,
        /// Why, in words.
        detail: String,
    },
    /// What came is not what it says it is.
    #[error("{url}: {reason}")]
    NotGenuine {
        /// What was asked for.
        url: String,
        /// How it shows.
        reason: String,
    },
    /// An answer that cannot be read.
    #[error("{url}: the answer cannot be read: {cause}")]
    Unreadable {
        /// What was asked for.
        url: String,
        /// Why.
        cause: serde_json::Error,
    },
    /// A name or version that could not stand in a path.
    #[error("{0:?} is no name, number, digest or alias")]
    BadName(String),
    /// The authorities to believe cannot be read.
    #[error("the certificates of authorities: {reason}")]
    NoAuthority {
        /// Why.
        reason: String,
    },
    /// A table cannot be read.
    #[error(transparent)]
    Table(#[from] TableError),
    /// The cache cannot be used.
    #[error("{}: {cause}", path.display())]
    Cache {
        /// Which file.
        path: PathBuf,
        /// Why.
        cause: std::io::Error,
    },
}
