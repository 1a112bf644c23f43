//! Blobs as files: `blobs/KIND/XX/KEY`, `XX` the first byte of the key's SHA-256, a `:` of the key written as `+`.

use std::fs::{self, File};
use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::SystemTime;

use async_trait::async_trait;
use sha2::{Digest, Sha256};

use super::{EmbeddedStore, folder, recent::Recent};
use crate::{BlobKind, Blobs, StoreError, key};

/// Name of the folder of all blobs.
pub(super) const BLOBS: &str = "blobs";
/// Name of the folder of files that are being written.
const TEMPORARY: &str = "tmp";
const KINDS: [BlobKind; 3] = [BlobKind::Payload, BlobKind::Derived, BlobKind::Checkpoint];

/// The files, and which derived ones were used last.
#[derive(Clone)]
pub(super) struct Files(Arc<Inner>);

struct Inner {
    folder: PathBuf,
    /// None where nothing may be written.
    derived_limit: Option<u64>,
    derived: Mutex<Recent>,
}

impl Files {
    /// For the process that serves: makes folders, removes temporaries, and looks at what is derived.
    pub(super) fn open(folder: &Path, derived_limit: u64) -> Result<Self, StoreError> {
        let files = Self::new(folder, Some(derived_limit));
        let temporary = files.0.folder.join(TEMPORARY);
        match fs::remove_dir_all(&temporary) {
            Err(error) if error.kind() != ErrorKind::NotFound => {
                return Err(folder::failed(&temporary, error));
            }
            _ => {}
        }
        files.make()?;
        files.find_derived()?;
        files.make_room(derived_limit)?;
        Ok(files)
    }

    /// For a command beside it.
    pub(super) fn attach(folder: &Path) -> Result<Self, StoreError> {
        let files = Self::new(folder, Some(u64::MAX));
        files.make()?;
        Ok(files)
    }

    /// Where nothing may be written.
    pub(super) fn read_only(folder: &Path) -> Result<Self, StoreError> {
        let files = Self::new(folder, None);
        files.find_derived()?;
        Ok(files)
    }

    /// Where nothing but reading by key is asked for.
    pub(super) fn to_read(folder: &Path) -> Self {
        Self::new(folder, None)
    }

    fn new(folder: &Path, derived_limit: Option<u64>) -> Self {
        let folder = folder.join(BLOBS);
        Self(Arc::new(Inner { folder, derived_limit, derived: Mutex::default() }))
    }

    fn make(&self) -> Result<(), StoreError> {
        let names = KINDS.iter().map(|kind| name(*kind)).chain([TEMPORARY]);
        for place in names.map(|name| self.0.folder.join(name)) {
            folder::make(&place).map_err(|e| folder::failed(&place, e))?;
        }
        Ok(())
    }

    /// Derived blobs of an earlier run, in the order of their files' times.
    fn find_derived(&self) -> Result<(), StoreError> {
        let mut found = self.find(BlobKind::Derived)?;
        found.sort_by_key(|(_, _, time)| *time);
        let mut recent = self.recent();
        for (key, size, _) in found {
            recent.used(&key, size);
        }
        Ok(())
    }

    fn recent(&self) -> MutexGuard<'_, Recent> {
        // Nothing panics while it holds this lock.
        self.0.derived.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn place(&self, kind: BlobKind, key: &str) -> PathBuf {
        let byte = Sha256::digest(key.as_bytes())[0];
        self.0.folder.join(name(kind)).join(format!("{byte:02x}")).join(key.replace(':', "+"))
    }

    /// A file that nobody else writes, and nobody reads.
    fn temporary(&self) -> PathBuf {
        static COUNT: AtomicU64 = AtomicU64::new(0);
        let count = COUNT.fetch_add(1, Ordering::Relaxed);
        self.0.folder.join(TEMPORARY).join(format!("{}-{count}", std::process::id()))
    }

    pub(super) fn put(&self, kind: BlobKind, key: &str, bytes: &[u8]) -> Result<(), StoreError> {
        key::check_to_write(kind, key, bytes)?;
        let Some(limit) = self.0.derived_limit else {
            return Err(StoreError::Unwritable { reason: "it was opened read-only".to_owned() });
        };
        let (place, size) = (self.place(kind, key), bytes.len() as u64);
        let fits = kind != BlobKind::Derived || size <= limit;
        if !fits || self.is_whole(kind, key, &place) {
            return Ok(());
        }
        folder::write(&self.temporary(), &place, bytes)?;
        if kind == BlobKind::Derived {
            self.recent().used(key, size);
            self.make_room(limit)?;
        }
        Ok(())
    }

    /// Removes derived blobs, the longest unused first, until no more than `limit` bytes are left.
    fn make_room(&self, limit: u64) -> Result<(), StoreError> {
        let gone = self.recent().evict(limit);
        gone.iter().try_for_each(|key| remove(&self.place(BlobKind::Derived, key)))
    }

    /// Whether a blob is there and is what its key says; a damaged one is written anew.
    fn is_whole(&self, kind: BlobKind, key: &str, place: &Path) -> bool {
        place.exists() && (kind != BlobKind::Payload || self.get(kind, key).is_ok())
    }

