//! Versioned tables of linearly transformed cosines: axes, channels, lookup, provenance, digests, codecs.
//!
//! A [`Table`] is what was fitted: for every node of its axes a matrix `M`, a magnitude and a Fresnel term, in `f64`, which a
//! [`ClosedForm`] may take part of. A
//! [`TableVersion`] is a table that left the workshop: an immutable payload with a [`Manifest`] that says what it is, how
//! it was made and how good it is, named by the SHA-256 [`digest`](mod@digest) of the payload. A [`Catalogue`] finds
//! versions.

mod axis;
mod catalogue;
mod channels;
mod closed_form;
mod crop;
pub mod digest;
pub mod drop_in;
mod error;
pub mod files;
pub mod form_factor;
pub mod ktx2;
pub mod lookup;
mod manifest;
pub mod npz;
mod precision;
mod query;
mod shelf;
mod table;
#[cfg(test)]
mod testing;
mod version;

pub use axis::{Axis, Mapping, Quantity};
pub use catalogue::Catalogue;
pub use channels::Channels;
pub use closed_form::ClosedForm;
pub use crop::Part;
pub use drop_in::DropIn;
pub use error::TableError;
pub use lookup::{Lobe, Lookup};
pub use manifest::{BrdfInfo, ChannelInfo, DrawErrors, Errors, Floors, GridErrors, Manifest};
pub use precision::Precision;
pub use query::{Folded, Query, direction};
pub use shelf::{Added, add_version};
pub use table::{CellStats, Kind, Table};
pub use version::{MANIFEST_FILE, PAYLOAD_FILE, TableVersion, check_name};
