//! Jobs in SQLite.

use std::time::Duration;

use async_trait::async_trait;
use rusqlite::{Connection, OptionalExtension, ToSql, params};

use super::database::failed;
use super::rows::{self, Json, Name};
use super::{EmbeddedStore, events, metadata};
use crate::jobs::{barren, check_same, ended, lost, new_id, no_job};
use crate::{Claim, Event, Job, JobState, Jobs, MAX_BARREN, NewJob, Outcome, ShardReport, StoreError, clock};

/// Ended jobs that are kept; older ones go with their events when a new one comes.
const ENDED_KEPT: u32 = 10_000;

#[async_trait]
impl Jobs for EmbeddedStore {
    async fn enqueue(&self, job: NewJob, limit: u64) -> Result<(Job, bool), StoreError> {
        let result = self.database.write(move |db| enqueue(db, job, limit)).await;
        self.changed();
        result
    }

    async fn enqueue_done(&self, job: NewJob, version: u32, note: &str) -> Result<(Job, bool), StoreError> {
        let note = note.to_owned();
        let result = self
            .database
            .write(move |db| {
                if let Some(there) = same_key(db, &job)? {
                    return Ok((there, false));
                }
                let (seq, _) = insert(db, &job)?;
                Ok((end(db, seq, Outcome::Succeeded { version, note })?, true))
            })
            .await;
        self.changed();
        result
    }

    async fn claim(&self, worker: &str, lease: Duration) -> Result<Option<Claim>, StoreError> {
        // Most looks find nothing, and need not wait for those who write.
        let (name, now) = (worker.to_owned(), clock::now());
        if self.database.read(move |db| next(db, &name, now)).await?.is_none() {
            return Ok(None);
        }
        let worker = worker.to_owned();
        let claim = self.database.write(move |db| claim(db, &worker, lease)).await?;
        self.changed();
        Ok(claim)
    }

    async fn report(&self, claim: &Claim, lease: Duration, shard: ShardReport) -> Result<Job, StoreError> {
        let claim = (claim.job.id.clone(), claim.attempt);
        let job = self.database.write(move |db| report(db, &claim, lease, &shard)).await?;
        self.changed();
        Ok(job)
    }

    async fn finish(&self, claim: &Claim, outcome: Outcome) -> Result<Job, StoreError> {
        let claim = (claim.job.id.clone(), claim.attempt);
        let job = self.database.write(move |db| finish(db, &claim, outcome)).await?;
        self.changed();
        Ok(job)
    }

    async fn cancel(&self, id: &str) -> Result<Job, StoreError> {
        let id = id.to_owned();
        let job = self.database.write(move |db| cancel(db, &id)).await?;
        self.changed();
        Ok(job)
    }

    async fn job(&self, id: &str) -> Result<Job, StoreError> {
        let id = id.to_owned();
        self.database.read(move |db| Ok(find(db, &id)?.1)).await
    }

    async fn jobs(&self, limit: u32) -> Result<Vec<Job>, StoreError> {
        let sql = format!("SELECT {} FROM jobs ORDER BY seq DESC LIMIT ?", rows::JOB);
        self.database.read(move |db| metadata::all(db, &sql, [limit], rows::job)).await
    }

    async fn events(&self, id: &str, after: u64) -> Result<Vec<Event>, StoreError> {
        let id = id.to_owned();
        self.database.read(move |db| events::after(db, find(db, &id)?.0, after)).await
    }

    fn watch(&self) -> tokio::sync::watch::Receiver<u64> {
        self.changes.subscribe()
    }

    async fn depth(&self) -> Result<(u64, u64), StoreError> {
        self.database.read(|db| Ok((count(db, JobState::Queued)?, count(db, JobState::Running)?))).await
    }
}

fn count(db: &Connection, state: JobState) -> Result<u64, StoreError> {
    let sql = match state {
        JobState::Queued => "SELECT count(*) FROM jobs WHERE state = 'queued'",
        _ => "SELECT count(*) FROM jobs WHERE state = 'running'",
    };
    let count: i64 = db.query_row(sql, [], |row| row.get(0)).map_err(failed)?;
    Ok(count.unsigned_abs())
}

/// A job and its number.
fn one(
    db: &Connection,
    condition: &str,
    value: impl rusqlite::Params,
) -> Result<Option<(i64, Job)>, StoreError> {
    let sql = format!("SELECT {} FROM jobs WHERE {condition}", rows::JOB);
    let mut statement = db.prepare_cached(&sql).map_err(failed)?;
    statement.query_row(value, |row| Ok((row.get("seq")?, rows::job(row)?))).optional().map_err(failed)
}

fn find(db: &Connection, id: &str) -> Result<(i64, Job), StoreError> {
    one(db, "id = ?", [id])?.ok_or_else(|| no_job(id))
}

/// The job of a claim, if it is still one.
fn held(db: &Connection, (id, attempt): &(String, u32)) -> Result<(i64, Job), StoreError> {
    let held = one(db, "id = ? AND attempts = ? AND state = 'running'", params![id, attempt])?;
    held.ok_or_else(|| lost(id))
}

