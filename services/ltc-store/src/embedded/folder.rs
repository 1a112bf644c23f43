//! Files that are there whole or not at all.

use std::fs::{self, File};
use std::io::{ErrorKind, Write};
use std::path::Path;

use crate::StoreError;

/// The system's errors as those of a store.
pub(super) fn failed(path: &Path, error: std::io::Error) -> StoreError {
    let reason = format!("{}: {error}", path.display());
    match error.kind() {
        ErrorKind::StorageFull
        | ErrorKind::QuotaExceeded
        | ErrorKind::FileTooLarge
        | ErrorKind::ReadOnlyFilesystem
        | ErrorKind::PermissionDenied => StoreError::Unwritable { reason },
        _ => StoreError::Backend(reason),
    }
}

/// Writes `bytes` to `temporary`, syncs it, and renames it to `place`, whose folder is made where it is missing. A kill at
/// any moment leaves nothing or all of it at `place`; when this returns it lasts through a power cut.
pub(super) fn write(temporary: &Path, place: &Path, bytes: &[u8]) -> Result<(), StoreError> {
    let result = write_and_rename(temporary, place, bytes);
    if result.is_err() {
        // Best effort: the error that matters is the one being returned, and the next start removes what is left.
        let _ = fs::remove_file(temporary);
    }
    result.map_err(|e| failed(place, e))
}

fn write_and_rename(temporary: &Path, place: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let mut file = File::create(temporary)?;
    file.write_all(bytes)?;
    file.sync_all()?;
    drop(file);
    let Some(folder) = place.parent() else { return Err(ErrorKind::InvalidInput.into()) };
    make(folder)?;
    fs::rename(temporary, place)?;
    sync(folder)
}

/// Makes a folder and those above it, and makes their names last.
pub(super) fn make(folder: &Path) -> std::io::Result<()> {
    if folder.is_dir() {
        return Ok(());
    }
    let above = folder.parent().filter(|p| !p.as_os_str().is_empty());
    if let Some(above) = above {
        make(above)?;
    }
    match fs::create_dir(folder) {
        Err(error) if error.kind() != ErrorKind::AlreadyExists => return Err(error),
        _ => {}
    }
    above.map_or(Ok(()), sync)
}

/// Makes the names in a folder last through a power cut.
#[cfg(unix)]
pub(super) fn sync(folder: &Path) -> std::io::Result<()> {
    File::open(folder)?.sync_all()
}

/// Folders cannot be synced here.
#[cfg(not(unix))]
pub(super) fn sync(_: &Path) -> std::io::Result<()> {
    Ok(())
}