    pub(super) fn get(&self, kind: BlobKind, key: &str) -> Result<Vec<u8>, StoreError> {
        key::check_to_read(key)?;
        let place = self.place(kind, key);
        let mut bytes = Vec::new();
        let read = File::open(&place).and_then(|mut file| {
            file.read_to_end(&mut bytes)?;
            if kind == BlobKind::Derived && self.0.derived_limit.is_some() {
                // The order of use for the next start; a store that cannot note it works all the same.
                let _ = file.set_modified(SystemTime::now());
            }
            Ok(())
        });
        match read {
            Ok(()) => {}
            Err(error) if error.kind() == ErrorKind::NotFound => {
                if kind == BlobKind::Derived {
                    self.recent().forget(key);
                }
                return Err(key::not_found(key));
            }
            Err(error) => return Err(StoreError::Backend(format!("{}: {error}", place.display()))),
        }
        if kind == BlobKind::Derived {
            self.recent().used(key, bytes.len() as u64);
        }
        key::check_digest(kind, key, &bytes).map_err(|found| StoreError::Damaged {
            what: format!("the blob {key}"),
            reason: format!("its digest is {found}"),
        })?;
        Ok(bytes)
    }

    fn contains(&self, kind: BlobKind, key: &str) -> Result<bool, StoreError> {
        if key::check_to_read(key).is_err() {
            return Ok(false);
        }
        let place = self.place(kind, key);
        place.try_exists().map_err(|e| StoreError::Backend(format!("{}: {e}", place.display())))
    }

    fn delete(&self, kind: BlobKind, key: &str) -> Result<(), StoreError> {
        if key::check_to_read(key).is_err() {
            return Ok(());
        }
        if self.0.derived_limit.is_none() {
            return Err(StoreError::Unwritable { reason: "it was opened read-only".to_owned() });
        }
        remove(&self.place(kind, key))?;
        if kind == BlobKind::Derived {
            self.recent().forget(key);
        }
        Ok(())
    }

    fn list(&self, kind: BlobKind) -> Result<Vec<(String, u64)>, StoreError> {
        if kind == BlobKind::Derived {
            return Ok(self.recent().list());
        }
        let mut found = self.find(kind)?;
        found.sort();
        Ok(found.into_iter().map(|(key, size, _)| (key, size)).collect())
    }

    /// Keys, sizes and times of the files of a kind.
    fn find(&self, kind: BlobKind) -> Result<Vec<(String, u64, SystemTime)>, StoreError> {
        let all = self.0.folder.join(name(kind));
        let mut found = Vec::new();
        for place in entries(&all)? {
            for file in entries(&place)? {
                // A file may go while it is looked at.
                let Ok(data) = file.metadata() else { continue };
                let key = file.file_name().map(|n| n.to_string_lossy().replace('+', ":"));
                if let Some(key) = key.filter(|key| key::is_valid(key) && data.is_file()) {
                    found.push((key, data.len(), data.modified().unwrap_or(SystemTime::UNIX_EPOCH)));
                }
            }
        }
        Ok(found)
    }
}

/// What lies in a folder; nothing where there is none.
fn entries(folder: &Path) -> Result<Vec<PathBuf>, StoreError> {
    let entries = match fs::read_dir(folder) {
        Err(error) if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => {
            return Ok(Vec::new());
        }
        other => other,
    };
    let paths = entries.and_then(|entries| entries.map(|entry| entry.map(|e| e.path())).collect());
    paths.map_err(|e| StoreError::Backend(format!("{}: {e}", folder.display())))
}

fn remove(place: &Path) -> Result<(), StoreError> {
    match fs::remove_file(place) {
        Err(error) if error.kind() != ErrorKind::NotFound => Err(folder::failed(place, error)),
        _ => Ok(()),
    }
}

fn name(kind: BlobKind) -> &'static str {
    match kind {
        BlobKind::Payload => "payload",
        BlobKind::Derived => "derived",
        BlobKind::Checkpoint => "checkpoint",
    }
}

impl EmbeddedStore {
    /// Does something with files on a thread where that may take its time.
    async fn with_files<T: Send + 'static>(
        &self,
        work: impl FnOnce(&Files) -> Result<T, StoreError> + Send + 'static,
    ) -> Result<T, StoreError> {
        let files = self.files.clone();
        let task = tokio::task::spawn_blocking(move || work(&files));
        task.await.map_err(|e| StoreError::Backend(e.to_string()))?
    }
}

#[async_trait]
impl Blobs for EmbeddedStore {
    async fn put(&self, kind: BlobKind, key: &str, bytes: &[u8]) -> Result<(), StoreError> {
        let (key, bytes) = (key.to_owned(), bytes.to_vec());
        self.with_files(move |files| files.put(kind, &key, &bytes)).await
    }

    async fn get(&self, kind: BlobKind, key: &str) -> Result<Vec<u8>, StoreError> {
        let key = key.to_owned();
        self.with_files(move |files| files.get(kind, &key)).await
    }

    async fn contains(&self, kind: BlobKind, key: &str) -> Result<bool, StoreError> {
        let key = key.to_owned();
        self.with_files(move |files| files.contains(kind, &key)).await
    }

    async fn delete(&self, kind: BlobKind, key: &str) -> Result<(), StoreError> {
        let key = key.to_owned();
        self.with_files(move |files| files.delete(kind, &key)).await
    }

    async fn list(&self, kind: BlobKind) -> Result<Vec<(String, u64)>, StoreError> {
        self.with_files(move |files| files.list(kind)).await
    }
}