/// Changes some columns of a job; it as it is then.
fn change(db: &Connection, seq: i64, set: &str, values: &[&dyn ToSql]) -> Result<Job, StoreError> {
    let sql = format!("UPDATE jobs SET {set} WHERE seq = {seq}");
    db.execute(&sql, values).map_err(failed)?;
    one(db, "seq = ?", [seq])?
        .map(|(_, job)| job)
        .ok_or_else(|| StoreError::Backend("a job went away".to_owned()))
}

fn enqueue(db: &Connection, job: NewJob, limit: u64) -> Result<(Job, bool), StoreError> {
    if let Some(there) = same_key(db, &job)? {
        return Ok((there, false));
    }
    if count(db, JobState::Queued)? >= limit {
        return Err(StoreError::Full { what: "the queue", limit });
    }
    Ok((insert(db, &job)?.1, true))
}

/// The job of the same idempotency key.
fn same_key(db: &Connection, job: &NewJob) -> Result<Option<Job>, StoreError> {
    let (owner, key) = job.idempotency.as_ref().map(|(owner, key)| (owner, key)).unzip();
    let Some((_, there)) = one(db, "owner = ? AND key = ?", params![owner, key])? else { return Ok(None) };
    check_same(&there.request, job)?;
    Ok(Some(there))
}

/// A new job and its number, queued.
fn insert(db: &Connection, job: &NewJob) -> Result<(i64, Job), StoreError> {
    // Numbers of jobs that are gone are not used again.
    let last = "SELECT coalesce(max(sqlite_sequence.seq), 0) FROM sqlite_sequence WHERE name = 'jobs'";
    let last: i64 = db.query_row(last, [], |row| row.get(0)).map_err(failed)?;
    let (seq, now) = (last + 1, clock::now());
    let id = new_id(seq.unsigned_abs())?;
    let (alias, force) = job.alias.as_ref().map(|(alias, force)| (alias, *force)).unzip();
    let (owner, key) = job.idempotency.as_ref().map(|(owner, key)| (owner, key)).unzip();
    let (spec, force) = (Json(&job.spec), force.unwrap_or(false));
    let NewJob { table, spec_digest, priority, .. } = job;
    db.execute(
        "INSERT INTO jobs (seq, id, name, spec, spec_digest, priority, alias, force, owner, key, state, created, updated) \
         VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, 'queued', ?, ?)",
        params![seq, id, table, spec, spec_digest, priority, alias, force, owner, key, now, now],
    )
    .map_err(failed)?;
    forget_old(db, ENDED_KEPT)?;
    let (seq, job) = find(db, &id)?;
    events::add_state(db, seq, &job, now)?;
    Ok((seq, job))
}

fn forget_old(db: &Connection, kept: u32) -> Result<(), StoreError> {
    let sql = "DELETE FROM jobs WHERE state NOT IN ('queued', 'running') AND seq <= \
               (SELECT seq FROM jobs WHERE state NOT IN ('queued', 'running') ORDER BY seq DESC LIMIT 1 OFFSET ?)";
    db.execute(sql, [kept]).map(drop).map_err(failed)
}

/// What a worker takes next.
fn next(db: &Connection, worker: &str, now: i64) -> Result<Option<(i64, u32)>, StoreError> {
    let sql = "SELECT seq, barren FROM jobs \
               WHERE state = 'queued' OR (state = 'running' AND (worker = ?1 OR lease <= ?2)) \
               ORDER BY state = 'running' DESC, priority DESC, seq LIMIT 1";
    let mut statement = db.prepare_cached(sql).map_err(failed)?;
    statement.query_row(params![worker, now], |row| Ok((row.get(0)?, row.get(1)?))).optional().map_err(failed)
}

fn claim(db: &Connection, worker: &str, lease: Duration) -> Result<Option<Claim>, StoreError> {
    let now = clock::now();
    while let Some((seq, lost)) = next(db, worker, now)? {
        if lost >= MAX_BARREN {
            let set = "state = 'failed', error = ?, updated = ?, worker = NULL, lease = NULL";
            let job = change(db, seq, set, &[&barren(), &now])?;
            events::add_state(db, seq, &job, now)?;
            continue;
        }
        let set = "state = 'running', attempts = attempts + 1, barren = barren + 1, worker = ?, lease = ?, updated = ?";
        let job = change(db, seq, set, &[&worker, &until(now, lease), &now])?;
        events::add_state(db, seq, &job, now)?;
        return Ok(Some(Claim { attempt: job.attempts, job }));
    }
    Ok(None)
}

fn until(now: i64, lease: Duration) -> i64 {
    now.saturating_add(i64::try_from(lease.as_micros()).unwrap_or(i64::MAX))
}

