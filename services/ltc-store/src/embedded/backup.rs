//! Copies of a store, made while it is used.

use std::fs::{self, File};
use std::path::Path;

use ltc_table::digest::digest;
use rusqlite::{Connection, OpenFlags};
use serde::{Deserialize, Serialize};

use super::blobs::{BLOBS, Files};
use super::database::failed;
use super::{DATABASE, folder, schema};
use crate::{BlobKind, StoreError, clock};

/// Name of the file that says what a backup holds; written last, so that a folder with it is complete.
const CONTENTS: &str = "backup.json";
/// Name of the database in a folder that is not complete yet.
const UNFINISHED: &str = "unfinished.sqlite";
/// The way this program writes backups.
const FORMAT: u32 = 1;

/// What a backup holds.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Contents {
    /// How it is written.
    pub format: u32,
    /// When it was made, RFC 3339.
    pub created: String,
    /// SHA-256 of the database.
    pub database: String,
    /// Payloads in it.
    pub payloads: u64,
    /// Bytes of database and payloads.
    pub bytes: u64,
}

/// Copies the store in `store` to the folder `backup`, which must be empty or missing: the database as it is at one moment
/// (`VACUUM INTO`), and the payload of every version in it. A process may serve from the store meanwhile: payloads are
/// written before the versions that name them and never change. Derived blobs and checkpoints are left out: the ones are
/// computed again, without the others a running refit starts anew. What was cut short is completed by the same command.
///
/// # Errors
/// [`StoreError::NotFound`] without a store there; [`StoreError::Conflict`] where `backup` holds something;
/// [`StoreError::Damaged`] for a payload that is missing or not what its digest says; [`StoreError::Unwritable`].
pub fn back_up(store: &Path, backup: &Path) -> Result<Contents, StoreError> {
    let source = store.join(DATABASE);
    if !source.is_file() {
        return Err(StoreError::NotFound { what: "store", name: store.display().to_string() });
    }
    let backup = empty_folder(backup)?;
    let unfinished = backup.join(UNFINISHED);
    snapshot(&source, &unfinished)?;
    let bytes = read(&unfinished)?;
    let (payloads, size) = copy_payloads(&unfinished, &Files::to_read(store), &Files::attach(backup)?)?;
    let contents = Contents {
        format: FORMAT,
        created: clock::rfc3339(clock::now()),
        database: digest(&bytes),
        payloads,
        bytes: size + bytes.len() as u64,
    };
    complete(backup)?;
    let json = serde_json::to_vec_pretty(&contents).map_err(|e| StoreError::Backend(e.to_string()))?;
    folder::write(&backup.join(format!(".{CONTENTS}")), &backup.join(CONTENTS), &json)?;
    Ok(contents)
}

/// Makes a store in the folder `store`, which must be empty or missing, of a backup. Everything is checked: the database
/// against its digest, the payloads against theirs. The database comes last, so that a restore that was cut short leaves no
/// store, and the same command completes it.
///
/// # Errors
/// [`StoreError::NotFound`] for a folder that is no complete backup; [`StoreError::Conflict`] where `store` holds something;
/// [`StoreError::Damaged`]; [`StoreError::TooNew`]; [`StoreError::Unwritable`].
pub fn restore(backup: &Path, store: &Path) -> Result<Contents, StoreError> {
    let contents = fs::read(backup.join(CONTENTS));
    let contents = contents
        .map_err(|_| StoreError::NotFound { what: "complete backup", name: backup.display().to_string() })?;
    let damaged =
        |reason: String| StoreError::Damaged { what: format!("the backup {}", backup.display()), reason };
    let contents: Contents = serde_json::from_slice(&contents).map_err(|e| damaged(e.to_string()))?;
    if contents.format > FORMAT {
        return Err(StoreError::TooNew { found: contents.format.into(), known: FORMAT.into() });
    }
    let bytes = read(&backup.join(DATABASE))?;
    let found = digest(&bytes);
    if found != contents.database {
        return Err(damaged(format!("the digest of its database is {found}, not {}", contents.database)));
    }
    let store = empty_folder(store)?;
    let unfinished = store.join(UNFINISHED);
    fs::write(&unfinished, &bytes).map_err(|e| folder::failed(&unfinished, e))?;
    let (payloads, _) = copy_payloads(&unfinished, &Files::to_read(backup), &Files::attach(store)?)?;
    if payloads != contents.payloads {
        return Err(damaged(format!("it has {payloads} payloads, not {}", contents.payloads)));
    }
    complete(store)?;
    Ok(contents)
}

