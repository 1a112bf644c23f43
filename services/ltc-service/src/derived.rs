//! Files made of tables: made once, kept in memory and in the store. Each bounds what it holds.

use std::sync::Arc;

use axum::body::Bytes;
use ltc_store::{BlobKind, Blobs};
use ltc_table::digest::{digest, is_digest};

use crate::ApiError;
use crate::cache::Cache;
use crate::compute::Compute;
use crate::metrics::Metrics;
use crate::representation::Tagged;

/// The cache of made files. A key says everything that their bytes depend on.
pub(crate) struct Derived {
    blobs: Arc<dyn Blobs>,
    memory: Cache<String, Tagged>,
}

impl std::fmt::Debug for Derived {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Derived").field("memory", &self.memory.bytes()).finish_non_exhaustive()
    }
}

/// A name for the store: the program's version, since another may encode differently, and a digest of the rest.
fn blob_key(key: &str) -> String {
    let digest = digest(key.as_bytes());
    format!("{}-{}", env!("CARGO_PKG_VERSION").to_ascii_lowercase(), digest.trim_start_matches("sha256:"))
}

impl Derived {
    pub(crate) fn new(blobs: Arc<dyn Blobs>, memory: usize) -> Arc<Self> {
        Arc::new(Self { blobs, memory: Cache::new(memory) })
    }

    /// The file of that key: from memory, from the store, or made now.
    pub(crate) async fn get(
        self: &Arc<Self>,
        key: &str,
        compute: &Compute,
        metrics: &Metrics,
        make: impl FnOnce() -> Result<Vec<u8>, ApiError> + Send + 'static,
    ) -> Result<Tagged, ApiError> {
        if let Some(known) = self.memory.get(key) {
            metrics.cache_hits.add(1);
            return Ok(known);
        }
        if let Some(known) = self.stored(key, compute).await {
            metrics.store_hits.add(1);
            return Ok(known);
        }
        let (this, owned) = (Arc::clone(self), key.to_owned());
        let (made, new) = compute
            .run(move || {
                // Whoever waited for a processor may find that the one before it did the work.
                if let Some(known) = this.memory.get(&owned) {
                    return Ok((known, false));
                }
                let made = Tagged::new(make()?);
                this.memory.insert(owned, made.clone(), made.bytes.len());
                Ok::<_, ApiError>((made, true))
            })
            .await??;
        if new {
            metrics.cache_misses.add(1);
            let (this, key, made) = (Arc::clone(self), blob_key(key), made.clone());
            // The answer does not wait for it, nor depend on it: a full disk makes things slower, not wrong.
            tokio::spawn(async move {
                if let Err(error) = this.blobs.put(BlobKind::Derived, &key, &sealed(&made)).await {
                    tracing::warn!(%error, "a file made of a table is not kept");
                }
            });
        }
        Ok(made)
    }

    /// Bytes in memory.
    pub(crate) fn bytes(&self) -> usize {
        self.memory.bytes()
    }

    async fn stored(&self, key: &str, compute: &Compute) -> Option<Tagged> {
        let name = blob_key(key);
        let blob = self.blobs.get(BlobKind::Derived, &name).await.ok()?;
        let read = compute.run(move || unsealed(blob)).await.ok()?;
        match read {
            Some(tagged) => {
                self.memory.insert(key.to_owned(), tagged.clone(), tagged.bytes.len());
                Some(tagged)
            }
            None => {
                tracing::warn!(blob = name, "a file made of a table is damaged and made anew");
                let _ = self.blobs.delete(BlobKind::Derived, &name).await;
                None
            }
        }
    }
}

/// With a line before it that says its digest.
fn sealed(file: &Tagged) -> Vec<u8> {
    [digest(&file.bytes).as_bytes(), b"\n", &file.bytes].concat()
}

/// What was sealed; `None` when it is not what it was.
fn unsealed(blob: Vec<u8>) -> Option<Tagged> {
    let line = blob.iter().position(|b| *b == b'\n')?;
    let stated = std::str::from_utf8(&blob[..line]).ok().filter(|text| is_digest(text))?.to_owned();
    let file = Tagged::new_bytes(Bytes::from(blob).slice(line + 1..));
    (file.etag == crate::etag::ETag::of_digest(&stated)).then_some(file)
}

#[cfg(test)]
mod tests {
    use ltc_store::MemoryStore;

    use super::*;

    struct Fixture {
        store: Arc<MemoryStore>,
        compute: Compute,
        metrics: Metrics,
    }

    impl Fixture {
        fn new() -> Self {
            let store = Arc::new(MemoryStore::default());
            Self { store, compute: Compute::on_every_processor(8), metrics: Metrics::default() }
        }

        fn derived(&self) -> Arc<Derived> {
            Derived::new(Arc::clone(&self.store) as _, 1 << 20)
        }

        async fn get(&self, derived: &Arc<Derived>, key: &str, made: &'static [u8]) -> Bytes {
            let make = move || Ok(made.to_vec());
            derived.get(key, &self.compute, &self.metrics, make).await.unwrap().bytes
        }

        /// Waits for what is kept in the background.
        async fn stored(&self, count: usize) -> Vec<(String, u64)> {
            for _ in 0..1000 {
                let list = self.store.list(BlobKind::Derived).await.unwrap();
                if list.len() == count {
                    return list;
                }
                tokio::time::sleep(std::time::Duration::from_millis(2)).await;
            }
            panic!("{:?}", self.store.list(BlobKind::Derived).await)
        }
    }

    #[tokio::test]
    async fn a_file_is_made_once_and_found_by_the_next_process() {
        let fixture = Fixture::new();
        let first = fixture.derived();
        assert_eq!(fixture.get(&first, "a", b"made").await, "made");
        assert_eq!(fixture.get(&first, "a", b"made again").await, "made", "from memory");
        fixture.stored(1).await;
        assert_eq!(fixture.get(&fixture.derived(), "a", b"made anew").await, "made", "from the store");
        assert_eq!(fixture.get(&first, "b", b"other").await, "other");
    }

    #[tokio::test]
    async fn a_damaged_file_is_made_anew() {
        let fixture = Fixture::new();
        let mut damaged = sealed(&Tagged::new(b"made".to_vec()));
        *damaged.last_mut().unwrap() ^= 1;
        fixture.store.put(BlobKind::Derived, &blob_key("a"), &damaged).await.unwrap();
        assert_eq!(fixture.get(&fixture.derived(), "a", b"made").await, "made");
    }
}
