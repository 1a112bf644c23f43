//! What every implementation of an interface must do: one suite for each. A suite gets a maker of fresh, empty stores and
//! panics at the first thing that is not so.
//!
//! ```no_run
//! # async fn run() {
//! use std::sync::Arc;
//! use ltc_store::{MemoryStore, conformance};
//!
//! conformance::jobs(&|| Arc::new(MemoryStore::default())).await;
//! # }
//! ```
#![expect(clippy::unwrap_used, reason = "a suite is a test: it panics at what is wrong")]

mod blobs;
mod jobs;
mod metadata;

pub use blobs::blobs;
pub use jobs::jobs;
pub use metadata::metadata;

use crate::StoreError;

/// The kind of an error, for comparisons.
fn kind<T: std::fmt::Debug>(result: Result<T, StoreError>) -> &'static str {
    match result {
        Ok(_) => "ok",
        Err(StoreError::NotFound { .. }) => "not found",
        Err(StoreError::Conflict { .. }) => "conflict",
        Err(StoreError::Full { .. }) => "full",
        Err(StoreError::Unwritable { .. }) => "unwritable",
        Err(_) => "another",
    }
}