fn report(
    db: &Connection,
    claim: &(String, u32),
    lease: Duration,
    shard: &ShardReport,
) -> Result<Job, StoreError> {
    let (seq, before) = held(db, claim)?;
    let now = clock::now();
    let progress = if shard.progress.is_finite() { shard.progress.clamp(0.0, 1.0) } else { before.progress };
    let shard = ShardReport { progress, ..shard.clone() };
    let set = "barren = CASE WHEN ?1 > progress THEN 0 ELSE barren END, progress = ?1, seconds_left = ?2, \
               tv = coalesce(?3, tv), lease = ?4, updated = ?5";
    let values: [&dyn ToSql; 5] = [&progress, &shard.seconds_left, &shard.tv, &until(now, lease), &now];
    let job = change(db, seq, set, &values)?;
    events::add_report(db, seq, &shard, now)?;
    Ok(job)
}

fn finish(db: &Connection, claim: &(String, u32), outcome: Outcome) -> Result<Job, StoreError> {
    let (seq, before) = held(db, claim)?;
    // Whoever releases a job that is to be cancelled has nothing more to do with it.
    let cancelled = outcome == Outcome::Released && before.cancel_requested;
    end(db, seq, if cancelled { Outcome::Cancelled } else { outcome })
}

fn end(db: &Connection, seq: i64, outcome: Outcome) -> Result<Job, StoreError> {
    let now = clock::now();
    let (released, succeeded) = (outcome == Outcome::Released, matches!(outcome, Outcome::Succeeded { .. }));
    let (state, version, error, note) = ended(outcome);
    let set = "state = ?, version = ?, error = ?, progress = iif(?, 1.0, progress), barren = max(0, barren - ?), \
               updated = ?, seconds_left = NULL, worker = NULL, lease = NULL";
    let job = change(db, seq, set, &[&Name(state), &version, &error, &succeeded, &released, &now])?;
    if let Some(note) = note {
        events::add_log(db, seq, &note, now)?;
    }
    events::add_state(db, seq, &job, now)?;
    Ok(job)
}

fn cancel(db: &Connection, id: &str) -> Result<Job, StoreError> {
    let (seq, job) = find(db, id)?;
    let now = clock::now();
    let set = match job.state {
        JobState::Cancelled => return Ok(job),
        JobState::Running if job.cancel_requested => return Ok(job),
        JobState::Running => "cancel = 1, updated = ?",
        JobState::Queued => "state = 'cancelled', cancel = 1, updated = ?",
        JobState::Succeeded | JobState::Failed => {
            return Err(StoreError::Conflict { reason: format!("the refit {id} has ended already") });
        }
    };
    let job = change(db, seq, set, &[&now])?;
    events::add_state(db, seq, &job, now)?;
    Ok(job)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::EventKind;

    fn database() -> Connection {
        let mut db = Connection::open_in_memory().unwrap();
        db.pragma_update(None, "foreign_keys", true).unwrap();
        super::super::schema::migrate(&mut db).unwrap();
        db
    }

    fn add(db: &Connection) -> (i64, Job) {
        let job = NewJob {
            table: "t".to_owned(),
            spec: serde_json::json!({}),
            spec_digest: String::new(),
            priority: 0,
            alias: None,
            idempotency: None,
        };
        insert(db, &job).unwrap()
    }

    #[test]
    fn old_jobs_that_ended_go_with_their_events_and_numbers_are_not_used_again() {
        let db = database();
        let ids: Vec<String> = (0..6).map(|_| add(&db).1.id).collect();
        for id in &ids[..5] {
            cancel(&db, id).unwrap();
        }
        forget_old(&db, 2).unwrap();
        let there = |id: &String| find(&db, id).is_ok();
        assert_eq!(ids.iter().map(there).collect::<Vec<_>>(), [false, false, false, true, true, true]);
        let events: i64 = db.query_row("SELECT count(*) FROM events", [], |row| row.get(0)).unwrap();
        assert_eq!(events, 2 + 2 + 1, "of the jobs that are left");
        forget_old(&db, 0).unwrap();
        assert!(there(&ids[5]), "it waits still");
        db.execute("DELETE FROM jobs", []).unwrap();
        assert!(add(&db).1.id > ids[5]);
    }

    #[test]
    fn events_of_a_long_job_are_bounded_and_their_ids_grow_on() {
        let db = database();
        let (seq, job) = add(&db);
        for i in 0..3000 {
            let shard = ShardReport { progress: f64::from(i) / 3000.0, ..ShardReport::default() };
            events::add_report(&db, seq, &shard, i.into()).unwrap();
            events::add_log(&db, seq, &i.to_string(), i.into()).unwrap();
        }
        events::add_state(&db, seq, &job, 3000).unwrap();
        let kept = events::after(&db, seq, 0).unwrap();
        let count = |kind| kept.iter().filter(|event| event.kind == kind).count();
        assert_eq!(count(EventKind::State), 2, "all of them");
        assert_eq!((count(EventKind::Progress), count(EventKind::Log)), (200, 2000));
        assert_eq!(kept.last().unwrap().id, 2 + 6000);
        assert!(kept.is_sorted_by(|a, b| a.id < b.id));
    }
}
