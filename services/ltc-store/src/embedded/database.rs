//! Connections to the database: one that writes, some that read, none of them used on the runtime's own threads.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use rusqlite::{Connection, ErrorCode, OpenFlags, Transaction, TransactionBehavior};
use tokio::sync::Semaphore;

use super::schema;
use crate::StoreError;

/// How long a connection waits for another process, such as `ltc token`.
const BUSY: Duration = Duration::from_secs(10);
/// Bytes of the log that stay on the disk after it was taken over into the database.
const LOG_KEPT: u32 = 16 << 20;
/// Connections that read.
const READERS: usize = 4;

/// The database.
#[derive(Clone)]
pub(super) struct Database {
    path: PathBuf,
    /// Which file had that path when it was opened.
    file: FileId,
    /// Or why there is none.
    writer: Result<Pool, String>,
    readers: Pool,
}

impl Database {
    /// Opens it, makes it where it is missing, and brings it up to date. `may_migrate` is asked before an older one is changed.
    pub(super) fn open(
        path: &Path,
        may_migrate: &dyn Fn() -> Result<(), StoreError>,
    ) -> Result<Self, StoreError> {
        let mut writer = connect(path, OpenFlags::default())?;
        writer.pragma_update_and_check(None, "journal_mode", "wal", |_| Ok(())).map_err(failed)?;
        writer.pragma_update(None, "synchronous", "full").map_err(failed)?;
        writer.pragma_update(None, "journal_size_limit", LOG_KEPT).map_err(failed)?;
        let found = schema::found(&writer)?;
        if found != 0 && found != schema::known() {
            may_migrate()?;
        }
        schema::migrate(&mut writer)?;
        let readers = (0..READERS).map(|_| connect(path, read_only())).collect::<Result<_, _>>()?;
        let writer = Ok(Pool::new(vec![writer]));
        Ok(Self { path: path.to_owned(), file: file_id(path)?, writer, readers: Pool::new(readers) })
    }

    /// Opens one that cannot be written to, for this reason.
    pub(super) fn open_read_only(path: &Path, reason: &str) -> Result<Self, StoreError> {
        let readers: Vec<Connection> = (0..READERS).map(|_| to_read(path)).collect::<Result<_, _>>()?;
        for reader in &readers {
            let found = schema::found(reader)?;
            if found != schema::known() {
                return Err(StoreError::Unwritable {
                    reason: format!("its schema {found} has to be brought up to date"),
                });
            }
        }
        let writer = Err(reason.to_owned());
        Ok(Self { path: path.to_owned(), file: file_id(path)?, writer, readers: Pool::new(readers) })
    }

    /// The file.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Whether the file that was opened is still there under its name.
    pub(super) fn is_in_place(&self) -> bool {
        file_id(&self.path).is_ok_and(|now| now == self.file)
    }

    /// Whether it can be written.
    pub(super) fn is_writable(&self) -> bool {
        self.writer.is_ok()
    }

    /// Reads, on a thread where that may take its time. All of it sees one moment.
    pub(super) async fn read<T: Send + 'static>(
        &self,
        work: impl FnOnce(&Connection) -> Result<T, StoreError> + Send + 'static,
    ) -> Result<T, StoreError> {
        self.readers
            .with(|connection| {
                let transaction = connection.transaction().map_err(failed)?;
                let value = work(&transaction)?;
                // Nothing was written; ending it any way is as good.
                drop(transaction);
                Ok(value)
            })
            .await
    }

    /// Writes: what `work` does is on stable storage when this returns `Ok`, and undone when it returns an error.
    pub(super) async fn write<T: Send + 'static>(
        &self,
        work: impl FnOnce(&Transaction<'_>) -> Result<T, StoreError> + Send + 'static,
    ) -> Result<T, StoreError> {
        self.writer()?
            .with(|connection| {
                let behaviour = TransactionBehavior::Immediate;
                let transaction = connection.transaction_with_behavior(behaviour).map_err(failed)?;
                let value = work(&transaction)?;
                transaction.commit().map_err(failed)?;
                Ok(value)
            })
            .await
    }

    fn writer(&self) -> Result<&Pool, StoreError> {
        let why =
            |reason| StoreError::Unwritable { reason: format!("it was opened for reading only: {reason}") };
        self.writer.as_ref().map_err(why)
    }
}

/// What tells one file of a system from all others, whatever its name.
#[cfg(unix)]
type FileId = (u64, u64);
/// Other systems do not let an open file be deleted or moved.
#[cfg(not(unix))]
type FileId = ();

