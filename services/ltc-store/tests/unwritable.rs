//! A device that is full, and a folder that may not be written to: clear errors, and reads go on.
#![cfg(unix)]
#![expect(clippy::unwrap_used, reason = "helpers of tests panic at what is wrong")]

mod child;

use std::fs::{self, Permissions};
use std::os::unix::fs::PermissionsExt;
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::Command;

use ltc_store::{
    BlobKind, Blobs, EmbeddedStore, Jobs, Metadata, NewJob, NewVersion, StoreError, VersionState,
};
use serde_json::json;
use tempfile::tempdir;

fn version(digest: &str) -> NewVersion {
    NewVersion {
        table: "t".to_owned(),
        digest: digest.to_owned(),
        manifest: json!({}),
        state: VersionState::Published,
        spec_digest: None,
        reason: None,
    }
}

fn job() -> NewJob {
    NewJob {
        table: "t".to_owned(),
        spec: json!({}),
        spec_digest: String::new(),
        priority: 0,
        alias: None,
        idempotency: None,
    }
}

async fn fill(store: &EmbeddedStore) {
    store.put(BlobKind::Payload, "payload", b"bytes").await.unwrap();
    store.put(BlobKind::Derived, "derived", b"bytes").await.unwrap();
    store.add_version(version("x"), Some(("latest", None))).await.unwrap();
    store.enqueue(job(), 9).await.unwrap();
}

/// That everything of [`fill`] can be read.
async fn check_reads(store: &EmbeddedStore) {
    assert_eq!(store.get(BlobKind::Payload, "payload").await.unwrap(), b"bytes");
    assert_eq!(store.get(BlobKind::Derived, "derived").await.unwrap(), b"bytes");
    assert_eq!(store.version("t", 1).await.unwrap().digest, "x");
    assert_eq!(store.aliases().await.unwrap().len(), 1);
    assert_eq!(store.jobs(9).await.unwrap().len(), 1);
    store.ping().await.unwrap();
}

fn is_unwritable<T>(result: Result<T, StoreError>) {
    match result {
        Err(StoreError::Unwritable { reason }) => assert!(!reason.is_empty()),
        Err(other) => panic!("{other}"),
        Ok(_) => panic!("it was written"),
    }
}

/// Runs under a limit of the size of files.
#[tokio::test]
async fn child_without_room() {
    let Some(folder) = child::folder() else { return };
    let store = EmbeddedStore::open(&folder).unwrap();
    is_unwritable(store.put(BlobKind::Payload, "large", &[1; 2_000_000]).await);
    is_unwritable(store.put(BlobKind::Derived, "large", &[1; 2_000_000]).await);
    is_unwritable(store.put(BlobKind::Checkpoint, "large", &[1; 2_000_000]).await);
    let large = NewVersion { manifest: json!({ "x": "y".repeat(2_000_000) }), ..version("large") };
    is_unwritable(store.add_version(large, None).await);
    check_reads(&store).await;
    assert!(!store.contains(BlobKind::Payload, "large").await.unwrap());
    assert_eq!(store.versions().await.unwrap().len(), 1, "nothing of it was kept");
    assert_eq!(fs::read_dir(folder.join("blobs/tmp")).unwrap().count(), 0, "what was half written is gone");
    // What fits is still taken.
    store.put(BlobKind::Payload, "small", b"small").await.unwrap();
    store.add_version(version("small"), None).await.unwrap();
}

#[tokio::test]
async fn without_room_there_are_clear_errors_and_reads_go_on() {
    let folder = tempdir().unwrap();
    fill(&EmbeddedStore::open(folder.path()).unwrap()).await;
    // The shell sets what no safe code here can: 512 KiB a file, and the signal of going beyond ignored.
    let mut shell = Command::new("sh");
    let script = "trap '' XFSZ; ulimit -f 1024; exec \"$0\" \"$@\"";
    shell.args(["-c", script]).arg(std::env::current_exe().unwrap());
    let output = child::with(shell, "child_without_room", folder.path()).output().unwrap();
    child::assert_passed(&output);
    let store = EmbeddedStore::open(folder.path()).unwrap();
    check_reads(&store).await;
    assert_eq!(store.versions().await.unwrap().len(), 2);
}

/// Runs where nothing may be written.
#[tokio::test]
async fn child_read_only() {
    let Some(folder) = child::folder() else { return };
    let store = EmbeddedStore::open(&folder).unwrap();
    assert!(!store.is_writable());
    check_reads(&store).await;
    is_unwritable(store.put(BlobKind::Payload, "new", b"x").await);
    is_unwritable(store.delete(BlobKind::Payload, "payload").await);
    is_unwritable(store.add_version(version("y"), None).await);
    is_unwritable(store.move_alias("t", "latest", 1, None).await);
    is_unwritable(store.enqueue(job(), 9).await);
    is_unwritable(store.claim("w", std::time::Duration::from_secs(1)).await);
    check_reads(&store).await;
    is_unwritable(EmbeddedStore::open(&folder.join("new")));
}

#[tokio::test]
async fn a_read_only_folder_is_served_and_not_written() {
    let folder = tempdir().unwrap();
    fill(&EmbeddedStore::open(folder.path()).unwrap()).await;
    assert!(!folder.path().join("ltc.sqlite-wal").exists(), "the log went when the store was closed");
    serve_read_only(folder.path());
}

#[tokio::test]
async fn so_is_one_whose_process_was_killed() {
    let folder = tempdir().unwrap();
    let store = EmbeddedStore::open(folder.path()).unwrap();
    fill(&store).await;
    // As after a kill, changes are in the log alone.
    assert!(folder.path().join("ltc.sqlite-wal").metadata().unwrap().len() > 0);
    serve_read_only(folder.path());
    drop(store);
}

fn serve_read_only(folder: &Path) {
    /// Somebody who owns nothing.
    const NOBODY: u32 = 65534;
    set_modes(folder, 0o555, 0o444);
    let mut command = child::command("child_read_only", folder);
    let is_root = fs::write(folder.join("probe"), "").is_ok();
    if is_root {
        // To the superuser nothing is read-only: the child is somebody else.
        command.uid(NOBODY).gid(NOBODY);
    }
    let output = command.output();
    set_modes(folder, 0o755, 0o644);
    match output {
        Ok(output) => child::assert_passed(&output),
        Err(error) => {
            assert!(is_root, "{error}");
            println!("skipped: run as root, and nobody cannot run this program: {error}");
        }
    }
}

fn set_modes(path: &Path, folder: u32, file: u32) {
    if path.is_dir() {
        // Writable first, so that what is inside can be reached.
        for entry in fs::read_dir(path).unwrap() {
            set_modes(&entry.unwrap().path(), folder, file);
        }
        fs::set_permissions(path, Permissions::from_mode(folder)).unwrap();
    } else {
        fs::set_permissions(path, Permissions::from_mode(file)).unwrap();
    }
}
