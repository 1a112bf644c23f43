//! `kill -9` at random moments: what was acknowledged is there, nothing is half written, the next start goes on.
#![cfg(unix)]
#![expect(clippy::unwrap_used, reason = "helpers of tests panic at what is wrong")]

mod child;
mod kill;

use std::collections::BTreeMap;
use std::path::Path;

use child::command;
use kill::{MARK, kill_after, moments};
use ltc_store::{BlobKind, Blobs, EmbeddedStore, Metadata, NewVersion, StoreError, VersionState, seed};
use ltc_table::digest::digest;
use serde_json::json;
use tempfile::tempdir;

/// Kills in each test.
const KILLS: u32 = 50;

/// Bytes of a derived blob.
const DERIVED: usize = 2_000_000;

/// A payload of some size, by its number.
fn payload(number: u64) -> Vec<u8> {
    (0..50_000).map(|i| (i as u64 ^ number) as u8).chain(number.to_le_bytes()).collect()
}

/// An upload: the payload, then the version.
async fn upload(store: &EmbeddedStore, number: u64) -> Result<u32, StoreError> {
    let payload = payload(number);
    let version = NewVersion {
        table: "t".to_owned(),
        digest: digest(&payload),
        manifest: json!({}),
        state: VersionState::Published,
        spec_digest: None,
        reason: None,
    };
    store.put(BlobKind::Payload, &version.digest, &payload).await?;
    Ok(store.add_version(version, None).await?.0.number)
}

/// Uploads versions and moves an alias to and fro, and says what was acknowledged.
#[tokio::test]
async fn child_uploads_and_moves() {
    let Some(folder) = child::folder() else { return };
    let store = EmbeddedStore::open(&folder).unwrap();
    let mut next = store.versions().await.unwrap().len() as u64;
    println!("{MARK}ready");
    loop {
        let number = upload(&store, next).await.unwrap();
        println!("{MARK}version {number} {}", digest(&payload(next)));
        // Derived blobs are named by no digest: only being written whole or not at all keeps them from being served in part.
        store.put(BlobKind::Derived, &format!("derived-{next}"), &vec![7; DERIVED]).await.unwrap();
        next += 1;
        let alias = store.move_alias("t", "mine", number, None).await.unwrap();
        println!("{MARK}alias {} {number}", alias.revision);
    }
}

#[tokio::test]
async fn uploads_and_moves_survive_kills() {
    let folder = tempdir().unwrap();
    let (mut versions, mut revisions) = (BTreeMap::new(), BTreeMap::new());
    for (kills, moment) in (1..).zip(moments(KILLS, 0..120_000)) {
        let child = command("child_uploads_and_moves", folder.path()).spawn().unwrap();
        for line in kill_after(child, moment) {
            match line.split(' ').collect::<Vec<_>>()[..] {
                ["version", number, digest] => {
                    let known = versions.insert(number.parse::<u32>().unwrap(), digest.to_owned());
                    assert_eq!(known, None, "a number was given out twice");
                }
                ["alias", revision, number] => {
                    revisions.insert(revision.parse::<u64>().unwrap(), number.parse::<u32>().unwrap());
                }
                _ => panic!("{line}"),
            }
        }
        let store = EmbeddedStore::open(folder.path()).unwrap();
        check_uploads(&store, &versions, &revisions).await;
        let there = store.versions().await.unwrap().len();
        assert!(there <= versions.len() + kills, "more than one upload for each kill was not acknowledged");
    }
    assert!(!EmbeddedStore::open(folder.path()).unwrap().list(BlobKind::Derived).await.unwrap().is_empty());
    assert!(versions.len() > KILLS as usize, "only {} uploads were acknowledged", versions.len());
    assert_eq!(std::fs::read_dir(folder.path().join("blobs/tmp")).unwrap().count(), 0);
}

/// Whether everything acknowledged is there, and everything there is whole.
async fn check_uploads(
    store: &EmbeddedStore,
    versions: &BTreeMap<u32, String>,
    revisions: &BTreeMap<u64, u32>,
) {
    let there = store.versions().await.unwrap();
    for (number, digest) in versions {
        assert_eq!(&there[*number as usize - 1].digest, digest);
    }
    for version in &there {
        store.get(BlobKind::Payload, &version.digest).await.unwrap();
    }
    for (key, size) in store.list(BlobKind::Derived).await.unwrap() {
        assert_eq!(size as usize, DERIVED, "{key} is half written");
    }
    let alias = store.aliases().await.unwrap().pop();
    if let (Some((revision, number)), Some(alias)) = (revisions.last_key_value(), alias) {
        assert!(alias.revision >= *revision);
        assert!(alias.revision > *revision || alias.number == *number);
    }
}

#[tokio::test]
async fn child_first_start() {
    let Some(folder) = child::folder() else { return };
    let shipped = ltc_tables::shipped().unwrap();
    println!("{MARK}ready");
    let store = EmbeddedStore::open(&folder).unwrap();
    seed(&store, &store, &shipped, &|_| None).await.unwrap();
    println!("{MARK}done");
}

#[tokio::test]
async fn a_first_start_that_was_killed_is_completed_by_the_next() {
    let shipped = ltc_tables::shipped().unwrap();
    let wanted: usize = shipped.names().map(|name| shipped.versions(name).unwrap().count()).sum();
    let (mut none, mut some, mut all) = (0, 0, 0);
    for moment in moments(KILLS, 0..150_000) {
        let folder = tempdir().unwrap();
        kill_after(command("child_first_start", folder.path()).spawn().unwrap(), moment);
        let store = EmbeddedStore::open(folder.path()).unwrap();
        let before = store.versions().await.unwrap().len();
        match before {
            0 => none += 1,
            n if n < wanted => some += 1,
            _ => all += 1,
        }
        let added = seed(&store, &store, &shipped, &|_| None).await.unwrap();
        assert_eq!(before + added as usize, wanted);
        check_seeds(&store, folder.path(), wanted).await;
    }
    let folder = tempdir().unwrap();
    child::assert_passed(&command("child_first_start", folder.path()).output().unwrap());
    check_seeds(&EmbeddedStore::open(folder.path()).unwrap(), folder.path(), wanted).await;
    assert!(none > 0 && some > 0, "the moments miss the start: {none} before, {some} within, {all} after");
}

async fn check_seeds(store: &EmbeddedStore, folder: &Path, wanted: usize) {
    let versions = store.versions().await.unwrap();
    assert_eq!(versions.len(), wanted);
    for version in &versions {
        store.get(BlobKind::Payload, &version.digest).await.unwrap();
    }
    for alias in store.aliases().await.unwrap() {
        let newest = versions.iter().filter(|v| v.table == alias.table).map(|v| v.number).max();
        assert_eq!(Some(alias.number), newest, "{}", alias.table);
    }
    assert_eq!(std::fs::read_dir(folder.join("blobs/tmp")).unwrap().count(), 0);
}
