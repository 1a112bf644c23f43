//! Both implementations pass every suite.

#![expect(clippy::unwrap_used, reason = "helpers of tests panic at what is wrong")]

use std::sync::{Arc, Mutex};

use ltc_store::{EmbeddedStore, MemoryStore, conformance};

/// Makes embedded stores in folders that last as long as this.
#[derive(Default)]
struct Folders(Mutex<Vec<tempfile::TempDir>>);

impl Folders {
    fn store(&self) -> Arc<EmbeddedStore> {
        let folder = tempfile::tempdir().unwrap();
        let store = EmbeddedStore::open(folder.path()).unwrap();
        self.0.lock().unwrap().push(folder);
        Arc::new(store)
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn metadata_in_memory() {
    conformance::metadata(&|| Arc::new(MemoryStore::default())).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn metadata_embedded() {
    let folders = Folders::default();
    conformance::metadata(&|| folders.store()).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn blobs_in_memory() {
    conformance::blobs(&|| Arc::new(MemoryStore::default())).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn blobs_embedded() {
    let folders = Folders::default();
    conformance::blobs(&|| folders.store()).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn jobs_in_memory() {
    conformance::jobs(&|| Arc::new(MemoryStore::default())).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn jobs_embedded() {
    let folders = Folders::default();
    conformance::jobs(&|| folders.store()).await;
}
