//! The database's tables, and how older ones become newer ones.

use rusqlite::{Connection, TransactionBehavior};

use super::database::failed;
use crate::StoreError;

/// Each step makes the next schema; `user_version` counts those taken. Steps that were ever released do not change.
const STEPS: &[&str] = &["
    CREATE TABLE versions (
        name TEXT NOT NULL,
        number INTEGER NOT NULL,
        digest TEXT NOT NULL,
        manifest TEXT NOT NULL,
        state TEXT NOT NULL,
        spec_digest TEXT,
        reason TEXT,
        created INTEGER NOT NULL,
        PRIMARY KEY (name, number),
        UNIQUE (name, digest)
    ) STRICT;
    CREATE INDEX versions_by_spec ON versions (spec_digest) WHERE spec_digest IS NOT NULL;
    CREATE TABLE aliases (
        name TEXT NOT NULL,
        alias TEXT NOT NULL,
        number INTEGER NOT NULL,
        revision INTEGER NOT NULL,
        seeded INTEGER NOT NULL,
        PRIMARY KEY (name, alias),
        FOREIGN KEY (name, number) REFERENCES versions (name, number)
    ) STRICT;
    CREATE TABLE tokens (
        id TEXT PRIMARY KEY NOT NULL,
        label TEXT NOT NULL,
        hash BLOB NOT NULL,
        scopes TEXT NOT NULL,
        created TEXT NOT NULL,
        expires TEXT
    ) STRICT;
    CREATE TABLE benchmarks (
        id INTEGER PRIMARY KEY AUTOINCREMENT,
        name TEXT NOT NULL,
        at TEXT NOT NULL,
        at_micros INTEGER NOT NULL,
        run TEXT NOT NULL
    ) STRICT;
    CREATE INDEX benchmarks_by_time ON benchmarks (at_micros, id);
    CREATE INDEX benchmarks_by_name ON benchmarks (name, at_micros, id);
    CREATE TABLE jobs (
        seq INTEGER PRIMARY KEY AUTOINCREMENT,
        id TEXT NOT NULL UNIQUE,
        name TEXT NOT NULL,
        spec TEXT NOT NULL,
        spec_digest TEXT NOT NULL,
        priority INTEGER NOT NULL,
        alias TEXT,
        force INTEGER NOT NULL,
        owner TEXT,
        key TEXT,
        state TEXT NOT NULL,
        progress REAL NOT NULL DEFAULT 0,
        seconds_left REAL,
        tv REAL,
        version INTEGER,
        error TEXT,
        attempts INTEGER NOT NULL DEFAULT 0,
        barren INTEGER NOT NULL DEFAULT 0,
        cancel INTEGER NOT NULL DEFAULT 0,
        worker TEXT,
        lease INTEGER,
        created INTEGER NOT NULL,
        updated INTEGER NOT NULL,
        UNIQUE (owner, key)
    ) STRICT;
    CREATE INDEX jobs_open ON jobs (state, priority, seq) WHERE state IN ('queued', 'running');
    CREATE TABLE events (
        job INTEGER NOT NULL REFERENCES jobs (seq) ON DELETE CASCADE,
        id INTEGER NOT NULL,
        kind TEXT NOT NULL,
        at INTEGER NOT NULL,
        data TEXT NOT NULL,
        PRIMARY KEY (job, id)
    ) STRICT, WITHOUT ROWID;
"];

/// The newest schema.
pub(super) fn known() -> i64 {
    STEPS.len() as i64
}

/// The schema that a database has; 0 for an empty one.
pub(super) fn found(connection: &Connection) -> Result<i64, StoreError> {
    let found = connection.query_row("PRAGMA user_version", [], |row| row.get(0)).map_err(failed)?;
    if found > known() { Err(StoreError::TooNew { found, known: known() }) } else { Ok(found) }
}

/// Takes the steps that are missing, all of them or none.
pub(super) fn migrate(connection: &mut Connection) -> Result<(), StoreError> {
    if found(connection)? == known() {
        return Ok(());
    }
    let transaction = connection.transaction_with_behavior(TransactionBehavior::Immediate).map_err(failed)?;
    // Somebody else may have been faster.
    for step in STEPS.iter().skip(usize::try_from(found(&transaction)?).unwrap_or(0)) {
        transaction.execute_batch(step).map_err(failed)?;
    }
    transaction.pragma_update(None, "user_version", known()).map_err(failed)?;
    transaction.commit().map_err(failed)
}
