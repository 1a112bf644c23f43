//! Refits that outlive the process.

use std::time::Duration;

use async_trait::async_trait;
use serde::{Deserialize, Serialize};

use crate::StoreError;

/// Where a job is in its life.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum JobState {
    /// Waits for a worker.
    Queued,
    /// A worker has it.
    Running,
    /// Done; it has a version.
    Succeeded,
    /// Gave up; it has an error.
    Failed,
    /// Somebody asked it to stop.
    Cancelled,
}

impl JobState {
    /// Whether it stays as it is.
    pub fn is_final(self) -> bool {
        matches!(self, Self::Succeeded | Self::Failed | Self::Cancelled)
    }
}

/// A job to be done.
#[derive(Clone, Debug, PartialEq)]
pub struct NewJob {
    /// Name of the table.
    pub table: String,
    /// The fit specification, JSON.
    pub spec: serde_json::Value,
    /// Digest of the specification.
    pub spec_digest: String,
    /// Higher first; equal ones in the order they came.
    pub priority: i32,
    /// The alias to move to the result, and whether even to one that is worse than what it points at now.
    pub alias: Option<(String, bool)>,
    /// Who asked (a token's id), and the key under which the same request is the same job.
    pub idempotency: Option<(String, String)>,
}

/// A job.
#[derive(Clone, Debug, PartialEq)]
pub struct Job {
    /// Its id: 32 hexadecimal digits, in the order of creation.
    pub id: String,
    /// What was asked.
    pub request: NewJob,
    /// Where it is.
    pub state: JobState,
    /// Done, 0 to 1.
    pub progress: f64,
    /// Seconds left, where the worker knows.
    pub seconds_left: Option<f64>,
    /// Mean total variation at present, where the stage knows it.
    pub tv: Option<f64>,
    /// The version it led to.
    pub version: Option<u32>,
    /// Why it failed.
    pub error: Option<String>,
    /// How often a worker took it up.
    pub attempts: u32,
    /// When it was asked for, RFC 3339.
    pub created: String,
    /// When it last changed, RFC 3339.
    pub updated: String,
    /// Whether somebody asked a running job to stop.
    pub cancel_requested: bool,
}

/// What an event says.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EventKind {
    /// The state changed.
    State,
    /// Progress, time left, current error.
    Progress,
    /// A line of the log.
    Log,
}

/// Something that happened to a job.
#[derive(Clone, Debug, PartialEq)]
pub struct Event {
    /// Growing within a job; what a client resumes after.
    pub id: u64,
    /// What it says.
    pub kind: EventKind,
    /// When, RFC 3339.
    pub at: String,
    /// The content, JSON.
    pub data: serde_json::Value,
}

/// A job in a worker's hands. Whoever holds an older claim of it can write nothing any more.
#[derive(Clone, Debug, PartialEq)]
pub struct Claim {
    /// The job.
    pub job: Job,
    /// Number of the attempt; a fence against workers that were given up for dead.
    pub attempt: u32,
}

/// What a worker reports at the end of each shard.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ShardReport {
    /// Done, 0 to 1.
    pub progress: f64,
    /// Seconds left, where known.
    pub seconds_left: Option<f64>,
    /// Mean total variation, where known.
    pub tv: Option<f64>,
    /// A line for the log.
    pub log: Option<String>,
}

/// How a job ended.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// With this version.
    Succeeded {
        /// Its number.
        version: u32,
        /// A line for the log: whether the alias moved, and why not.
        note: String,
    },
    /// It cannot succeed.
    Failed {
        /// Why.
        error: String,
    },
    /// It was asked to stop, and did.
    Cancelled,
    /// The worker stops before the job is done: back into the queue.
    Released,
}

/// Attempts without progress after which a job is given up: it kills whoever takes it.
pub const MAX_BARREN: u32 = 100;

/// A durable queue of jobs. Every method is one transaction; what it acknowledged survives a kill.
///
/// Delivery is at least once: a worker that shows no life for the lease is taken for dead and its job is claimed anew. Work is
/// deterministic and kept by digest, so that doing it twice gives the same; the attempt number fences off the first worker.
#[async_trait]
pub trait Jobs: Send + Sync {
    /// Puts a job into the queue, or finds the one of the same idempotency key; the second of the pair says whether it is new.
    ///
    /// # Errors
    /// [`StoreError::Full`] when the queue is at `limit`; [`StoreError::Conflict`] when the key was used with another
    /// request.
    async fn enqueue(&self, job: NewJob, limit: u64) -> Result<(Job, bool), StoreError>;

    /// Writes down a job whose result is there already: it is born succeeded, with `note` in its log. A job of the same
    /// idempotency key is found as by [`Jobs::enqueue`], whatever its state.
    ///
    /// # Errors
    /// [`StoreError::Conflict`] when the key was used with another request.
    async fn enqueue_done(&self, job: NewJob, version: u32, note: &str) -> Result<(Job, bool), StoreError>;

