//! Refits on a store that cannot be written to for a while.
#![expect(clippy::unwrap_used, reason = "helpers of tests panic at what is wrong")]

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

use async_trait::async_trait;
use ltc_refit::{Ask, RefitConfig, Refits};
use ltc_store::{BlobKind, Blobs, JobState, Jobs, MemoryStore, Metadata, StoreError};
use serde_json::json;

/// Blobs on a device that is full for so many writes of each kind.
struct Full {
    store: MemoryStore,
    payloads: AtomicU32,
    checkpoints: AtomicU32,
}

#[async_trait]
impl Blobs for Full {
    async fn put(&self, kind: BlobKind, key: &str, bytes: &[u8]) -> Result<(), StoreError> {
        let left = if kind == BlobKind::Payload { &self.payloads } else { &self.checkpoints };
        let less = |n: u32| n.checked_sub(1);
        if left.fetch_update(Ordering::SeqCst, Ordering::SeqCst, less).is_ok() {
            return Err(StoreError::Unwritable { reason: "no room".to_owned() });
        }
        self.store.put(kind, key, bytes).await
    }

    async fn get(&self, kind: BlobKind, key: &str) -> Result<Vec<u8>, StoreError> {
        self.store.get(kind, key).await
    }

    async fn contains(&self, kind: BlobKind, key: &str) -> Result<bool, StoreError> {
        self.store.contains(kind, key).await
    }

    async fn delete(&self, kind: BlobKind, key: &str) -> Result<(), StoreError> {
        self.store.delete(kind, key).await
    }

    async fn list(&self, kind: BlobKind) -> Result<Vec<(String, u64)>, StoreError> {
        self.store.list(kind).await
    }
}

/// A refit on such a device, started; the store, the refits, and the job.
async fn start(payloads: u32) -> (MemoryStore, ltc_refit::Workers, String) {
    let store = MemoryStore::default();
    let full =
        Full { store: store.clone(), payloads: AtomicU32::new(payloads), checkpoints: AtomicU32::new(2) };
    let config = RefitConfig { threads: 1, shard: Duration::from_millis(1), ..RefitConfig::default() };
    let (metadata, jobs) = (Arc::new(store.clone()), Arc::new(store.clone()));
    let refits = Refits::new(metadata, Arc::new(full), jobs, config);
    let workers = refits.start();
    let spec = json!({
        "preset": "ggx-isotropic",
        "name": "small",
        "axes": [
            { "quantity": "theta", "mapping": "half_tangent", "len": 3 },
            { "quantity": "alpha", "mapping": "sqrt", "len": 3 },
        ],
        "entries": { "samples": 64, "iterations": 5 },
        "joint": { "steps": 20, "queries": 16, "samples": 32 },
        "channels": { "samples": 256, "queries": 16 },
        "measure": { "queries": 100, "samples": 256 },
    });
    let (job, _) = refits.request(Ask::new(spec)).await.unwrap();
    (store, workers, job.id)
}

async fn wait_for(store: &MemoryStore, id: &str, wish: impl Fn(JobState, &str) -> bool) {
    for _ in 0..6000 {
        let events = store.events(id, 0).await.unwrap();
        let log: String = events.iter().filter_map(|e| e.data["line"].as_str()).collect();
        if wish(store.job(id).await.unwrap().state, &log) {
            return;
        }
        tokio::time::sleep(Duration::from_millis(10)).await;
    }
    panic!("{:?}", store.job(id).await);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_refit_waits_for_room_and_succeeds() {
    let (store, workers, id) = start(2).await;
    wait_for(&store, &id, |state, _| state == JobState::Succeeded).await;
    let version = store.version("small", 1).await.unwrap();
    store.get(BlobKind::Payload, &version.digest).await.unwrap();
    wait_for(&store, &id, |_, log| log.contains("no checkpoint could be written")).await;
    workers.stop().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_refit_that_waits_for_room_is_released_when_the_service_stops() {
    let (store, workers, id) = start(u32::MAX).await;
    // All of the fit is done once nothing is left to do but to keep it.
    wait_for(&store, &id, |state, _| state == JobState::Running).await;
    tokio::time::sleep(Duration::from_millis(500)).await;
    tokio::time::timeout(Duration::from_secs(20), workers.stop()).await.unwrap();
    assert_eq!(store.job(&id).await.unwrap().state, JobState::Queued);
    assert!(store.versions().await.unwrap().is_empty(), "no version without its payload");
}
