//! Refits on a store in memory and on the embedded one.
#![expect(clippy::unwrap_used, reason = "helpers of tests panic at what is wrong")]

use std::sync::Arc;
use std::time::Duration;

use ltc_fit::Limits;
use ltc_refit::{Ask, RefitConfig, RefitError, Refits, check, spec_digest};
use ltc_store::{BlobKind, Blobs, EventKind, Job, JobState, Jobs, MemoryStore, Metadata, StoreError};
use serde_json::{Value, json};

/// A specification that takes a fraction of a second, longer with more steps.
fn spec(steps: usize) -> Value {
    json!({
        "preset": "ggx-isotropic",
        "name": "small",
        "axes": [
            { "quantity": "theta", "mapping": "half_tangent", "len": 4 },
            { "quantity": "alpha", "mapping": "sqrt", "len": 4 },
        ],
        "entries": { "samples": 64, "iterations": 20 },
        "joint": { "steps": steps, "queries": 64, "samples": 64 },
        "channels": { "samples": 256, "queries": 64 },
        "measure": { "queries": 100, "samples": 256 },
    })
}

fn config() -> RefitConfig {
    let program = "test".to_owned();
    // Reports come four times in a lease.
    let lease = Duration::from_millis(200);
    RefitConfig { lease, threads: 2, shard: Duration::from_millis(1), program, ..RefitConfig::default() }
}

fn refits(store: &MemoryStore) -> Refits {
    let store = Arc::new(store.clone());
    Refits::new(store.clone(), store.clone(), store, config())
}

async fn ask(refits: &Refits, ask: Ask) -> Job {
    refits.request(ask).await.unwrap().0
}

/// Waits until a job is as it is wished to be.
async fn until(store: &dyn Jobs, id: &str, wish: impl Fn(&Job) -> bool) -> Job {
    let mut changes = store.watch();
    let waiting = async {
        loop {
            changes.borrow_and_update();
            let job = store.job(id).await.unwrap();
            if wish(&job) {
                return job;
            }
            changes.changed().await.unwrap();
        }
    };
    let end = tokio::time::timeout(Duration::from_secs(60), waiting).await;
    match end {
        Ok(job) => job,
        Err(_) => panic!("{:?}", store.job(id).await),
    }
}

async fn ended(store: &dyn Jobs, id: &str) -> Job {
    until(store, id, |job| job.state.is_final()).await
}

/// The digest that a fit of this specification gives.
fn digest_of(json: &Value) -> String {
    let spec = check(json, &Limits::default()).unwrap().spec;
    let (table, errors) = ltc_fit::fit(&spec, &ltc_fit::silent).unwrap();
    ltc_fit::publish(&spec, &table, errors, 1, String::new()).unwrap().manifest().digest.clone()
}

async fn log_of(store: &dyn Jobs, id: &str) -> String {
    let events = store.events(id, 0).await.unwrap();
    let lines = events.iter().filter(|e| e.kind == EventKind::Log).map(|e| e.data["line"].as_str().unwrap());
    lines.collect::<Vec<_>>().join("\n")
}

#[tokio::test(flavor = "multi_thread")]
async fn a_refit_gives_the_version_that_the_fit_gives() {
    let store = MemoryStore::default();
    let refits = refits(&store);
    let (told, at) = (Arc::new(std::sync::Mutex::new(Vec::new())), store.clone());
    let hook = Arc::clone(&told);
    refits.on_published(move || {
        let (hook, at) = (Arc::clone(&hook), at.clone());
        async move {
            let seen = (at.aliases().await.unwrap().len(), at.jobs(1).await.unwrap()[0].state);
            hook.lock().unwrap().push(seen);
        }
    });
    let workers = refits.start();
    let job = ask(&refits, Ask { alias: Some("latest".to_owned()), ..Ask::new(spec(50)) }).await;
    let job = ended(&store, &job.id).await;
    assert_eq!((job.state, job.version, job.error), (JobState::Succeeded, Some(1), None));
    assert_eq!(*told.lock().unwrap(), [(1, JobState::Running)], "published, and not yet said to be");
    let version = store.version("small", 1).await.unwrap();
    assert_eq!(version.digest, digest_of(&spec(50)));
    let payload = store.get(BlobKind::Payload, &version.digest).await.unwrap();
    assert_eq!(ltc_table::digest::digest(&payload), version.digest);
    assert_eq!(version.spec_digest, Some(check(&spec(50), &Limits::default()).unwrap().digest));
    let manifest = serde_json::from_value(version.manifest).unwrap();
    assert_eq!(spec_digest(&manifest), version.spec_digest, "found again from the manifest alone");
    let alias = &store.aliases().await.unwrap()[0];
    assert_eq!((alias.name.as_str(), alias.number), ("latest", 1));
    let log = log_of(&store, &job.id).await;
    assert!(log.contains("entries: ") && log.contains("the alias \"latest\" points at it now"), "{log}");
    workers.stop().await;
    assert!(store.list(BlobKind::Checkpoint).await.unwrap().is_empty(), "nothing is left");
    let metrics = refits.metrics().await.unwrap();
    assert_eq!((metrics.succeeded_total, metrics.queued, metrics.running), (1, 0, 0));
    // Joint steps; entries, queries and centres of the last two stages.
    let known = 50 * 64 + (16 + 64) + (2 * 16 + 9 + 100);
    assert!((known..known + 16).contains(&metrics.lobes_total), "{metrics:?}");
    assert!(metrics.lobes_per_second.is_sign_positive());
    assert_eq!((metrics.lobes_per_second, metrics.tv), (0.0, None), "nothing runs");
}

