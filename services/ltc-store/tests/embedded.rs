//! What the embedded store does with its folder.
#![expect(clippy::unwrap_used, reason = "helpers of tests panic at what is wrong")]

use std::fs;
use std::path::{Path, PathBuf};

use ltc_store::{BlobKind, Blobs, EmbeddedStore, Jobs, Metadata, NewJob, Secret, StoreError, seed};
use ltc_table::digest::digest;
use tempfile::tempdir;

/// Every file below a folder.
fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() { found.extend(files(&path)) } else { found.push(path) }
    }
    found
}

#[tokio::test]
async fn everything_is_there_after_a_restart() {
    let folder = tempdir().unwrap();
    let (token, _) = Secret::generate("x", [].into(), None).unwrap();
    let payload = digest(b"payload");
    let job = NewJob {
        table: "a".to_owned(),
        spec: serde_json::json!({ "a": [1.5, "ü"] }),
        spec_digest: "sha256:1".to_owned(),
        priority: 3,
        alias: Some(("stable".to_owned(), true)),
        idempotency: Some(("me".to_owned(), "1".to_owned())),
    };
    let before = {
        let store = EmbeddedStore::open(folder.path()).unwrap();
        store.add_token(token.clone()).await.unwrap();
        store.put(BlobKind::Payload, &payload, b"payload").await.unwrap();
        store.enqueue(job, 9).await.unwrap().0
    };
    let store = EmbeddedStore::open(folder.path()).unwrap();
    assert_eq!(store.tokens().await.unwrap(), [token]);
    assert_eq!(store.get(BlobKind::Payload, &payload).await.unwrap(), b"payload");
    assert_eq!(store.jobs(9).await.unwrap(), [before]);
}

