//! Backup and restore.
#![expect(clippy::unwrap_used, reason = "helpers of tests panic at what is wrong")]

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use ltc_store::{
    BlobKind, Blobs, EmbeddedStore, Metadata, NewVersion, Secret, StoreError, VersionState, back_up, restore,
};
use ltc_table::digest::digest;
use serde_json::json;
use tempfile::tempdir;

async fn upload(store: &EmbeddedStore, number: u32) {
    let payload = number.to_le_bytes().repeat(1000);
    let version = NewVersion {
        table: "t".to_owned(),
        digest: digest(&payload),
        manifest: json!({}),
        state: VersionState::Published,
        spec_digest: None,
        reason: None,
    };
    store.put(BlobKind::Payload, &version.digest, &payload).await.unwrap();
    store.add_version(version, Some(("latest", None))).await.unwrap();
}

/// A file below a folder whose name ends so.
fn find(folder: &Path, end: &str) -> PathBuf {
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for path in fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()) {
            if path.is_dir() {
                folders.push(path);
            } else if path.to_string_lossy().ends_with(end) {
                return path;
            }
        }
    }
    panic!("no {end}");
}

/// A store with three versions, an alias, a token, and a derived blob; and its backup.
async fn backed_up() -> (tempfile::TempDir, PathBuf, PathBuf) {
    let folder = tempdir().unwrap();
    let (data, backup) = (folder.path().join("data"), folder.path().join("backup"));
    let store = EmbeddedStore::open(&data).unwrap();
    for number in 0..3 {
        upload(&store, number).await;
    }
    store.add_token(Secret::generate("x", [].into(), None).unwrap().0).await.unwrap();
    store.put(BlobKind::Derived, "derived", b"again").await.unwrap();
    let contents = back_up(&data, &backup).unwrap();
    assert_eq!(contents.payloads, 3);
    (folder, data, backup)
}

#[tokio::test]
async fn what_was_backed_up_comes_back() {
    let (folder, data, backup) = backed_up().await;
    let restored = folder.path().join("restored");
    let contents = restore(&backup, &restored).unwrap();
    let again = back_up(&restored, &folder.path().join("again")).unwrap();
    assert_eq!((again.payloads, again.bytes), (contents.payloads, contents.bytes));
    let (before, after) = (EmbeddedStore::attach(&data).unwrap(), EmbeddedStore::open(&restored).unwrap());
    assert_eq!(after.versions().await.unwrap(), before.versions().await.unwrap());
    assert_eq!(after.aliases().await.unwrap(), before.aliases().await.unwrap());
    assert_eq!(after.tokens().await.unwrap(), before.tokens().await.unwrap());
    for version in after.versions().await.unwrap() {
        after.get(BlobKind::Payload, &version.digest).await.unwrap();
    }
    assert!(after.list(BlobKind::Derived).await.unwrap().is_empty());
    upload(&after, 9).await;
    assert_eq!(after.versions().await.unwrap().len(), 4, "it goes on from there");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_store_that_is_written_to_is_backed_up_as_it_was_at_one_moment() {
    let folder = tempdir().unwrap();
    let data = folder.path().join("data");
    let store = EmbeddedStore::open(&data).unwrap();
    upload(&store, 0).await;
    let stop = Arc::new(AtomicBool::new(false));
    let (writer, stopped) = (store.clone(), Arc::clone(&stop));
    let writing = tokio::spawn(async move {
        let mut number = 1;
        while !stopped.load(Ordering::Relaxed) {
            upload(&writer, number).await;
            number += 1;
            tokio::time::sleep(Duration::from_millis(5)).await;
        }
        number
    });
    let mut seen = Vec::new();
    for i in 0..5 {
        let (from, to) = (data.clone(), folder.path().join(format!("backup{i}")));
        tokio::task::spawn_blocking(move || back_up(&from, &to)).await.unwrap().unwrap();
        let restored = folder.path().join(format!("restored{i}"));
        restore(&folder.path().join(format!("backup{i}")), &restored).unwrap();
        let restored = EmbeddedStore::open(&restored).unwrap();
        let versions = restored.versions().await.unwrap();
        // Version and alias are written in one transaction: one moment has both.
        assert_eq!(restored.aliases().await.unwrap()[0].number, versions.last().unwrap().number);
        seen.push(versions.len());
    }
    stop.store(true, Ordering::Relaxed);
    assert!(writing.await.unwrap() > 5, "nothing was written meanwhile");
    assert!(seen.is_sorted() && seen[0] < seen[4], "{seen:?}");
}

fn kind<T>(result: Result<T, StoreError>) -> String {
    let Err(error) = result else { panic!("it was done") };
    format!("{error:?}").split([' ', '(']).next().unwrap().to_owned() + ": " + &error.to_string()
}

#[tokio::test]
async fn nothing_is_overwritten_and_nothing_is_made_of_nothing() {
    let (folder, data, backup) = backed_up().await;
    assert!(kind(back_up(&data, &backup)).starts_with("Conflict: "));
    assert!(kind(restore(&backup, &data)).starts_with("Conflict: "));
    assert!(kind(back_up(&folder.path().join("none"), &folder.path().join("a"))).starts_with("NotFound: "));
    assert!(kind(restore(&data, &folder.path().join("b"))).starts_with("NotFound: "), "no backup");
    // What was cut short is completed by the same command.
    let cut = folder.path().join("cut");
    fs::create_dir_all(cut.join("blobs")).unwrap();
    assert!(kind(restore(&backup, &cut)).starts_with("Conflict: "), "somebody's own blobs");
    fs::write(cut.join("unfinished.sqlite"), "half").unwrap();
    restore(&backup, &cut).unwrap();
    EmbeddedStore::open(&cut).unwrap();
    let cut = folder.path().join("cut backup");
    fs::create_dir_all(&cut).unwrap();
    fs::write(cut.join("unfinished.sqlite"), "half").unwrap();
    back_up(&data, &cut).unwrap();
    restore(&cut, &folder.path().join("c")).unwrap();
}

#[tokio::test]
async fn damage_is_seen() {
    let (folder, _, backup) = backed_up().await;
    let target = |name: &str| folder.path().join(name);
    let payload = find(&backup.join("blobs/payload"), "");
    let bytes = fs::read(&payload).unwrap();
    fs::write(&payload, &bytes[1..]).unwrap();
    let said = kind(restore(&backup, &target("a")));
    assert!(said.starts_with("Damaged: the blob sha256:"), "{said}");
    assert!(!target("a").join("ltc.sqlite").exists(), "no store");
    fs::remove_file(&payload).unwrap();
    let said = kind(restore(&backup, &target("b")));
    assert!(said.contains("it is missing"), "{said}");
    fs::write(&payload, bytes).unwrap();
    let database = backup.join("ltc.sqlite");
    let mut bytes = fs::read(&database).unwrap();
    bytes[5000] ^= 1;
    fs::write(&database, &bytes).unwrap();
    let said = kind(restore(&backup, &target("c")));
    assert!(said.starts_with("Damaged: the backup"), "{said}");
    fs::remove_file(backup.join("backup.json")).unwrap();
    assert!(kind(restore(&backup, &target("d"))).starts_with("NotFound: "), "not complete");
}
