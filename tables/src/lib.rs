//! The LTC tables that this workspace ships, embedded in the program.
//!
//! The files lie beside this crate's manifest as `NAME/VERSION/{manifest.json, table.npz}`; `cargo xtask tables` makes
//! them.

use ltc_table::{Catalogue, TableError, TableVersion};

/// A manifest's JSON and a payload.
type Embedded = (&'static [u8], &'static [u8]);

static EMBEDDED: &[Embedded] = include!(concat!(env!("OUT_DIR"), "/embedded.rs"));

/// All shipped tables, digests checked.
///
/// # Errors
/// [`TableError`] when a file was damaged before it was embedded; the tests of this crate rule that out.
pub fn shipped() -> Result<Catalogue, TableError> {
    let mut catalogue = Catalogue::default();
    for (manifest, payload) in EMBEDDED {
        catalogue.insert(TableVersion::from_json(manifest, *payload)?);
    }
    Ok(catalogue)
}
