//! What can be wrong with a table or with a question to it.

use ltc_core::InputError;

/// Why a table was refused, or a lookup.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TableError {
    /// A number of the query is not valid.
    #[error(transparent)]
    Input(#[from] InputError),
    /// An isotropic table was asked for an anisotropic lobe.
    #[error(
        "the table is isotropic and has no lobe for alpha_x = {alpha_x}, alpha_y = {alpha_y}: they must be equal"
    )]
    NotIsotropic {
        /// Width along the tangent.
        alpha_x: f64,
        /// Width along the bitangent.
        alpha_y: f64,
    },
    /// An axis makes no sense.
    #[error("axis {quantity} {reason}")]
    BadAxis {
        /// Which axis.
        quantity: &'static str,
        /// What is wrong with it.
        reason: &'static str,
    },
    /// The axes are not those of a 2D (θ, α) or 4D (θ, φ, α, λ) table in this order.
    #[error("axes must be theta, alpha or theta, phi, alpha, lambda in this order; found {found}")]
    UnknownAxes {
        /// The quantities found.
        found: String,
    },
    /// An array has the wrong number of entries.
    #[error("array {array} has {found} entries, the axes ask for {expected}")]
    WrongLength {
        /// Which array.
        array: String,
        /// Entries asked for.
        expected: usize,
        /// Entries found.
        found: usize,
    },
    /// An entry is NaN, infinite, or a matrix with det ≤ 0.
    #[error("array {array}, entry {index}: {reason}")]
    BadEntry {
        /// Which array.
        array: &'static str,
        /// Which entry of it.
        index: usize,
        /// What is wrong with it.
        reason: String,
    },
    /// The payload's SHA-256 is not the one in the manifest.
    #[error("the payload's digest is {found}, the manifest says {expected}")]
    DigestMismatch {
        /// By the manifest.
        expected: String,
        /// Of the payload.
        found: String,
    },
    /// The manifest is not readable.
    #[error("manifest: {0}")]
    Manifest(#[from] serde_json::Error),
    /// The manifest and the payload contradict each other.
    #[error("manifest and payload disagree: {what}")]
    Disagreement {
        /// About what.
        what: String,
    },
    /// A payload's closed form is not one of [`ClosedForm`](crate::ClosedForm).
    #[error(
        "closed_form: {code} is no form known here; there is: 1 (ggx-smith). A newer version of this program may know it"
    )]
    UnknownClosedForm {
        /// The number in the payload.
        code: f64,
    },
    /// Only anisotropic tables have a closed form.
    #[error(
        "closed_form: the table is isotropic, only anisotropic ones (theta, phi, alpha, lambda) have one"
    )]
    NoClosedForm,
    /// An archive is not readable.
    #[error("npz: {reason}")]
    Npz {
        /// Why.
        reason: String,
    },
    /// A DDS file is not readable.
    #[error("dds: {reason}")]
    Dds {
        /// Why.
        reason: String,
    },
    /// A table cannot be written in the layout that engines ship, or not be read in it.
    #[error("no drop-in: {reason}")]
    NotDropIn {
        /// Why.
        reason: String,
    },
    /// A file could not be read or written.
    #[error("{path}: {source}")]
    Io {
        /// Which file.
        path: String,
        /// Why.
        source: std::io::Error,
    },
    /// There is no such table.
    #[error("no table named \"{name}\"; there are: {known}")]
    NoSuchTable {
        /// The name asked for.
        name: String,
        /// The names there are.
        known: String,
    },
    /// There is no such version of a table.
    #[error("table \"{name}\" has no version \"{version}\"; there are: {known}")]
    NoSuchVersion {
        /// The table.
        name: String,
        /// The version, digest or alias asked for.
        version: String,
        /// The versions and aliases there are.
        known: String,
    },
    /// A name that is not a plain word.
    #[error("\"{name}\" is not a table name: 1 to 64 of a-z, 0-9 and -, a letter first")]
    BadName {
        /// The name.
        name: String,
    },
    /// A file format does not have a precision.
    #[error("{format} files do not hold {precision}")]
    NoSuchPrecision {
        /// The format.
        format: &'static str,
        /// The precision asked for.
        precision: &'static str,
    },
    /// A value cannot be held in the precision asked for.
    #[error("array {array}, entry {index}: {value:e} does not fit {precision}")]
    PrecisionLoss {
        /// Which array.
        array: &'static str,
        /// Which entry of it.
        index: usize,
        /// Its value.
        value: f64,
        /// The precision asked for.
        precision: &'static str,
    },
}

impl TableError {
    pub(crate) fn io(path: &std::path::Path, source: std::io::Error) -> Self {
        Self::Io { path: path.display().to_string(), source }
    }
}
