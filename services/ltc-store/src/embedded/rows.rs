//! Rows as values.

use rusqlite::Row;
use rusqlite::types::{FromSql, FromSqlError, FromSqlResult, ToSql, ToSqlOutput, ValueRef};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;

use crate::{Alias, Benchmark, Event, Job, NewJob, StoredVersion, Token, TokenHash, clock};

/// A value kept as JSON.
pub(super) struct Json<T>(pub(super) T);

impl<T: Serialize> ToSql for Json<T> {
    fn to_sql(&self) -> rusqlite::Result<ToSqlOutput<'_>> {
        let text = serde_json::to_string(&self.0);
        text.map(Into::into).map_err(|e| rusqlite::Error::ToSqlConversionFailure(e.into()))
    }
}

impl<T: DeserializeOwned> FromSql for Json<T> {
    fn column_result(value: ValueRef<'_>) -> FromSqlResult<Self> {
        serde_json::from_str(value.as_str()?).map(Self).map_err(|e| FromSqlError::Other(e.into()))
    }
}

/// A variant without fields, kept as its name.
pub(super) struct Name<T>(pub(super) T);

impl<T: Serialize> ToSql for Name<T> {
    fn to_sql(&self) -> rusqlite::Result<ToSqlOutput<'_>> {
        match serde_json::to_value(&self.0) {
            Ok(Value::String(name)) => Ok(name.into()),
            Ok(other) => Err(rusqlite::Error::ToSqlConversionFailure(format!("{other} is no name").into())),
            Err(error) => Err(rusqlite::Error::ToSqlConversionFailure(error.into())),
        }
    }
}

impl<T: DeserializeOwned> FromSql for Name<T> {
    fn column_result(value: ValueRef<'_>) -> FromSqlResult<Self> {
        let name = Value::String(value.as_str()?.to_owned());
        serde_json::from_value(name).map(Self).map_err(|e| FromSqlError::Other(e.into()))
    }
}

/// Columns of [`version`].
pub(super) const VERSION: &str = "name, number, digest, manifest, state, spec_digest, reason";

pub(super) fn version(row: &Row<'_>) -> rusqlite::Result<StoredVersion> {
    Ok(StoredVersion {
        table: row.get(0)?,
        number: row.get(1)?,
        digest: row.get(2)?,
        manifest: row.get::<_, Json<_>>(3)?.0,
        state: row.get::<_, Name<_>>(4)?.0,
        spec_digest: row.get(5)?,
        reason: row.get(6)?,
    })
}

/// Columns of [`alias`].
pub(super) const ALIAS: &str = "name, alias, number, revision";

pub(super) fn alias(row: &Row<'_>) -> rusqlite::Result<Alias> {
    let revision: i64 = row.get(3)?;
    Ok(Alias {
        table: row.get(0)?,
        name: row.get(1)?,
        number: row.get(2)?,
        revision: revision.unsigned_abs(),
    })
}

/// Columns of [`token`].
pub(super) const TOKEN: &str = "id, label, hash, scopes, created, expires";

pub(super) fn token(row: &Row<'_>) -> rusqlite::Result<Token> {
    Ok(Token {
        id: row.get(0)?,
        label: row.get(1)?,
        hash: TokenHash(row.get(2)?),
        scopes: row.get::<_, Json<_>>(3)?.0,
        created: row.get(4)?,
        expires: row.get(5)?,
    })
}

/// Columns of [`benchmark`].
pub(super) const BENCHMARK: &str = "id, name, at, run";

pub(super) fn benchmark(row: &Row<'_>) -> rusqlite::Result<Benchmark> {
    let id: i64 = row.get(0)?;
    Ok(Benchmark {
        id: id.unsigned_abs(),
        name: row.get(1)?,
        at: row.get(2)?,
        run: row.get::<_, Json<_>>(3)?.0,
    })
}

/// Bytes of a run, without reading it.
pub(super) fn benchmark_bytes(row: &Row<'_>) -> rusqlite::Result<usize> {
    Ok(row.get_ref(3)?.as_str()?.len())
}

/// Columns of [`job`].
pub(super) const JOB: &str = "id, name, spec, spec_digest, priority, alias, force, owner, key, state, progress, seconds_left, \
                              tv, version, error, attempts, created, updated, cancel, seq";

pub(super) fn job(row: &Row<'_>) -> rusqlite::Result<Job> {
    let alias: Option<String> = row.get(5)?;
    let force = row.get(6)?;
    let (owner, key): (Option<String>, Option<String>) = (row.get(7)?, row.get(8)?);
    Ok(Job {
        id: row.get(0)?,
        request: NewJob {
            table: row.get(1)?,
            spec: row.get::<_, Json<_>>(2)?.0,
            spec_digest: row.get(3)?,
            priority: row.get(4)?,
            alias: alias.map(|alias| (alias, force)),
            idempotency: owner.zip(key),
        },
        state: row.get::<_, Name<_>>(9)?.0,
        progress: row.get(10)?,
        seconds_left: row.get(11)?,
        tv: row.get(12)?,
        version: row.get(13)?,
        error: row.get(14)?,
        attempts: row.get(15)?,
        created: clock::rfc3339(row.get(16)?),
        updated: clock::rfc3339(row.get(17)?),
        cancel_requested: row.get(18)?,
    })
}

/// Columns of [`event`].
pub(super) const EVENT: &str = "id, kind, at, data";

pub(super) fn event(row: &Row<'_>) -> rusqlite::Result<Event> {
    Ok(Event {
        id: row.get::<_, i64>(0)?.unsigned_abs(),
        kind: row.get::<_, Name<_>>(1)?.0,
        at: clock::rfc3339(row.get(2)?),
        data: row.get::<_, Json<_>>(3)?.0,
    })
}