    /// The next job for a worker: one that it has already (no two running workers have the same name, so it was killed over
    /// it), a running one whose lease is over, or the first queued one. A job that [`MAX_BARREN`] attempts in a row were
    /// lost over, without any progress, fails instead.
    ///
    /// # Errors
    /// [`StoreError::Backend`].
    async fn claim(&self, worker: &str, lease: Duration) -> Result<Option<Claim>, StoreError>;

    /// Shows life, and tells what is done. The job as it is now: the worker stops if a cancellation was asked for.
    ///
    /// # Errors
    /// [`StoreError::Conflict`] when the job is no longer this worker's.
    async fn report(&self, claim: &Claim, lease: Duration, shard: ShardReport) -> Result<Job, StoreError>;

    /// Ends a claim.
    ///
    /// # Errors
    /// [`StoreError::Conflict`] when the job is no longer this worker's.
    async fn finish(&self, claim: &Claim, outcome: Outcome) -> Result<Job, StoreError>;

    /// Asks for a job to stop: a queued one is cancelled at once, a running one at its next shard.
    ///
    /// # Errors
    /// [`StoreError::NotFound`]; [`StoreError::Conflict`] for one that has ended otherwise.
    async fn cancel(&self, id: &str) -> Result<Job, StoreError>;

    /// A job.
    ///
    /// # Errors
    /// [`StoreError::NotFound`].
    async fn job(&self, id: &str) -> Result<Job, StoreError>;

    /// The newest jobs, newest first.
    ///
    /// # Errors
    /// [`StoreError::Backend`].
    async fn jobs(&self, limit: u32) -> Result<Vec<Job>, StoreError>;

    /// A job's events after the one of that id, oldest first.
    ///
    /// # Errors
    /// [`StoreError::NotFound`] without such a job.
    async fn events(&self, id: &str, after: u64) -> Result<Vec<Event>, StoreError>;

    /// A number that grows with every change to a job that this process knows of: whoever waits for one looks again when
    /// it moves. A store that processes share may learn of others' changes late or never, so look now and then all the same.
    fn watch(&self) -> tokio::sync::watch::Receiver<u64>;

    /// Jobs that wait, and jobs that run.
    ///
    /// # Errors
    /// [`StoreError::Backend`].
    async fn depth(&self) -> Result<(u64, u64), StoreError>;
}

/// What an event of the kind [`EventKind::State`] says.
pub(crate) fn state_event(job: &Job) -> serde_json::Value {
    serde_json::json!({
        "state": job.state,
        "version": job.version,
        "error": job.error,
        "attempt": job.attempts,
        "cancel_requested": job.cancel_requested,
    })
}

/// What an event of the kind [`EventKind::Progress`] says.
pub(crate) fn progress_event(shard: &ShardReport) -> serde_json::Value {
    let ShardReport { progress, seconds_left, tv, .. } = shard;
    serde_json::json!({ "progress": progress, "seconds_left": seconds_left, "tv": tv })
}

/// A new id: the number of the job in the order of creation, and 64 random bits, so that ids cannot be guessed.
///
/// # Errors
/// [`StoreError::Backend`] where the system has no random numbers.
pub(crate) fn new_id(number: u64) -> Result<String, StoreError> {
    let random = getrandom::u64().map_err(|e| StoreError::Backend(e.to_string()))?;
    Ok(format!("{number:016x}{random:016x}"))
}

/// # Errors
/// [`StoreError::Conflict`] where the same idempotency key came with another request.
pub(crate) fn check_same(there: &NewJob, asked: &NewJob) -> Result<(), StoreError> {
    if there == asked {
        return Ok(());
    }
    Err(StoreError::Conflict { reason: "the idempotency key was used with another request".to_owned() })
}

/// That a claim is one no more.
pub(crate) fn lost(id: &str) -> StoreError {
    StoreError::Conflict { reason: format!("the job {id} is no longer this worker's") }
}

/// That there is no such job.
pub(crate) fn no_job(id: &str) -> StoreError {
    StoreError::NotFound { what: "refit", name: id.chars().take(64).collect() }
}

/// The state and the version or error that an outcome leads to, and its line for the log.
pub(crate) fn ended(outcome: Outcome) -> (JobState, Option<u32>, Option<String>, Option<String>) {
    match outcome {
        Outcome::Succeeded { version, note } => (JobState::Succeeded, Some(version), None, Some(note)),
        Outcome::Failed { error } => (JobState::Failed, None, Some(error), None),
        Outcome::Cancelled => (JobState::Cancelled, None, None, None),
        Outcome::Released => (JobState::Queued, None, None, None),
    }
}

/// Why a job that only ever kills its workers is given up.
pub(crate) fn barren() -> String {
    format!(
        "given up: {MAX_BARREN} attempts in a row ended without progress; the log of the service may say why"
    )
}
