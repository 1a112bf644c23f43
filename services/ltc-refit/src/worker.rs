//! Workers that take jobs for as long as the process lives.

use std::sync::Arc;
use std::time::Duration;

use ltc_store::{Claim, StoreError};
use tokio::sync::watch;
use tokio::task::JoinSet;
use tokio::time::sleep;

use crate::checkpoints::sweep;
use crate::refits::Shared;
use crate::run::Run;

/// How often a worker looks for jobs that it was not told of: those whose worker died elsewhere.
const LOOK_EVERY: Duration = Duration::from_secs(5);

/// The workers of this process. Dropped, they end with the runtime and their jobs are taken up at the next start.
pub struct Workers {
    stop: watch::Sender<bool>,
    tasks: JoinSet<()>,
}

impl Workers {
    pub(crate) fn start(shared: &Arc<Shared>) -> Self {
        let (stop, stopped) = watch::channel(false);
        let mut tasks = JoinSet::new();
        for i in 0..shared.config.workers {
            let (shared, stop) = (Arc::clone(shared), stopped.clone());
            tasks.spawn(async move {
                if i == 0
                    && let Err(error) = sweep(&*shared.blobs, &*shared.jobs).await
                {
                    tracing::warn!(%error, "old checkpoints cannot be removed");
                }
                work(&shared, &format!("embedded-{i}"), stop).await;
            });
        }
        Self { stop, tasks }
    }

    /// Stops taking jobs, keeps the state of those that run, and puts them back into the queue.
    pub async fn stop(mut self) {
        self.stop.send_replace(true);
        while self.tasks.join_next().await.is_some() {}
    }
}

async fn work(shared: &Shared, worker: &str, mut stop: watch::Receiver<bool>) {
    let mut changes = shared.jobs.watch();
    while !*stop.borrow() {
        changes.borrow_and_update();
        match shared.jobs.claim(worker, shared.config.lease).await {
            Ok(Some(claim)) => run(shared, worker, &claim, &stop).await,
            Ok(None) => wait(&mut changes, &mut stop).await,
            Err(error) => {
                tell(&error);
                tokio::select! {
                    () = sleep(LOOK_EVERY) => {}
                    () = asked_to_stop(&mut stop) => {}
                }
            }
        }
    }
}

async fn run(shared: &Shared, worker: &str, claim: &Claim, stop: &watch::Receiver<bool>) {
    Run { shared, worker, claim, stop: stop.clone() }.work_off().await;
}

/// Waits until the process stops.
pub(crate) async fn asked_to_stop(stop: &mut watch::Receiver<bool>) {
    // An error says that whoever could ask is gone.
    let _ = stop.wait_for(|stop| *stop).await;
}

async fn wait(changes: &mut watch::Receiver<u64>, stop: &mut watch::Receiver<bool>) {
    tokio::select! {
        _ = changes.changed() => {}
        () = sleep(LOOK_EVERY) => {}
        () = asked_to_stop(stop) => {}
    }
}

fn tell(error: &StoreError) {
    tracing::warn!(%error, "no refit can be taken up");
}
