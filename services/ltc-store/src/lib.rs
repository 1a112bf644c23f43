//! What the table service keeps, behind three narrow interfaces: [`Metadata`] (versions, aliases, tokens, benchmarks), [`Blobs`]
//! (payloads and checkpoints by digest) and [`Jobs`] (refits). Blobs never change, so that one store may be copied while it is
//! used; what changes is in the metadata, where every change is one transaction.
//!
//! The embedded store keeps all of it in one folder: SQLite and files. A PostgreSQL database and an S3 bucket fit the same
//! interfaces: nothing here hands out paths, connections or locks.

mod blobs;
mod error;
mod jobs;
mod metadata;

pub use blobs::{BlobKind, Blobs};
pub use error::StoreError;
pub use jobs::{Claim, Event, EventKind, Job, JobState, Jobs, NewJob, Outcome, ShardReport};
pub use metadata::{
    Alias, Benchmark, BenchmarkFilter, Metadata, NewVersion, Scope, StoredVersion, Token, TokenHash,
    VersionState,
};