fn file_id(path: &Path) -> Result<FileId, StoreError> {
    let found = std::fs::metadata(path)
        .map_err(|error| StoreError::Backend(format!("{}: {error}", path.display())))?;
    #[cfg(unix)]
    return Ok((std::os::unix::fs::MetadataExt::dev(&found), std::os::unix::fs::MetadataExt::ino(&found)));
    #[cfg(not(unix))]
    return Ok(drop(found));
}

/// Idle connections and as many permits.
#[derive(Clone)]
struct Pool {
    idle: Arc<Mutex<Vec<Connection>>>,
    permits: Arc<Semaphore>,
}

impl Pool {
    fn new(connections: Vec<Connection>) -> Self {
        let permits = Arc::new(Semaphore::new(connections.len()));
        Self { idle: Arc::new(Mutex::new(connections)), permits }
    }

    async fn with<T: Send + 'static>(
        &self,
        work: impl FnOnce(&mut Connection) -> Result<T, StoreError> + Send + 'static,
    ) -> Result<T, StoreError> {
        let closed = || StoreError::Backend("the database is closed".to_owned());
        let permit = Arc::clone(&self.permits).acquire_owned().await.map_err(|_| closed())?;
        let idle = Arc::clone(&self.idle);
        let task = tokio::task::spawn_blocking(move || {
            let connection = lock(&idle).pop();
            let mut lent = Lent { connection, idle };
            let result = lent.connection.as_mut().ok_or_else(closed).and_then(work);
            // The connection first, so that whoever gets the permit finds it.
            drop(lent);
            drop(permit);
            result
        });
        task.await.map_err(|e| StoreError::Backend(e.to_string()))?
    }
}

/// A connection that goes back when it is dropped, even by a panic.
struct Lent {
    connection: Option<Connection>,
    idle: Arc<Mutex<Vec<Connection>>>,
}

fn lock(idle: &Mutex<Vec<Connection>>) -> MutexGuard<'_, Vec<Connection>> {
    // Nothing panics while it holds this lock.
    idle.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Drop for Lent {
    fn drop(&mut self) {
        if let Some(connection) = self.connection.take() {
            lock(&self.idle).push(connection);
        }
    }
}

/// A connection that reads, beside others that write or where nobody may.
pub(super) fn to_read(path: &Path) -> Result<Connection, StoreError> {
    let pending = path.with_extension("sqlite-wal").metadata().is_ok_and(|m| m.len() > 0);
    let connection = connect(path, read_only()).and_then(|connection| {
        schema::found(&connection)?;
        Ok(connection)
    });
    match connection {
        // Where SQLite may not make its lock files: without a log there is nobody who writes, and no lock is needed.
        Err(StoreError::Unwritable { .. }) if !pending => {
            let uri = format!("file:{}?immutable=1", escaped(path));
            Connection::open_with_flags(uri, read_only() | OpenFlags::SQLITE_OPEN_URI).map_err(failed)
        }
        other => other,
    }
}

fn read_only() -> OpenFlags {
    OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX
}

fn connect(path: &Path, flags: OpenFlags) -> Result<Connection, StoreError> {
    let connection = Connection::open_with_flags(path, flags - OpenFlags::SQLITE_OPEN_URI).map_err(failed)?;
    connection.busy_timeout(BUSY).map_err(failed)?;
    connection.pragma_update(None, "foreign_keys", true).map_err(failed)?;
    connection.set_prepared_statement_cache_capacity(64);
    Ok(connection)
}

/// A path as part of a URI.
fn escaped(path: &Path) -> String {
    path.display().to_string().replace('%', "%25").replace('?', "%3f").replace('#', "%23")
}

/// SQLite's errors as those of a store.
pub(super) fn failed(error: rusqlite::Error) -> StoreError {
    let reason = error.to_string();
    let extended = error.sqlite_error().map(|e| e.extended_code);
    if matches!(extended, Some(rusqlite::ffi::SQLITE_IOERR_READ | rusqlite::ffi::SQLITE_IOERR_SHORT_READ)) {
        return StoreError::Backend(reason);
    }
    match error.sqlite_error_code() {
        Some(
            ErrorCode::DiskFull
            | ErrorCode::ReadOnly
            | ErrorCode::CannotOpen
            | ErrorCode::SystemIoFailure
            | ErrorCode::PermissionDenied,
        ) => StoreError::Unwritable { reason },
        Some(ErrorCode::DatabaseCorrupt | ErrorCode::NotADatabase) => {
            StoreError::Damaged { what: "the database".to_owned(), reason }
        }
        _ => StoreError::Backend(reason),
    }
}
