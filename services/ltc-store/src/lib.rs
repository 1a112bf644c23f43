//! What the table service keeps, behind three narrow interfaces: [`Metadata`] (versions, aliases, tokens, benchmarks), [`Blobs`]
//! (payloads and checkpoints by digest) and [`Jobs`] (refits). Blobs never change, so that one store may be copied while it is
//! used; what changes is in the metadata, where every change is one transaction.
//!
//! The embedded store keeps all of it in one folder: SQLite and files. A PostgreSQL database and an S3 bucket fit the same
//! interfaces: nothing here hands out paths, connections or locks.

mod blobs;
mod clock;
#[cfg(feature = "testing")]
pub mod conformance;
mod embedded;
mod error;
mod jobs;
mod key;
#[cfg(feature = "testing")]
mod memory;
mod metadata;
mod secret;
mod seed;

pub use blobs::{BlobKind, Blobs};
pub use embedded::{Contents, EmbeddedStore, back_up, restore};
pub use error::StoreError;
pub use jobs::{Claim, Event, EventKind, Job, JobState, Jobs, MAX_BARREN, NewJob, Outcome, ShardReport};
#[cfg(feature = "testing")]
pub use memory::MemoryStore;
pub use metadata::{
    Alias, Benchmark, BenchmarkFilter, Metadata, NewVersion, Scope, StoredVersion, Token, TokenHash,
    VersionState,
};
pub use secret::Secret;
pub use seed::{LATEST, SEEDED_ALIASES, seed};
