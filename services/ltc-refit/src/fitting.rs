//! The fit itself, on threads of its own.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::time::SystemTime;

use ltc_fit::checkpoint::{self, Checkpoints as Kept};
use ltc_fit::{FitError, FitSpec, Plan};
use ltc_table::TableVersion;
use tokio::sync::oneshot;

use crate::RefitConfig;
use crate::checkpoints::Checkpoints;
use crate::live::Live;
use crate::priority;

/// Why there is no table.
#[derive(Debug)]
pub(crate) enum NoTable {
    /// The fit was asked to stop.
    Stopped,
    /// It cannot succeed.
    Failed(String),
}

/// Starts a fit; the table comes through the channel.
pub(crate) fn start(
    spec: FitSpec,
    checkpoints: Checkpoints,
    live: Arc<Live>,
    config: &RefitConfig,
) -> Result<oneshot::Receiver<Result<TableVersion, NoTable>>, NoTable> {
    let (sender, receiver) = oneshot::channel();
    let config = config.clone();
    let work = move || {
        priority::lower();
        let fitted = catch_unwind(AssertUnwindSafe(|| fit(spec, &checkpoints, &live, &config)));
        let result = fitted
            .unwrap_or_else(|_| Err(NoTable::Failed("the fit panicked; the log says where".to_owned())));
        // Nobody waits any more once the runtime is gone.
        let _ = sender.send(result);
    };
    let thread = std::thread::Builder::new().name("refit".to_owned()).spawn(work);
    thread.map(|_| receiver).map_err(|e| NoTable::Failed(format!("cannot start a thread: {e}")))
}

fn fit(
    spec: FitSpec,
    checkpoints: &Checkpoints,
    live: &Live,
    config: &RefitConfig,
) -> Result<TableVersion, NoTable> {
    let plan = Plan::new(spec)?;
    live.plan(&plan);
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(config.threads)
        .thread_name(|i| format!("refit-{i}"))
        .start_handler(|_| priority::lower())
        .build()
        .map_err(|e| NoTable::Failed(format!("cannot start threads: {e}")))?;
    let notice = |notice: checkpoint::Notice| live.say(notice.to_string());
    let fitted = pool.install(|| {
        let kept = Kept { store: checkpoints, program: &config.program, every: config.shard };
        checkpoint::fit(&plan, &kept, &|progress| live.observe(&progress), &notice)
    })?;
    let created = humantime::format_rfc3339_seconds(SystemTime::now()).to_string();
    // The store gives the number out.
    Ok(ltc_fit::publish(plan.spec(), &fitted.table, fitted.errors, 1, created)?)
}

impl From<FitError> for NoTable {
    fn from(error: FitError) -> Self {
        match error {
            FitError::Stopped => Self::Stopped,
            other => Self::Failed(other.to_string()),
        }
    }
}
