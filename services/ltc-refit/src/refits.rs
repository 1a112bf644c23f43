//! Taking requests in.

use std::collections::HashMap;
use std::pin::Pin;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use ltc_store::{Blobs, Job, Jobs, Metadata, NewJob, StoreError};
use serde_json::Value;

use crate::metrics::{Counts, get};
use crate::worker::Workers;
use crate::{Checked, RefitConfig, RefitError, RefitMetrics, check};

/// What a client asks for.
#[derive(Clone, Debug, PartialEq)]
pub struct Ask {
    /// The specification, as for [`check`].
    pub spec: Value,
    /// Higher first.
    pub priority: i32,
    /// The alias to move to the result, unless that is worse than what the alias points at.
    pub alias: Option<String>,
    /// Moves the alias even then.
    pub force: bool,
    /// Who asks (a token's id), and the key under which the same request is the same job.
    pub idempotency: Option<(String, String)>,
}

impl Ask {
    /// For a specification alone.
    pub fn new(spec: Value) -> Self {
        Self { spec, priority: 0, alias: None, force: false, idempotency: None }
    }
}

/// Something to do whenever a version was published.
type Hook = Box<dyn Fn() -> Pin<Box<dyn Future<Output = ()> + Send>> + Send + Sync>;

/// Takes requests in and runs them.
#[derive(Clone)]
pub struct Refits(pub(crate) Arc<Shared>);

/// What requests and workers share.
pub(crate) struct Shared {
    pub(crate) metadata: Arc<dyn Metadata>,
    pub(crate) blobs: Arc<dyn Blobs>,
    pub(crate) jobs: Arc<dyn Jobs>,
    pub(crate) config: RefitConfig,
    pub(crate) counts: Counts,
    pub(crate) published: OnceLock<Hook>,
    /// Of each worker that fits: lobes a second, and the mean total variation.
    pub(crate) at_work: Mutex<HashMap<String, (f64, Option<f64>)>>,
}

impl Refits {
    /// On these interfaces. Nothing runs before [`Refits::start`].
    pub fn new(
        metadata: Arc<dyn Metadata>,
        blobs: Arc<dyn Blobs>,
        jobs: Arc<dyn Jobs>,
        config: RefitConfig,
    ) -> Self {
        let (counts, published, at_work) = (Counts::default(), OnceLock::new(), Mutex::default());
        Self(Arc::new(Shared { metadata, blobs, jobs, config, counts, published, at_work }))
    }

    /// Does something whenever a refit has published a version and moved its alias, before the job is said to have succeeded:
    /// whoever hears of that finds the version. The first call counts.
    pub fn on_published<F>(&self, hook: impl Fn() -> F + Send + Sync + 'static)
    where
        F: Future<Output = ()> + Send + 'static,
    {
        self.0.published.get_or_init(|| Box::new(move || Box::pin(hook())));
    }

    /// How refits are run.
    pub fn config(&self) -> &RefitConfig {
        &self.0.config
    }

    /// Takes a request in; the job, and whether it is new. Where the version is there already and no alias is to move, the
    /// job is done from the start.
    ///
    /// # Errors
    /// [`RefitError::Spec`], [`RefitError::TooLarge`]; [`StoreError::Full`] with a full queue; [`StoreError::Conflict`] where
    /// the idempotency key was used with another request.
    pub async fn request(&self, ask: Ask) -> Result<(Job, bool), RefitError> {
        let Checked { spec, digest, cost } = check(&ask.spec, &self.0.config.limits)?;
        self.0.config.allows(&spec, &cost)?;
        let json = serde_json::to_value(&spec)
            .map_err(|e| RefitError::Spec { field: String::new(), reason: e.to_string() })?;
        let job = NewJob {
            table: spec.name,
            spec: json,
            spec_digest: digest,
            priority: ask.priority,
            alias: ask.alias.map(|alias| (alias, ask.force)),
            idempotency: ask.idempotency,
        };
        let known = self.0.metadata.version_of_spec(&job.spec_digest).await?;
        Ok(match known.filter(|_| job.alias.is_none()) {
            Some(version) => {
                let note = format!("version {} was made from this specification", version.number);
                self.0.jobs.enqueue_done(job, version.number, &note).await?
            }
            None => self.0.jobs.enqueue(job, self.0.config.queue).await?,
        })
    }

    /// Starts the workers on the runtime that this is called on.
    pub fn start(&self) -> Workers {
        Workers::start(&self.0)
    }

    /// The figures at present.
    ///
    /// # Errors
    /// As [`Jobs::depth`].
    pub async fn metrics(&self) -> Result<RefitMetrics, StoreError> {
        let (queued, running) = self.0.jobs.depth().await?;
        let counts = &self.0.counts;
        let at_work = self.0.at_work.lock().unwrap_or_else(PoisonError::into_inner);
        // The sum of nothing is −0.
        let lobes_per_second = 0.0 + at_work.values().map(|(rate, _)| rate).sum::<f64>();
        Ok(RefitMetrics {
            queued,
            running,
            lobes_total: get(&counts.lobes),
            lobes_per_second,
            tv: at_work.values().find_map(|(_, tv)| *tv),
            succeeded_total: get(&counts.succeeded),
            failed_total: get(&counts.failed),
            cancelled_total: get(&counts.cancelled),
        })
    }
}