#[tokio::test(flavor = "multi_thread")]
async fn the_same_specification_is_fitted_once() {
    let store = MemoryStore::default();
    let refits = refits(&store);
    let workers = refits.start();
    let first = ask(&refits, Ask::new(spec(20))).await;
    ended(&store, &first.id).await;
    let lobes = refits.metrics().await.unwrap().lobes_total;
    let (second, is_new) = refits.request(Ask::new(spec(20))).await.unwrap();
    assert_ne!(second.id, first.id);
    assert_eq!((second.state, second.version, is_new), (JobState::Succeeded, Some(1), true), "at once");
    // With an alias it goes through the queue, for the alias is to move.
    let third = ask(&refits, Ask { alias: Some("mine".to_owned()), ..Ask::new(spec(20)) }).await;
    assert_eq!(ended(&store, &third.id).await.version, Some(1));
    assert_eq!(store.aliases().await.unwrap().len(), 1);
    assert_eq!(store.versions().await.unwrap().len(), 1);
    assert_eq!(refits.metrics().await.unwrap().lobes_total, lobes, "nothing was fitted again");
    workers.stop().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_worse_table_is_kept_but_does_not_take_the_alias() {
    let store = MemoryStore::default();
    let refits = refits(&store);
    let workers = refits.start();
    let latest = |steps, force| Ask { alias: Some("latest".to_owned()), force, ..Ask::new(spec(steps)) };
    let good = ask(&refits, latest(100, false)).await;
    assert_eq!(ended(&store, &good.id).await.version, Some(1));
    let worse = ask(&refits, latest(0, false)).await;
    assert_eq!(ended(&store, &worse.id).await.version, Some(2), "kept");
    let tv = |number| {
        let store = store.clone();
        async move {
            let version = store.version("small", number).await.unwrap();
            version.manifest["errors"]["standard_draw"]["tv_mean"].as_f64().unwrap()
        }
    };
    assert!(tv(2).await > tv(1).await, "the test needs a worse one");
    let alias = async || store.aliases().await.unwrap()[0].number;
    assert_eq!(alias().await, 1);
    let log = log_of(&store, &worse.id).await;
    assert!(log.contains("the alias \"latest\" stays at version 1: the mean TV"), "{log}");
    // Told to, it takes it; and a better one takes it back without being told.
    let forced = ask(&refits, latest(0, true)).await;
    assert_eq!(ended(&store, &forced.id).await.version, Some(2));
    assert_eq!(alias().await, 2);
    let back = ask(&refits, latest(100, false)).await;
    assert_eq!(ended(&store, &back.id).await.version, Some(1));
    assert_eq!(alias().await, 1);
    workers.stop().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_worse_table_does_not_become_latest_where_nobody_has_set_it() {
    for alias in [None, Some("latest"), Some("mine")] {
        let store = MemoryStore::default();
        let refits = refits(&store);
        let workers = refits.start();
        let good = ask(&refits, Ask::new(spec(100))).await;
        assert_eq!(ended(&store, &good.id).await.version, Some(1));
        assert_eq!(store.aliases().await.unwrap(), [], "latest is the newest");
        let better = ask(&refits, Ask::new(spec(101))).await;
        let better = ended(&store, &better.id).await.version;
        let set = store.aliases().await.unwrap();
        let worse = ask(&refits, Ask { alias: alias.map(str::to_owned), ..Ask::new(spec(0)) }).await;
        let worse = ended(&store, &worse.id).await.version.unwrap();
        let aliases = store.aliases().await.unwrap();
        let latest = aliases.iter().find(|a| a.name == "latest").map(|a| a.number);
        assert!(latest.is_some_and(|number| number < worse), "{alias:?}: {aliases:?}, {better:?}, {set:?}");
        let forced = Ask { alias: Some("latest".to_owned()), force: true, ..Ask::new(spec(0)) };
        assert_eq!(ended(&store, &ask(&refits, forced).await.id).await.version, Some(worse));
        let aliases = store.aliases().await.unwrap();
        assert_eq!(aliases.iter().find(|a| a.name == "latest").map(|a| a.number), Some(worse));
        workers.stop().await;
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_stopped_refit_goes_on_to_the_same_digest() {
    let store = MemoryStore::default();
    let refits = refits(&store);
    let mut workers = refits.start();
    let job = ask(&refits, Ask::new(spec(500))).await;
    let mut stops = 0;
    while stops < 4 {
        let before = store.job(&job.id).await.unwrap().progress;
        let now = until(&store, &job.id, |job| job.progress > before || job.state.is_final()).await;
        if now.state.is_final() {
            break; // before four stops, on a fast machine
        }
        workers.stop().await;
        let now = store.job(&job.id).await.unwrap();
        if now.state == JobState::Queued {
            let kept = store.list(BlobKind::Checkpoint).await.unwrap();
            assert_eq!(kept.len(), 1, "one checkpoint, the newest");
            stops += 1;
        }
        workers = refits.start();
    }
    assert!(stops > 1, "the fit was too fast to be stopped");
    let job = ended(&store, &job.id).await;
    assert_eq!((job.state, job.attempts), (JobState::Succeeded, stops + 1));
    assert_eq!(store.version("small", 1).await.unwrap().digest, digest_of(&spec(500)));
    let log = log_of(&store, &job.id).await;
    assert_eq!(log.matches("going on from a checkpoint").count() as u32, stops, "{log}");
    workers.stop().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_running_refit_is_cancelled() {
    let store = MemoryStore::default();
    let refits = refits(&store);
    let workers = refits.start();
    let job = ask(&refits, Ask::new(spec(1_000_000))).await;
    until(&store, &job.id, |job| job.state == JobState::Running && job.tv.is_some()).await;
    let start = std::time::Instant::now();
    store.cancel(&job.id).await.unwrap();
    let job = ended(&store, &job.id).await;
    assert_eq!((job.state, job.version), (JobState::Cancelled, None));
    assert!(start.elapsed() < Duration::from_secs(5), "{:?}", start.elapsed());
    let next = ask(&refits, Ask::new(spec(5))).await;
    assert_eq!(ended(&store, &next.id).await.state, JobState::Succeeded, "the worker goes on");
    workers.stop().await;
    assert!(store.versions().await.unwrap().iter().all(|v| v.number == 1));
    assert!(store.list(BlobKind::Checkpoint).await.unwrap().is_empty());
    assert_eq!(refits.metrics().await.unwrap().cancelled_total, 1);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_worker_whose_job_was_taken_over_publishes_nothing() {
    let store = MemoryStore::default();
    let refits = refits(&store);
    let workers = refits.start();
    let job = ask(&refits, Ask { alias: Some("latest".to_owned()), ..Ask::new(spec(500)) }).await;
    until(&store, &job.id, |job| job.progress > 0.1).await;
    // Somebody who has the same name as the worker: as after a pause that looked like a death.
    let claim = store.claim("embedded-0", Duration::from_secs(600)).await.unwrap().unwrap();
    assert_eq!(claim.attempt, 2);
    let next = ask(
        &refits,
        Ask {
            spec: {
                let mut s = spec(5);
                s["name"] = "other".into();
                s
            },
            ..Ask::new(Value::Null)
        },
    )
    .await;
    // The worker notices at its next report and takes up something else: its own name's job first, which is this one.
    until(&store, &job.id, |job| job.attempts >= 3 || job.state.is_final()).await;
    assert!(matches!(
        store.report(&claim, Duration::from_secs(1), ltc_store::ShardReport::default()).await,
        Err(StoreError::Conflict { .. })
    ));
    let job = ended(&store, &job.id).await;
    assert_eq!((job.state, job.attempts), (JobState::Succeeded, 3));
    ended(&store, &next.id).await;
    assert_eq!(store.aliases().await.unwrap()[0].revision, 1, "moved once");
    workers.stop().await;
}

#[tokio::test]
async fn what_cannot_be_fitted_is_refused_before_there_is_a_job() {
    let store = MemoryStore::default();
    let limits = Limits { memory: 20 << 20, seconds: 1e9 };
    let shared = Arc::new(store.clone());
    let config = RefitConfig { limits, queue: 1, piece_seconds: 5.0, ..config() };
    let refits = Refits::new(shared.clone(), shared.clone(), shared, config);
    let refused = refits
        .request(Ask::new(json!({ "preset": "ggx-anisotropic", "channels": { "queries": 1 << 20 } })))
        .await
        .unwrap_err();
    assert!(matches!(refused, RefitError::TooLarge { .. }), "{refused}");
    let mut odd = spec(1);
    odd["joint"]["samples"] = json!(-1);
    let refused = refits.request(Ask::new(odd)).await.unwrap_err();
    assert!(matches!(&refused, RefitError::Spec { field, .. } if field == "joint.samples"), "{refused}");
    let mut long = spec(1);
    (long["joint"]["samples"], long["joint"]["queries"]) = (json!(1 << 20), json!(1 << 14));
    let refused = refits.request(Ask::new(long)).await.unwrap_err();
    assert!(matches!(refused, RefitError::TooLarge { .. }), "{refused}");
    assert!(refused.to_string().contains("lower joint.queries or joint.samples"), "{refused}");
    assert!(store.jobs(9).await.unwrap().is_empty());
    refits.request(Ask::new(spec(1))).await.unwrap();
    let full = refits.request(Ask::new(spec(2))).await.unwrap_err();
    assert!(matches!(full, RefitError::Store(StoreError::Full { limit: 1, .. })), "{full}");
}
