//! Tables on the disk, by digest.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use ltc_table::digest::{digest, is_digest};
use ltc_table::{TableVersion, files};

use crate::ClientError;

/// A folder of tables: `<hex>.npz` and `<hex>.json` for each digest. A file is written beside its place, synced, and renamed into
/// it, so that several processes may share the folder and a kill leaves nothing half written.
#[derive(Clone, Debug)]
pub struct Cache {
    folder: PathBuf,
}

impl Cache {
    /// A cache in that folder; it is made when something is first kept.
    pub fn new(folder: &Path) -> Self {
        Self { folder: folder.to_owned() }
    }

    fn path(&self, digest: &str, ending: &str) -> PathBuf {
        self.folder.join(format!("{}.{ending}", digest.trim_start_matches("sha256:")))
    }

    /// The payload of that digest, if it is there and is what it was.
    ///
    /// # Errors
    /// [`ClientError::Cache`] for a file that is there and cannot be read.
    pub fn payload(&self, digest_wanted: &str) -> Result<Option<Vec<u8>>, ClientError> {
        let found = self.read(digest_wanted, "npz")?;
        // A damaged one is not there: it is fetched again and replaced.
        Ok(found.filter(|payload| digest(payload) == digest_wanted))
    }

    /// The table of that digest, if manifest and payload are there and belong together.
    ///
    /// # Errors
    /// As [`Cache::payload`].
    pub fn table(&self, digest: &str) -> Result<Option<TableVersion>, ClientError> {
        let (manifest, payload) = (self.read(digest, "json")?, self.payload(digest)?);
        let table = manifest.zip(payload).and_then(|(m, p)| TableVersion::from_json(&m, p).ok());
        Ok(table.filter(|table| table.manifest().digest == digest))
    }

    /// Keeps a table.
    ///
    /// # Errors
    /// [`ClientError::Cache`], [`ClientError::Table`].
    pub fn keep(&self, version: &TableVersion) -> Result<(), ClientError> {
        let digest = &version.manifest().digest;
        let failed = |cause| ClientError::Cache { path: self.folder.clone(), cause };
        std::fs::create_dir_all(&self.folder).map_err(failed)?;
        files::write_atomically(&self.path(digest, "npz"), version.payload())?;
        files::write_atomically(&self.path(digest, "json"), version.manifest_json()?.as_bytes())?;
        Ok(())
    }

    fn read(&self, digest: &str, ending: &str) -> Result<Option<Vec<u8>>, ClientError> {
        if !is_digest(digest) {
            return Err(ClientError::BadName(digest.to_owned()));
        }
        let path = self.path(digest, ending);
        match std::fs::read(&path) {
            Ok(bytes) => Ok(Some(bytes)),
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
            Err(cause) => Err(ClientError::Cache { path, cause }),
        }
    }
}
