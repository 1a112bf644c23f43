//! `kill -9` at random moments of refits: each is finished with the digest of an undisturbed fit.
#![cfg(unix)]
#![expect(clippy::unwrap_used, reason = "helpers of tests panic at what is wrong")]

#[path = "../../ltc-store/tests/child/mod.rs"]
mod child;
#[path = "../../ltc-store/tests/kill/mod.rs"]
mod kill;

use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use child::command;
use kill::{MARK, kill_after, moments};
use ltc_fit::Limits;
use ltc_refit::{Ask, RefitConfig, Refits, check};
use ltc_store::{BlobKind, Blobs, EmbeddedStore, EventKind, Job, JobState, Jobs, Metadata};
use serde_json::{Value, json};
use tempfile::tempdir;

/// Kills in all.
const KILLS: u32 = 50;

/// A specification that takes a second or two, each number another one.
fn spec(number: u64) -> Value {
    json!({
        "preset": "ggx-isotropic",
        "name": "small",
        "axes": [
            { "quantity": "theta", "mapping": "half_tangent", "len": 4 },
            { "quantity": "alpha", "mapping": "sqrt", "len": 4 },
        ],
        "entries": { "samples": 64, "iterations": 20 },
        "joint": { "steps": 400, "queries": 64, "samples": 64, "seed": 1000 + number },
        "channels": { "samples": 256, "queries": 64 },
        "measure": { "queries": 100, "samples": 256 },
    })
}

fn refits(folder: &Path) -> (Arc<EmbeddedStore>, Refits) {
    let store = Arc::new(EmbeddedStore::open(folder).unwrap());
    let config = RefitConfig {
        threads: 2,
        shard: Duration::from_millis(1),
        // Reports come four times in a lease.
        lease: Duration::from_millis(100),
        program: "test".to_owned(),
        ..RefitConfig::default()
    };
    (store.clone(), Refits::new(store.clone(), store.clone(), store, config))
}

#[tokio::test(flavor = "multi_thread")]
async fn child_refits() {
    let Some(folder) = child::folder() else { return };
    let (store, refits) = refits(&folder);
    let workers = refits.start();
    println!("{MARK}ready");
    let mut changes = store.watch();
    while store.depth().await.unwrap() != (0, 0) {
        changes.changed().await.unwrap();
    }
    workers.stop().await;
}

/// The digest that an undisturbed fit gives.
fn digest_of(spec: &Value) -> String {
    let spec = check(spec, &Limits::default()).unwrap().spec;
    let (table, errors) = ltc_fit::fit(&spec, &ltc_fit::silent).unwrap();
    ltc_fit::publish(&spec, &table, errors, 1, String::new()).unwrap().manifest().digest.clone()
}

#[tokio::test(flavor = "multi_thread")]
async fn refits_survive_kills() {
    let folder = tempdir().unwrap();
    let mut asked = Vec::new();
    let mut within = 0;
    for moment in moments(KILLS, 0..400_000) {
        let open = {
            let (store, refits) = refits(folder.path());
            check_versions(&store).await;
            if store.depth().await.unwrap() == (0, 0) {
                let spec = spec(asked.len() as u64);
                let ask = Ask { alias: Some("latest".to_owned()), force: true, ..Ask::new(spec.clone()) };
                asked.push((refits.request(ask).await.unwrap().0.id, spec));
            }
            store.job(&asked.last().unwrap().0).await.unwrap()
        };
        kill_after(command("child_refits", folder.path()).spawn().unwrap(), moment);
        let (store, _) = refits(folder.path());
        let after = store.job(&open.id).await.unwrap();
        within += u32::from(after.state == JobState::Running && after.progress > 0.0);
    }
    assert!(within > KILLS / 4, "only {within} kills came within a fit");
    child::assert_passed(&command("child_refits", folder.path()).output().unwrap());
    let (store, _) = refits(folder.path());
    check_versions(&store).await;
    let mut resumed = 0;
    for (number, (id, spec)) in (1..).zip(&asked) {
        let job = store.job(id).await.unwrap();
        assert_eq!((job.state, job.version), (JobState::Succeeded, Some(number)), "{job:?}");
        assert_eq!(store.version("small", number).await.unwrap().digest, digest_of(spec));
        resumed += resumptions(&store, &job).await;
    }
    assert!(resumed > KILLS as usize / 4, "only {resumed} attempts went on from a checkpoint");
    assert_eq!(store.aliases().await.unwrap()[0].number, asked.len() as u32);
    assert!(store.list(BlobKind::Checkpoint).await.unwrap().is_empty());
}

/// No version without its payload, whole.
async fn check_versions(store: &EmbeddedStore) {
    for version in store.versions().await.unwrap() {
        store.get(BlobKind::Payload, &version.digest).await.unwrap();
    }
}

/// How often a job went on from a checkpoint.
async fn resumptions(store: &EmbeddedStore, job: &Job) -> usize {
    let events = store.events(&job.id, 0).await.unwrap();
    let lines = events.iter().filter(|e| e.kind == EventKind::Log).map(|e| e.data["line"].as_str().unwrap());
    lines.filter(|line| line.contains("going on from a checkpoint")).count()
}
