//! Where a running job keeps what is done: blobs, each checkpoint under a key of its own, for blobs never change.

use std::sync::{Arc, Mutex, PoisonError};

use ltc_fit::checkpoint::Store;
use ltc_store::{BlobKind, Blobs, Claim, Jobs, StoreError};
use ltc_table::TableError;
use tokio::runtime::Handle;

/// The checkpoints of one attempt at a job. Keys are `JOB.ATTEMPT.COUNT`, so that those of a later attempt count as newer
/// whatever a worker that was given up for dead still writes.
pub(crate) struct Checkpoints {
    blobs: Arc<dyn Blobs>,
    runtime: Handle,
    job: String,
    attempt: u32,
    state: Mutex<State>,
}

#[derive(Default)]
struct State {
    count: u32,
    /// Keys that the next checkpoint replaces.
    old: Vec<String>,
}

impl Checkpoints {
    /// Those of a claim; its methods are for threads outside the runtime.
    pub(crate) fn new(blobs: Arc<dyn Blobs>, runtime: Handle, claim: &Claim) -> Self {
        let (job, attempt) = (claim.job.id.clone(), claim.attempt);
        Self { blobs, runtime, job, attempt, state: Mutex::default() }
    }

    fn save_blob(&self, bytes: &[u8]) -> Result<(), StoreError> {
        let (key, old) = {
            let mut state = self.state();
            state.count += 1;
            let key = format!("{}.{:08x}.{:08x}", self.job, self.attempt, state.count);
            (key.clone(), std::mem::replace(&mut state.old, vec![key]))
        };
        self.runtime.block_on(async {
            if let Err(error) = self.blobs.put(BlobKind::Checkpoint, &key, bytes).await {
                // The old one is still the newest.
                self.state().old.extend(old);
                return Err(error);
            }
            for key in &old {
                self.blobs.delete(BlobKind::Checkpoint, key).await?;
            }
            Ok(())
        })
    }

    fn state(&self) -> std::sync::MutexGuard<'_, State> {
        // Nothing panics while it holds this lock.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Store for Checkpoints {
    fn load(&self) -> Result<Option<Vec<u8>>, TableError> {
        let found = self.runtime.block_on(async {
            let keys = keys_of(&*self.blobs, &self.job).await?;
            let newest = match keys.last() {
                Some(key) => Some(self.blobs.get(BlobKind::Checkpoint, key).await?),
                None => None,
            };
            self.state().old = keys;
            Ok(newest)
        });
        found.map_err(|e: StoreError| io(&self.job, &e))
    }

    fn save(&self, bytes: &[u8]) -> Result<(), TableError> {
        self.save_blob(bytes).map_err(|e| io(&self.job, &e))
    }

    fn clear(&self) -> Result<(), TableError> {
        self.runtime.block_on(clear(&*self.blobs, &self.job)).map_err(|e| io(&self.job, &e))
    }
}

/// Keys of a job's checkpoints, oldest first.
async fn keys_of(blobs: &dyn Blobs, job: &str) -> Result<Vec<String>, StoreError> {
    let all = blobs.list(BlobKind::Checkpoint).await?;
    let own = all.into_iter().map(|(key, _)| key).filter(|key| job_of(key) == job);
    let mut keys: Vec<String> = own.collect();
    // Numbers have fixed lengths, so that their order is that of the text.
    keys.sort();
    Ok(keys)
}

fn job_of(key: &str) -> &str {
    key.split('.').next().unwrap_or_default()
}

/// Removes a job's checkpoints.
pub(crate) async fn clear(blobs: &dyn Blobs, job: &str) -> Result<(), StoreError> {
    for key in keys_of(blobs, job).await? {
        blobs.delete(BlobKind::Checkpoint, &key).await?;
    }
    Ok(())
}

/// Removes the checkpoints of jobs that have ended: a kill between a job's end and its clearing leaves them.
pub(crate) async fn sweep(blobs: &dyn Blobs, jobs: &dyn Jobs) -> Result<(), StoreError> {
    for (key, _) in blobs.list(BlobKind::Checkpoint).await? {
        let over = match jobs.job(job_of(&key)).await {
            Ok(job) => job.state.is_final(),
            Err(StoreError::NotFound { .. }) => true,
            Err(error) => return Err(error),
        };
        if over {
            blobs.delete(BlobKind::Checkpoint, &key).await?;
        }
    }
    Ok(())
}

fn io(job: &str, error: &StoreError) -> TableError {
    TableError::Io { path: format!("checkpoint of {job}"), source: std::io::Error::other(error.to_string()) }
}
