//! What the handlers share.

use std::net::IpAddr;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, OnceLock, PoisonError, RwLock};
use std::time::{Duration, Instant};

use axum::body::Bytes;
use ltc_refit::Refits;
use ltc_store::{BlobKind, StoreError};
use ltc_table::{Manifest, TableVersion};
use tokio::sync::{Semaphore, watch};

use crate::answers::Answers;
use crate::auth::Tokens;
use crate::cache::Cache;
use crate::compute::Compute;
use crate::derived::Derived;
use crate::etag::ETag;
use crate::index::Index;
use crate::metrics::Metrics;
use crate::rates::{Client, Rates};
use crate::representation::{Tagged, compressed};
use crate::settings::{Limits, Settings};
use crate::{ApiError, ShaderSource, Stores, Variant};

/// Stores, settings, what is in memory of the stores, and counters. Clones share everything.
#[derive(Clone, Debug)]
pub struct AppState(Arc<Shared>);

struct Shared {
    settings: Settings,
    stores: Stores,
    index: RwLock<Arc<Index>>,
    /// Grows when the index changes.
    revision: AtomicU64,
    refreshing: tokio::sync::Mutex<()>,
    /// Decoded tables by name and number.
    tables: Cache<(String, u32), Arc<TableVersion>>,
    derived: Arc<Derived>,
    answers: Answers,
    compute: Compute,
    /// For work of seconds: uploads and differences, one at a time.
    long: Compute,
    refits: Refits,
    tokens: Tokens,
    rates: Rates,
    metrics: Metrics,
    shaders: OnceLock<Arc<dyn ShaderSource>>,
    requests: Arc<Semaphore>,
    streams: Arc<Semaphore>,
    stopping: watch::Sender<bool>,
    started: Instant,
}

impl std::fmt::Debug for Shared {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Shared").field("settings", &self.settings).finish_non_exhaustive()
    }
}

impl AppState {
    /// A state over these stores.
    ///
    /// # Errors
    /// When the store cannot be read.
    pub async fn new(stores: Stores, settings: Settings) -> Result<Self, StoreError> {
        let index = Index::read(&stores, &Index::default()).await?;
        let limits = &settings.limits;
        Ok(Self(Arc::new(Shared {
            index: RwLock::new(Arc::new(index)),
            revision: AtomicU64::new(1),
            refreshing: tokio::sync::Mutex::default(),
            tables: Cache::new(limits.cache_bytes),
            derived: Derived::new(Arc::clone(&stores.blobs), limits.cache_bytes),
            answers: Answers::new(limits.cache_bytes),
            compute: Compute::on_every_processor(limits.waiting_computations),
            long: Compute::new(1, limits.waiting_computations),
            refits: Refits::new(
                Arc::clone(&stores.metadata),
                Arc::clone(&stores.blobs),
                Arc::clone(&stores.jobs),
                settings.refits.config(),
            ),
            tokens: Tokens::default(),
            rates: Rates::new(limits),
            metrics: Metrics::default(),
            shaders: OnceLock::new(),
            requests: Arc::new(Semaphore::new(limits.concurrent_requests)),
            streams: Arc::new(Semaphore::new(limits.event_streams)),
            stopping: watch::Sender::new(false),
            started: Instant::now(),
            stores,
            settings,
        })))
    }

    /// Names of the tables that are served.
    pub fn table_names(&self) -> Vec<String> {
        self.index().names().map(str::to_owned).collect()
    }

    /// Serves shaders from this source; the first one given stays. Without one there are none.
    pub fn serve_shaders(&self, source: Arc<dyn ShaderSource>) {
        let _ = self.0.shaders.set(source);
    }

    pub(crate) fn shaders(&self) -> Option<Arc<dyn ShaderSource>> {
        self.0.shaders.get().cloned()
    }

    pub(crate) fn settings(&self) -> &Settings {
        &self.0.settings
    }

    pub(crate) fn limits(&self) -> &Limits {
        &self.0.settings.limits
    }

    pub(crate) fn stores(&self) -> &Stores {
        &self.0.stores
    }

    pub(crate) fn compute(&self) -> &Compute {
        &self.0.compute
    }

    pub(crate) fn long(&self) -> &Compute {
        &self.0.long
    }

    pub(crate) fn refits(&self) -> &Refits {
        &self.0.refits
    }

    pub(crate) fn tokens(&self) -> &Tokens {
        &self.0.tokens
    }

    pub(crate) fn rates(&self) -> &Rates {
        &self.0.rates
    }

    pub(crate) fn metrics(&self) -> &Metrics {
        &self.0.metrics
    }

    pub(crate) fn derived(&self) -> &Arc<Derived> {
        &self.0.derived
    }

    pub(crate) fn answers(&self) -> &Answers {
        &self.0.answers
    }

    pub(crate) fn requests(&self) -> &Arc<Semaphore> {
        &self.0.requests
    }

    pub(crate) fn streams(&self) -> &Arc<Semaphore> {
        &self.0.streams
    }

