//! The tables that come with the program.

use ltc_table::{Catalogue, Manifest, TableError};

use crate::{BlobKind, Blobs, Metadata, NewVersion, StoreError, VersionState};

/// The alias that every table has: its newest published version, unless it was set.
pub const LATEST: &str = "latest";

/// Aliases that every table has from the start.
pub const SEEDED_ALIASES: [&str; 2] = [LATEST, "stable"];

/// Puts every version of a catalogue into a store: payload first, then the version, and with it the aliases `latest` and
/// `stable`, which follow to newer shipped versions for as long as nobody moves them by other means. What is there already
/// stays as it is, so that the next start completes what a kill cut short. Gives the number of new versions.
///
/// `spec_digest` names the specification that a version was fitted by, where there is one.
///
/// # Errors
/// As [`Blobs::put`] and [`Metadata::seed`].
pub async fn seed(
    metadata: &dyn Metadata,
    blobs: &dyn Blobs,
    catalogue: &Catalogue,
    spec_digest: &(dyn Fn(&Manifest) -> Option<String> + Sync),
) -> Result<u32, StoreError> {
    let mut added = 0;
    let damaged =
        |e: TableError| StoreError::Damaged { what: "a shipped table".to_owned(), reason: e.to_string() };
    let names: Vec<String> = catalogue.names().map(str::to_owned).collect();
    for name in &names {
        for version in catalogue.versions(name).map_err(damaged)? {
            let manifest = version.manifest();
            let json = serde_json::to_value(manifest).map_err(|e| damaged(e.into()))?;
            blobs.put(BlobKind::Payload, &manifest.digest, version.payload()).await?;
            let new = NewVersion {
                table: name.clone(),
                digest: manifest.digest.clone(),
                manifest: json,
                state: VersionState::Published,
                spec_digest: spec_digest(manifest),
                reason: None,
            };
            let (_, is_new) = metadata.seed(new, &SEEDED_ALIASES).await?;
            added += u32::from(is_new);
        }
    }
    Ok(added)
}
