//! The three interfaces that everything here is kept behind.

use std::sync::Arc;

use ltc_store::{Blobs, Jobs, Metadata};

/// A store, by what it is asked for. One thing may be all three.
#[derive(Clone)]
pub struct Stores {
    /// Versions, aliases, tokens, benchmarks.
    pub metadata: Arc<dyn Metadata>,
    /// Payloads and files made of them.
    pub blobs: Arc<dyn Blobs>,
    /// Refits.
    pub jobs: Arc<dyn Jobs>,
}

impl Stores {
    /// One store that is all three.
    pub fn of<S: Metadata + Blobs + Jobs + 'static>(store: Arc<S>) -> Self {
        Self { metadata: Arc::clone(&store) as _, blobs: Arc::clone(&store) as _, jobs: store }
    }
}

impl std::fmt::Debug for Stores {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Stores { .. }")
    }
}
