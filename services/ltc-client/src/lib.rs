//! A client of the table service.
//!
//! ```no_run
//! use ltc_client::{Client, Data};
//!
//! # fn run() -> Result<(), ltc_client::ClientError> {
//! let client = Client::new("http://127.0.0.1:8787").with_cache("cache".as_ref());
//! // Verified against its digest, and from now on there without a network.
//! let version = client.table("ggx-anisotropic", "stable")?;
//! println!("{}", version.manifest().digest);
//! let texture = client.data("ggx-anisotropic", "stable", &Data { format: "ktx2", ..Data::default() })?;
//! # Ok(())
//! # }
//! ```
//!
//! Calls block. What comes back is never taken on trust: a payload must have the digest of its manifest, a manifest fetched by
//! digest must name it. With the feature `tls` URLs may begin with `https`, and
//! `Client::with_authorities` says whose certificates count.

mod cache;
mod client;
mod error;
mod refit;

pub use cache::Cache;
pub use client::{Client, Data, TableSummary};
pub use error::ClientError;
pub use ltc_table::{Lookup, Manifest, Query, TableVersion};
pub use refit::{Refit, RefitRequest};
