//! Jobs in memory.

use std::time::{Duration, Instant};

use async_trait::async_trait;
use serde_json::{Value, json};

use super::{MemoryStore, State};
use crate::jobs::{barren, check_same, ended, lost, new_id, no_job, progress_event, state_event};
use crate::{
    Claim, Event, EventKind, Job, JobState, Jobs, MAX_BARREN, NewJob, Outcome, ShardReport, StoreError, clock,
};

/// A job with what only the store knows of it.
pub(super) struct Kept {
    job: Job,
    events: Vec<Event>,
    holder: Option<(String, Instant)>,
    barren: u32,
}

impl Kept {
    fn event(&mut self, kind: EventKind, data: Value) {
        let id = 1 + self.events.len() as u64;
        self.job.updated = clock::rfc3339(clock::now());
        self.events.push(Event { id, kind, at: self.job.updated.clone(), data });
    }

    fn state(&mut self, state: JobState) -> Job {
        self.job.state = state;
        self.event(EventKind::State, state_event(&self.job));
        self.job.clone()
    }

    /// Whether a worker may take it.
    fn is_open_to(&self, worker: &str) -> bool {
        let over = |(holder, until): &(String, Instant)| holder == worker || *until <= Instant::now();
        match self.job.state {
            JobState::Queued => true,
            JobState::Running => self.holder.as_ref().is_none_or(over),
            _ => false,
        }
    }
}

impl State {
    fn job(&mut self, id: &str) -> Result<&mut Kept, StoreError> {
        self.jobs.iter_mut().find(|kept| kept.job.id == id).ok_or_else(|| no_job(id))
    }

    /// The job of the same idempotency key.
    fn same_key(&self, job: &NewJob) -> Result<Option<Job>, StoreError> {
        let same = |kept: &&Kept| kept.job.request.idempotency == job.idempotency;
        let there = self.jobs.iter().find(same).filter(|_| job.idempotency.is_some());
        let Some(there) = there else { return Ok(None) };
        check_same(&there.job.request, job)?;
        Ok(Some(there.job.clone()))
    }

    /// A new job, queued.
    fn insert(&mut self, request: NewJob) -> Result<&mut Kept, StoreError> {
        let now = clock::rfc3339(clock::now());
        let job = Job {
            id: new_id(1 + self.jobs.len() as u64)?,
            request,
            state: JobState::Queued,
            progress: 0.0,
            seconds_left: None,
            tv: None,
            version: None,
            error: None,
            attempts: 0,
            created: now.clone(),
            updated: now,
            cancel_requested: false,
        };
        let mut kept = Kept { job, events: Vec::new(), holder: None, barren: 0 };
        kept.state(JobState::Queued);
        Ok(self.jobs.push_mut(kept))
    }

    fn held(&mut self, claim: &Claim) -> Result<&mut Kept, StoreError> {
        let held = |kept: &Kept| kept.job.state == JobState::Running && kept.job.attempts == claim.attempt;
        let kept = self.job(&claim.job.id).map_err(|_| lost(&claim.job.id))?;
        if held(kept) { Ok(kept) } else { Err(lost(&claim.job.id)) }
    }

    fn count(&self, state: JobState) -> u64 {
        self.jobs.iter().filter(|kept| kept.job.state == state).count() as u64
    }
}

impl MemoryStore {
    fn changed(&self) {
        self.changes.send_modify(|n| *n += 1);
    }
}

#[async_trait]
impl Jobs for MemoryStore {
    async fn enqueue(&self, job: NewJob, limit: u64) -> Result<(Job, bool), StoreError> {
        let mut state = self.state();
        if let Some(there) = state.same_key(&job)? {
            return Ok((there, false));
        }
        if state.count(JobState::Queued) >= limit {
            return Err(StoreError::Full { what: "the queue", limit });
        }
        let job = state.insert(job)?.job.clone();
        self.changed();
        Ok((job, true))
    }

    async fn enqueue_done(&self, job: NewJob, version: u32, note: &str) -> Result<(Job, bool), StoreError> {
        let mut state = self.state();
        if let Some(there) = state.same_key(&job)? {
            return Ok((there, false));
        }
        let kept = state.insert(job)?;
        (kept.job.version, kept.job.progress) = (Some(version), 1.0);
        kept.event(EventKind::Log, json!({ "line": note }));
        let job = kept.state(JobState::Succeeded);
        self.changed();
        Ok((job, true))
    }

