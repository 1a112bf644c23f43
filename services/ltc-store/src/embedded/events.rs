//! What happened to jobs.

use rusqlite::{Connection, params};
use serde_json::{Value, json};

use super::database::failed;
use super::rows::{self, Json, Name};
use crate::{Event, EventKind, Job, ShardReport, StoreError};

/// Reports of progress that are kept of one job: older ones are told by newer ones.
const PROGRESS_KEPT: i64 = 200;
/// Lines of the log that are kept of one job.
const LOG_KEPT: i64 = 2000;

/// Writes an event down under the next id of its job.
pub(super) fn add(
    db: &Connection,
    job: i64,
    kind: EventKind,
    at: i64,
    data: &Value,
) -> Result<(), StoreError> {
    let sql = "INSERT INTO events SELECT ?1, 1 + coalesce(max(id), 0), ?2, ?3, ?4 FROM events WHERE job = ?1";
    let mut statement = db.prepare_cached(sql).map_err(failed)?;
    statement.execute(params![job, Name(kind), at, Json(data)]).map_err(failed)?;
    let kept = match kind {
        EventKind::State => return Ok(()),
        EventKind::Progress => PROGRESS_KEPT,
        EventKind::Log => LOG_KEPT,
    };
    // The newest one always stays, so that ids go on growing.
    let sql = "DELETE FROM events WHERE job = ?1 AND kind = ?2 AND id <= \
               (SELECT id FROM events WHERE job = ?1 AND kind = ?2 ORDER BY id DESC LIMIT 1 OFFSET ?3)";
    let mut statement = db.prepare_cached(sql).map_err(failed)?;
    statement.execute(params![job, Name(kind), kept]).map_err(failed)?;
    Ok(())
}

/// That the state is what it is now.
pub(super) fn add_state(db: &Connection, seq: i64, job: &Job, at: i64) -> Result<(), StoreError> {
    add(db, seq, EventKind::State, at, &crate::jobs::state_event(job))
}

/// What a worker reports.
pub(super) fn add_report(db: &Connection, seq: i64, shard: &ShardReport, at: i64) -> Result<(), StoreError> {
    add(db, seq, EventKind::Progress, at, &crate::jobs::progress_event(shard))?;
    shard.log.as_ref().map_or(Ok(()), |line| add_log(db, seq, line, at))
}

/// A line of the log.
pub(super) fn add_log(db: &Connection, seq: i64, line: &str, at: i64) -> Result<(), StoreError> {
    add(db, seq, EventKind::Log, at, &json!({ "line": line }))
}

/// Those after an id.
pub(super) fn after(db: &Connection, seq: i64, id: u64) -> Result<Vec<Event>, StoreError> {
    let sql = format!("SELECT {} FROM events WHERE job = ? AND id > ? ORDER BY id", rows::EVENT);
    let id = i64::try_from(id).unwrap_or(i64::MAX);
    super::metadata::all(db, &sql, [seq, id], rows::event)
}
