//! One job, from claim to end.

use std::sync::Arc;
use std::sync::PoisonError;
use std::time::Duration;

use ltc_fit::{Cost, FitSpec};
use ltc_store::{Claim, Outcome, StoreError};
use ltc_table::TableVersion;
use tokio::sync::{oneshot, watch};
use tokio::time::{Instant, MissedTickBehavior, interval, sleep};

use crate::checkpoints::{Checkpoints, clear};
use crate::fitting::{self, NoTable};
use crate::live::Live;
use crate::metrics::{Rate, add};
use crate::refits::Shared;
use crate::worker::asked_to_stop;

/// How often a running job is reported on.
const REPORT_EVERY: Duration = Duration::from_millis(500);

/// Why work on a job ends without a result.
enum End {
    /// Somebody else has it now.
    Lost,
    /// The process stops.
    Released,
    /// It was asked for.
    Cancelled,
    /// It cannot succeed.
    Failed(String),
}

/// A worker with a job in its hands.
pub(crate) struct Run<'a> {
    pub(crate) shared: &'a Shared,
    pub(crate) worker: &'a str,
    pub(crate) claim: &'a Claim,
    /// Turns true when the process stops.
    pub(crate) stop: watch::Receiver<bool>,
}

impl Run<'_> {
    /// Does the job and ends the claim.
    pub(crate) async fn work_off(self) {
        let id = &self.claim.job.id;
        let outcome = match self.work().await {
            Ok(outcome) => outcome,
            Err(End::Released) => Outcome::Released,
            Err(End::Cancelled) => Outcome::Cancelled,
            Err(End::Failed(error)) => Outcome::Failed { error },
            Err(End::Lost) => {
                tracing::warn!(job = %id, "another worker has taken the job over");
                return;
            }
        };
        tracing::info!(job = %id, attempt = self.claim.attempt, ?outcome, "refit");
        let released = outcome == Outcome::Released;
        let finished = self.insist(|run| run.shared.jobs.finish(run.claim, outcome.clone())).await;
        if finished.is_err() || released {
            return; // the next attempt goes on from the checkpoints
        }
        let counts = &self.shared.counts;
        match outcome {
            Outcome::Succeeded { .. } => add(&counts.succeeded, 1),
            Outcome::Failed { .. } => add(&counts.failed, 1),
            Outcome::Cancelled => add(&counts.cancelled, 1),
            Outcome::Released => {}
        }
        if let Err(error) = clear(&*self.shared.blobs, id).await {
            tracing::warn!(job = %id, %error, "checkpoints are left; the next start removes them");
        }
    }

    async fn work(&self) -> Result<Outcome, End> {
        let request = &self.claim.job.request;
        if self.claim.job.cancel_requested {
            return Err(End::Cancelled);
        }
        let spec_digest = &request.spec_digest;
        let known = self.insist(|run| run.shared.metadata.version_of_spec(spec_digest)).await?;
        let version = match known {
            Some(version) => version,
            None => {
                let spec: FitSpec =
                    serde_json::from_value(request.spec.clone()).map_err(|e| End::Failed(e.to_string()))?;
                let fitted = self.fit(spec).await?;
                self.insist(|run| run.shared.keep(run.claim, &fitted)).await?
            }
        };
        let outcome = self.insist(|run| run.shared.point(run.claim, &version)).await?;
        if let Some(hook) = self.shared.published.get() {
            hook().await;
        }
        Ok(outcome)
    }

    /// Fits, and reports while that goes on.
    async fn fit(&self, spec: FitSpec) -> Result<TableVersion, End> {
        let cost = Cost::of(&spec);
        self.shared.config.allows(&spec, &cost).map_err(|e| End::Failed(e.to_string()))?;
        let live = Arc::new(Live::new(&cost, self.claim.job.progress));
        let (blobs, runtime) = (Arc::clone(&self.shared.blobs), tokio::runtime::Handle::current());
        let checkpoints = Checkpoints::new(blobs, runtime, self.claim);
        let table = fitting::start(spec, checkpoints, Arc::clone(&live), &self.shared.config);
        let table = table.map_err(|e| self.why(e, None))?;
        let result = self.watch(table, &live).await;
        self.forget_figures();
        let fitted = result?;
        // The last report, and the last chance to learn that the job is somebody else's.
        self.report(&live).await?;
        Ok(fitted)
    }

    /// Waits for the table.
    async fn watch(
        &self,
        mut table: oneshot::Receiver<Result<TableVersion, NoTable>>,
        live: &Live,
    ) -> Result<TableVersion, End> {
        let (mut changes, mut stop) = (self.shared.jobs.watch(), self.stop.clone());
        let mut ticks = interval(REPORT_EVERY.min(self.shared.config.lease / 4));
        ticks.set_missed_tick_behavior(MissedTickBehavior::Delay);
        let (mut rate, mut last, mut end) = (Rate::default(), Instant::now(), None);
        loop {
            let asked = tokio::select! {
                result = &mut table => {
                    self.note_figures(live, &mut rate, last.elapsed());
                    let result = result.unwrap_or_else(|_| Err(NoTable::Failed("the fit went away".to_owned())));
                    return result.map_err(|e| self.why(e, end));
                }
                _ = ticks.tick() => {
                    self.note_figures(live, &mut rate, last.elapsed());
                    last = Instant::now();
                    self.report_once(live).await
                }
                Ok(()) = changes.changed() => self.wish().await,
                () = asked_to_stop(&mut stop), if end.is_none() => Some(End::Released),
            };
            if let Some(asked) = asked {
                live.stop();
                end.get_or_insert(asked);
            }
        }
    }

    /// Whether somebody asked for the job to stop.
    async fn wish(&self) -> Option<End> {
        let job = self.shared.jobs.job(&self.claim.job.id).await.ok()?;
        job.cancel_requested.then_some(End::Cancelled)
    }

    /// Shows life. A store that cannot be written to does not keep the fit from going on.
    async fn report_once(&self, live: &Live) -> Option<End> {
        let (jobs, lease) = (&self.shared.jobs, self.shared.config.lease);
        match jobs.report(self.claim, lease, live.report()).await {
            Ok(job) => job.cancel_requested.then_some(End::Cancelled),
            Err(StoreError::Conflict { .. }) => Some(End::Lost),
            Err(error) => {
                tracing::warn!(job = %self.claim.job.id, %error, "progress cannot be kept");
                None
            }
        }
    }

    async fn report(&self, live: &Live) -> Result<(), End> {
        let shard = live.report();
        let lease = self.shared.config.lease;
        let job = self.insist(|run| run.shared.jobs.report(run.claim, lease, shard.clone())).await?;
        if job.cancel_requested { Err(End::Cancelled) } else { Ok(()) }
    }

    /// Does something that the store may not be able to do just now, until it is; gives up when the process stops.
    async fn insist<'s, T, F>(&'s self, action: impl Fn(&'s Self) -> F) -> Result<T, End>
    where
        F: Future<Output = Result<T, StoreError>>,
    {
        let mut wait = Duration::from_millis(200);
        let mut stop = self.stop.clone();
        loop {
            match action(self).await {
                Ok(value) => return Ok(value),
                Err(StoreError::Conflict { .. }) => return Err(End::Lost),
                Err(error @ (StoreError::Unwritable { .. } | StoreError::Backend(_))) => {
                    tracing::warn!(job = %self.claim.job.id, %error, "trying again in {wait:?}");
                }
                Err(error) => return Err(End::Failed(error.to_string())),
            }
            tokio::select! {
                () = sleep(wait) => wait = (2 * wait).min(Duration::from_secs(30)),
                () = asked_to_stop(&mut stop) => return Err(End::Released),
            }
        }
    }

    /// Why there is no table: a fit that was stopped ends as whoever stopped it wished.
    fn why(&self, error: NoTable, end: Option<End>) -> End {
        match error {
            NoTable::Stopped => end.unwrap_or(End::Released),
            NoTable::Failed(error) => End::Failed(error),
        }
    }

    fn note_figures(&self, live: &Live, rate: &mut Rate, passed: Duration) {
        let (lobes, tv) = live.figures();
        let (new, rate) = rate.update(lobes, passed);
        add(&self.shared.counts.lobes, new);
        let mut at_work = self.shared.at_work.lock().unwrap_or_else(PoisonError::into_inner);
        at_work.insert(self.worker.to_owned(), (rate, tv));
    }

    fn forget_figures(&self) {
        self.shared.at_work.lock().unwrap_or_else(PoisonError::into_inner).remove(self.worker);
    }
}