#[tokio::test]
async fn one_process_serves_and_commands_work_beside_it() {
    let folder = tempdir().unwrap();
    let serving = EmbeddedStore::open(folder.path()).unwrap();
    let Err(error) = EmbeddedStore::open(folder.path()) else { panic!("two serve from one folder") };
    assert!(matches!(error, StoreError::Conflict { .. }), "{error}");
    assert!(error.to_string().contains("another process serves from"), "{error}");
    let command = EmbeddedStore::attach(folder.path()).unwrap();
    let (token, _) = Secret::generate("x", [].into(), None).unwrap();
    command.add_token(token.clone()).await.unwrap();
    assert_eq!(serving.tokens().await.unwrap(), std::slice::from_ref(&token), "seen at once");
    serving.revoke_token(&token.id).await.unwrap();
    assert!(command.tokens().await.unwrap().is_empty());
    drop(serving);
    EmbeddedStore::open(folder.path()).unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn two_processes_that_write_at_once_take_turns() {
    let folder = tempdir().unwrap();
    let serving = EmbeddedStore::open(folder.path()).unwrap();
    let command = EmbeddedStore::attach(folder.path()).unwrap();
    let tasks = [serving.clone(), command].map(|store| {
        tokio::spawn(async move {
            for _ in 0..100 {
                let (token, _) = Secret::generate("x", [].into(), None).unwrap();
                store.add_token(token).await.unwrap();
                // Reads before it writes, so that what it read must not go stale.
                let job = NewJob {
                    table: "a".to_owned(),
                    spec: serde_json::json!({}),
                    spec_digest: String::new(),
                    priority: 0,
                    alias: None,
                    idempotency: None,
                };
                store.enqueue(job, 1000).await.unwrap();
            }
        })
    });
    for task in tasks {
        task.await.unwrap();
    }
    assert_eq!(serving.tokens().await.unwrap().len(), 200);
    assert_eq!(serving.depth().await.unwrap(), (200, 0));
}

#[tokio::test]
async fn what_a_kill_left_half_written_goes_at_the_next_start() {
    let folder = tempdir().unwrap();
    drop(EmbeddedStore::open(folder.path()).unwrap());
    let stray = folder.path().join("blobs/tmp/123-0");
    fs::write(&stray, b"half").unwrap();
    let store = EmbeddedStore::open(folder.path()).unwrap();
    assert!(!stray.exists());
    for kind in [BlobKind::Payload, BlobKind::Derived, BlobKind::Checkpoint] {
        assert!(store.list(kind).await.unwrap().is_empty());
    }
}

#[tokio::test]
async fn damage_is_seen_and_mended_by_the_next_upload() {
    let folder = tempdir().unwrap();
    let store = EmbeddedStore::open(folder.path()).unwrap();
    let key = digest(b"payload");
    store.put(BlobKind::Payload, &key, b"payload").await.unwrap();
    let path = files(&folder.path().join("blobs")).pop().unwrap();
    for damaged in [&b"paylo"[..], b"peyload"] {
        fs::write(&path, damaged).unwrap();
        let error = store.get(BlobKind::Payload, &key).await.unwrap_err();
        assert!(matches!(error, StoreError::Damaged { .. }), "{error}");
        store.put(BlobKind::Payload, &key, b"payload").await.unwrap();
        assert_eq!(store.get(BlobKind::Payload, &key).await.unwrap(), b"payload");
    }
}

#[tokio::test]
async fn derived_blobs_are_bounded_across_restarts() {
    let folder = tempdir().unwrap();
    let keys = async |store: &EmbeddedStore| -> Vec<String> {
        store.list(BlobKind::Derived).await.unwrap().into_iter().map(|(key, _)| key).collect()
    };
    let store = EmbeddedStore::open_with(folder.path(), 300).unwrap();
    store.put(BlobKind::Payload, "kept", &[0; 1000]).await.unwrap();
    for key in ["a", "b", "c"] {
        store.put(BlobKind::Derived, key, &[0; 100]).await.unwrap();
        // The times of files are what is left of the order after a restart.
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    store.get(BlobKind::Derived, "a").await.unwrap();
    assert_eq!(keys(&store).await, ["b", "c", "a"]);
    drop(store);
    let store = EmbeddedStore::open_with(folder.path(), 300).unwrap();
    assert_eq!(keys(&store).await, ["b", "c", "a"]);
    store.put(BlobKind::Derived, "d", &[0; 150]).await.unwrap();
    assert_eq!(keys(&store).await, ["a", "d"]);
    assert_eq!(files(&folder.path().join("blobs/derived")).len(), 2);
    store.put(BlobKind::Derived, "huge", &[0; 301]).await.unwrap();
    assert_eq!(keys(&store).await, ["a", "d"], "what could never fit pushes nothing out");
    assert_eq!(store.get(BlobKind::Payload, "kept").await.unwrap().len(), 1000);
    drop(store);
    let store = EmbeddedStore::open_with(folder.path(), 120).unwrap();
    assert!(keys(&store).await.is_empty(), "a smaller bound holds from the start: d alone is above it");
}

#[tokio::test]
async fn a_store_of_a_newer_program_is_left_alone() {
    let folder = tempdir().unwrap();
    drop(EmbeddedStore::open(folder.path()).unwrap());
    let database = rusqlite::Connection::open(folder.path().join("ltc.sqlite")).unwrap();
    database.pragma_update(None, "user_version", 99).unwrap();
    drop(database);
    for open in [EmbeddedStore::open, EmbeddedStore::attach] {
        let Err(error) = open(folder.path()) else { panic!("opened") };
        assert!(matches!(error, StoreError::TooNew { found: 99, .. }), "{error}");
    }
}

#[tokio::test]
async fn a_file_that_is_no_database_is_named() {
    let folder = tempdir().unwrap();
    fs::write(
        folder.path().join("ltc.sqlite"),
        "not a database, but long enough to be taken for one".repeat(99),
    )
    .unwrap();
    let Err(error) = EmbeddedStore::open(folder.path()) else { panic!("opened") };
    assert!(matches!(error, StoreError::Damaged { .. }), "{error}");
}

#[tokio::test]
async fn the_first_start_is_completed_and_repeated_starts_change_nothing() {
    let folder = tempdir().unwrap();
    let shipped = ltc_tables::shipped().unwrap();
    let store = EmbeddedStore::open(folder.path()).unwrap();
    let added = seed(&store, &store, &shipped, &|_| None).await.unwrap();
    assert!(added > 5, "{added}");
    let versions = store.versions().await.unwrap();
    assert_eq!(versions.len() as u32, added);
    for version in &versions {
        let there = shipped.version(&version.table, &version.number.to_string()).unwrap();
        assert_eq!(version.digest, there.manifest().digest, "numbers are those of the manifests");
        let payload = store.get(BlobKind::Payload, &version.digest).await.unwrap();
        assert_eq!(payload, there.payload());
    }
    let aliases = store.aliases().await.unwrap();
    for alias in &aliases {
        let newest = shipped.version(&alias.table, "latest").unwrap();
        assert_eq!(alias.number, newest.manifest().version, "{} of {}", alias.name, alias.table);
    }
    assert_eq!(aliases.len(), 2 * shipped.names().count());
    assert_eq!(seed(&store, &store, &shipped, &|_| None).await.unwrap(), 0);
    assert_eq!(store.aliases().await.unwrap(), aliases);
}

#[cfg(unix)]
#[tokio::test]
async fn a_database_that_is_gone_is_missed() {
    let folder = tempdir().unwrap();
    let data = folder.path().join("data");
    let store = EmbeddedStore::open(&data).unwrap();
    store.ping().await.unwrap();
    let elsewhere = folder.path().join("elsewhere");
    fs::rename(&data, &elsewhere).unwrap();
    assert!(store.ping().await.is_err(), "SQLite itself would go on");
    // Another one in its place is not the one that is written to.
    fs::create_dir(&data).unwrap();
    fs::copy(elsewhere.join("ltc.sqlite"), data.join("ltc.sqlite")).unwrap();
    assert!(store.ping().await.is_err());
    fs::remove_dir_all(&data).unwrap();
    fs::rename(&elsewhere, &data).unwrap();
    store.ping().await.unwrap();
}