    /// Bytes of decoded tables in memory.
    pub(crate) fn table_bytes(&self) -> usize {
        self.0.tables.bytes()
    }

    pub(crate) fn uptime(&self) -> Duration {
        self.0.started.elapsed()
    }

    /// Counts a write of a client.
    ///
    /// # Errors
    /// [`ApiError::RateLimited`].
    pub(crate) fn allow_write(&self, token: &str) -> Result<(), ApiError> {
        self.0.rates.write(|| Client::Token(token.to_owned()))
    }

    /// Counts a token that was tried in vain.
    ///
    /// # Errors
    /// [`ApiError::RateLimited`].
    pub(crate) fn allow_guess(&self, address: Option<IpAddr>) -> Result<(), ApiError> {
        self.0.rates.write(|| Client::of_address(address))
    }

    /// What there is.
    pub(crate) fn index(&self) -> Arc<Index> {
        Arc::clone(&self.0.index.read().unwrap_or_else(PoisonError::into_inner))
    }

    /// Number of the index; answers made of another one are old.
    pub(crate) fn revision(&self) -> u64 {
        self.0.revision.load(Ordering::Acquire)
    }

    /// Reads the store's versions and aliases anew: after every write of ours, and now and then for those of others.
    ///
    /// # Errors
    /// When the store cannot be read; the old index stays.
    pub async fn refresh(&self) -> Result<(), StoreError> {
        // In turn: of two that read, the later must not be overwritten by the earlier.
        let _turn = self.0.refreshing.lock().await;
        let old = self.index();
        let index = Index::read(&self.0.stores, &old).await?;
        if *old != index {
            *self.0.index.write().unwrap_or_else(PoisonError::into_inner) = Arc::new(index);
            self.0.revision.fetch_add(1, Ordering::Release);
        }
        Ok(())
    }

    /// From now on a version that a refit publishes is served before the refit is said to have succeeded.
    pub(crate) fn refresh_when_published(&self) {
        // The refits are part of the state, and must not keep it alive.
        let state = Arc::downgrade(&self.0);
        self.refits().on_published(move || {
            let state = state.upgrade().map(Self);
            async move {
                if let Some(state) = state
                    && let Err(error) = state.refresh().await
                {
                    tracing::warn!(%error, "a new version is served once the store can be read");
                }
            }
        });
    }

    /// Ends event streams and readiness: the service is about to stop.
    pub(crate) fn stop(&self) {
        self.0.stopping.send_replace(true);
    }

    /// Becomes true when the service is about to stop.
    pub(crate) fn stopping(&self) -> watch::Receiver<bool> {
        self.0.stopping.subscribe()
    }

    /// A version's table, from memory or the store.
    pub(crate) async fn table(&self, manifest: &Arc<Manifest>) -> Result<Arc<TableVersion>, ApiError> {
        let key = (manifest.name.clone(), manifest.version);
        if let Some(known) = self.0.tables.get(&key).filter(|t| t.manifest().digest == manifest.digest) {
            return Ok(known);
        }
        let payload = self.0.stores.blobs.get(BlobKind::Payload, &manifest.digest).await;
        let payload = payload.map_err(ApiError::internal)?;
        let manifest = Manifest::clone(manifest);
        let read = self.0.compute.run(move || TableVersion::new(manifest, payload)).await?;
        let version = Arc::new(read.map_err(ApiError::internal)?);
        // The payload and, of about the same size, the numbers in it.
        self.0.tables.insert(key, Arc::clone(&version), 2 * version.payload().len());
        Ok(version)
    }

    /// The bytes of a variant: the payload as it is, or encoded once and then from the cache.
    pub(crate) async fn encoded(
        &self,
        manifest: &Arc<Manifest>,
        variant: Variant,
    ) -> Result<Tagged, ApiError> {
        let key = variant.key(manifest);
        if variant.is_payload() {
            let version = self.table(manifest).await?;
            let etag = ETag::of_digest(&manifest.digest);
            return Ok(Tagged { bytes: Bytes::from_owner(Payload(version)), etag });
        }
        let (state, manifest) = (self.clone(), Arc::clone(manifest));
        let version = state.table(&manifest).await?;
        let make = move || variant.encode(&version);
        self.0.derived.get(&key, &self.0.compute, &self.0.metrics, make).await
    }

    /// The same compressed; `None` where that saves too little.
    pub(crate) async fn gzipped(&self, key: &str, plain: &Tagged) -> Result<Option<Tagged>, ApiError> {
        let (key, plain) = (format!("{key} gzip"), plain.bytes.clone());
        let make = move || Ok(compressed(&plain).unwrap_or_default());
        let packed = self.0.derived.get(&key, &self.0.compute, &self.0.metrics, make).await?;
        Ok((!packed.bytes.is_empty()).then_some(packed))
    }
}

/// Lends a version's payload to responses without copying it.
struct Payload(Arc<TableVersion>);

impl AsRef<[u8]> for Payload {
    fn as_ref(&self) -> &[u8] {
        self.0.payload()
    }
}