/// Puts the database in its place, now that everything else is.
fn complete(folder: &Path) -> Result<(), StoreError> {
    let (unfinished, place) = (folder.join(UNFINISHED), folder.join(DATABASE));
    let synced = File::open(&unfinished).and_then(|file| file.sync_all());
    let placed = synced.and_then(|()| fs::rename(&unfinished, &place)).and_then(|()| folder::sync(folder));
    placed.map_err(|e| folder::failed(&place, e))
}

/// The folder, made where it is missing, if there is nothing in it but what an earlier try left that was cut short.
fn empty_folder(place: &Path) -> Result<&Path, StoreError> {
    folder::make(place).map_err(|e| folder::failed(place, e))?;
    let entries = fs::read_dir(place).and_then(Iterator::collect::<Result<Vec<_>, _>>);
    let entries = entries.map_err(|e| folder::failed(place, e))?;
    let names: Vec<String> = entries.iter().map(|e| e.file_name().to_string_lossy().into_owned()).collect();
    // A file system of its own begins with lost+found. Blobs alone could be anything.
    let left = |name: &String| [BLOBS, UNFINISHED, "lost+found"].contains(&name.as_str());
    let odd = names.iter().find(|name| !left(name));
    let odd = odd.or(names.iter().find(|name| *name == BLOBS && !names.iter().any(|n| n == UNFINISHED)));
    match odd {
        Some(name) => {
            let reason = format!("{} is not empty: there is \"{name}\"", place.display());
            Err(StoreError::Conflict { reason })
        }
        None => Ok(place),
    }
}

/// The database as it is at one moment.
fn snapshot(source: &Path, target: &Path) -> Result<(), StoreError> {
    let connection = super::database::to_read(source)?;
    schema::found(&connection)?;
    match fs::remove_file(target) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
            return Err(folder::failed(target, error));
        }
        _ => {}
    }
    connection.execute("VACUUM INTO ?", [target.display().to_string()]).map(drop).map_err(failed)
}

/// Copies the payloads that a database names; how many, and how many bytes.
fn copy_payloads(database: &Path, from: &Files, to: &Files) -> Result<(u64, u64), StoreError> {
    let (mut count, mut bytes) = (0, 0);
    for digest in digests(database)? {
        let payload = from.get(BlobKind::Payload, &digest).map_err(|error| match error {
            StoreError::NotFound { .. } => {
                StoreError::Damaged { what: format!("the blob {digest}"), reason: "it is missing".to_owned() }
            }
            other => other,
        })?;
        to.put(BlobKind::Payload, &digest, &payload)?;
        count += 1;
        bytes += payload.len() as u64;
    }
    Ok((count, bytes))
}

fn digests(database: &Path) -> Result<Vec<String>, StoreError> {
    // Nobody else writes this one.
    let connection =
        Connection::open_with_flags(database, OpenFlags::SQLITE_OPEN_READ_ONLY).map_err(failed)?;
    schema::found(&connection)?;
    let check: String =
        connection.query_row("PRAGMA integrity_check(1)", [], |row| row.get(0)).map_err(failed)?;
    if check != "ok" {
        return Err(StoreError::Damaged { what: "the database".to_owned(), reason: check });
    }
    super::metadata::all(&connection, "SELECT DISTINCT digest FROM versions ORDER BY digest", [], |row| {
        row.get(0)
    })
}

fn read(path: &Path) -> Result<Vec<u8>, StoreError> {
    fs::read(path)
        .map_err(|e| StoreError::Damaged { what: path.display().to_string(), reason: e.to_string() })
}