    async fn claim(&self, worker: &str, lease: Duration) -> Result<Option<Claim>, StoreError> {
        let mut state = self.state();
        loop {
            let order = |kept: &&mut Kept| {
                (kept.job.state != JobState::Running, -i64::from(kept.job.request.priority))
            };
            // The first of equals is the oldest.
            let next = state.jobs.iter_mut().filter(|kept| kept.is_open_to(worker)).min_by_key(order);
            let Some(kept) = next else { return Ok(None) };
            self.changed();
            if kept.barren >= MAX_BARREN {
                kept.job.error = Some(barren());
                kept.state(JobState::Failed);
                continue;
            }
            kept.barren += 1;
            kept.job.attempts += 1;
            kept.holder = Some((worker.to_owned(), Instant::now() + lease));
            let job = kept.state(JobState::Running);
            return Ok(Some(Claim { attempt: job.attempts, job }));
        }
    }

    async fn report(&self, claim: &Claim, lease: Duration, shard: ShardReport) -> Result<Job, StoreError> {
        let mut state = self.state();
        let kept = state.held(claim)?;
        let before = kept.job.progress;
        let progress = if shard.progress.is_finite() { shard.progress.clamp(0.0, 1.0) } else { before };
        if progress > before {
            kept.barren = 0;
        }
        kept.job.progress = progress;
        kept.job.seconds_left = shard.seconds_left;
        kept.job.tv = shard.tv.or(kept.job.tv);
        if let Some((_, until)) = &mut kept.holder {
            *until = Instant::now() + lease;
        }
        let shard = ShardReport { progress, ..shard };
        kept.event(EventKind::Progress, progress_event(&shard));
        if let Some(line) = shard.log {
            kept.event(EventKind::Log, json!({ "line": line }));
        }
        let job = kept.job.clone();
        self.changed();
        Ok(job)
    }

    async fn finish(&self, claim: &Claim, outcome: Outcome) -> Result<Job, StoreError> {
        let mut state = self.state();
        let kept = state.held(claim)?;
        if outcome == Outcome::Released {
            kept.barren = kept.barren.saturating_sub(1);
        }
        let (mut next, version, error, note) = ended(outcome);
        if next == JobState::Queued && kept.job.cancel_requested {
            next = JobState::Cancelled;
        }
        if next == JobState::Succeeded {
            kept.job.progress = 1.0;
        }
        (kept.job.version, kept.job.error, kept.job.seconds_left) = (version, error, None);
        kept.holder = None;
        if let Some(note) = note {
            kept.event(EventKind::Log, json!({ "line": note }));
        }
        let job = kept.state(next);
        self.changed();
        Ok(job)
    }

    async fn cancel(&self, id: &str) -> Result<Job, StoreError> {
        let mut state = self.state();
        let kept = state.job(id)?;
        let now = kept.job.state;
        let next = match now {
            JobState::Cancelled => return Ok(kept.job.clone()),
            JobState::Queued => JobState::Cancelled,
            JobState::Running if kept.job.cancel_requested => return Ok(kept.job.clone()),
            JobState::Running => JobState::Running,
            JobState::Succeeded | JobState::Failed => {
                return Err(StoreError::Conflict { reason: format!("the refit {id} has ended already") });
            }
        };
        kept.job.cancel_requested = true;
        let job = kept.state(next);
        self.changed();
        Ok(job)
    }

    async fn job(&self, id: &str) -> Result<Job, StoreError> {
        self.state().job(id).map(|kept| kept.job.clone())
    }

    async fn jobs(&self, limit: u32) -> Result<Vec<Job>, StoreError> {
        Ok(self.state().jobs.iter().rev().take(limit as usize).map(|kept| kept.job.clone()).collect())
    }

    async fn events(&self, id: &str, after: u64) -> Result<Vec<Event>, StoreError> {
        let mut state = self.state();
        Ok(state.job(id)?.events.iter().filter(|event| event.id > after).cloned().collect())
    }

    fn watch(&self) -> tokio::sync::watch::Receiver<u64> {
        self.changes.subscribe()
    }

    async fn depth(&self) -> Result<(u64, u64), StoreError> {
        let state = self.state();
        Ok((state.count(JobState::Queued), state.count(JobState::Running)))
    }
}
