//! The store in one folder: `ltc.sqlite` for what changes, files below `blobs/` for what does not.

mod backup;
mod blobs;
mod database;
mod events;
mod folder;
mod jobs;
mod metadata;
mod recent;
mod rows;
mod schema;

use std::fs::{self, File, TryLockError};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use tokio::sync::watch;

use crate::StoreError;
pub use backup::{Contents, back_up, restore};
use blobs::Files;
use database::Database;

/// Name of the database below the folder.
const DATABASE: &str = "ltc.sqlite";
/// Name of the lock that a serving process holds.
const LOCK: &str = "lock";
/// Bytes of derived blobs that are kept unless another limit is set.
const DERIVED_LIMIT: u64 = 1 << 30;

/// Metadata, blobs and jobs in one folder, with nothing else to install.
///
/// One process serves from a folder ([`EmbeddedStore::open`] takes a lock); others may look at it and change metadata at the
/// same time ([`EmbeddedStore::attach`]). SQLite runs with a write-ahead log and full synchronisation; no call blocks the
/// runtime's threads.
#[derive(Clone)]
pub struct EmbeddedStore {
    folder: PathBuf,
    database: Database,
    files: Files,
    changes: watch::Sender<u64>,
    _lock: Option<Arc<File>>,
}

impl EmbeddedStore {
    /// Opens the store for serving: makes what is missing, brings the database up to date, removes what a kill left half
    /// written. Where the folder cannot be written to but has a store, that is opened for reading, and writing to it is
    /// [`StoreError::Unwritable`]. Derived blobs are bounded to 1 GiB.
    ///
    /// # Errors
    /// [`StoreError::Conflict`] while another process serves from it; [`StoreError::TooNew`]; [`StoreError::Unwritable`];
    /// [`StoreError::Damaged`].
    pub fn open(folder: &Path) -> Result<Self, StoreError> {
        Self::open_with(folder, DERIVED_LIMIT)
    }

    /// The same with another bound of the derived blobs, in bytes.
    ///
    /// # Errors
    /// As [`EmbeddedStore::open`].
    pub fn open_with(folder: &Path, derived_limit: u64) -> Result<Self, StoreError> {
        Self::open_for_writing(folder, derived_limit).or_else(|error| Self::open_to_read(folder, error))
    }

    /// What can be done where writing fails: a store that is there is read.
    fn open_to_read(folder: &Path, error: StoreError) -> Result<Self, StoreError> {
        let StoreError::Unwritable { reason } = &error else { return Err(error) };
        match Database::open_read_only(&folder.join(DATABASE), reason) {
            Ok(database) => Ok(Self::new(folder, database, Files::read_only(folder)?, None)),
            // What stands in the way of writing is what has to be mended.
            Err(_) => Err(error),
        }
    }

    fn open_for_writing(folder: &Path, derived_limit: u64) -> Result<Self, StoreError> {
        make_folder(folder)?;
        let lock = lock(folder)?;
        let database = Database::open(&folder.join(DATABASE), &|| Ok(()))?;
        let files = Files::open(folder, derived_limit)?;
        Ok(Self::new(folder, database, files, Some(Arc::new(lock))))
    }

    /// Opens the store beside a process that may be serving from it, for a command. Makes what is missing; what cannot be
    /// written to is read, as by [`EmbeddedStore::open`].
    ///
    /// # Errors
    /// As [`EmbeddedStore::open`], and [`StoreError::Conflict`] where the store has to be brought up to date while an older
    /// program serves from it.
    pub fn attach(folder: &Path) -> Result<Self, StoreError> {
        let attach = || {
            make_folder(folder)?;
            let database = Database::open(&folder.join(DATABASE), &|| lock(folder).map(drop))?;
            Ok(Self::new(folder, database, Files::attach(folder)?, None))
        };
        attach().or_else(|error| Self::open_to_read(folder, error))
    }

    /// Whether there is a store in a folder.
    pub fn is_in(folder: &Path) -> bool {
        folder.join(DATABASE).is_file()
    }

    fn new(folder: &Path, database: Database, files: Files, lock: Option<Arc<File>>) -> Self {
        let (changes, _) = watch::channel(0);
        Self { folder: folder.to_owned(), database, files, changes, _lock: lock }
    }

    /// The folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Whether it was opened for writing. The device may fill up all the same.
    pub fn is_writable(&self) -> bool {
        self.database.is_writable()
    }

    /// Bytes of the database on the disk, its log included.
    pub fn database_bytes(&self) -> u64 {
        let size = |path: &Path| path.metadata().map_or(0, |m| m.len());
        size(self.database.path()) + size(&self.database.path().with_extension("sqlite-wal"))
    }

    /// Tells those who wait for a change of a job.
    fn changed(&self) {
        self.changes.send_modify(|n| *n += 1);
    }
}

fn make_folder(folder: &Path) -> Result<(), StoreError> {
    fs::create_dir_all(folder).map_err(|e| folder::failed(folder, e))
}

/// The lock of the process that serves from the folder; it goes with the process.
fn lock(folder: &Path) -> Result<File, StoreError> {
    let path = folder.join(LOCK);
    let open = File::options().create(true).truncate(false).write(true).open(&path);
    let file = open.map_err(|e| folder::failed(&path, e))?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => {
            Err(StoreError::Conflict { reason: format!("another process serves from {}", folder.display()) })
        }
        Err(TryLockError::Error(error)) => Err(folder::failed(&path, error)),
    }
}
