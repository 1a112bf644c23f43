//! Refits: fits asked for over the network, run as durable jobs beside a service that goes on answering.
//!
//! [`Refits`] takes requests in ([`Refits::request`]) and runs them ([`Refits::start`]) on three interfaces of
//! [`ltc_store`]: jobs, metadata and blobs. It holds to this:
//!
//! - A specification is refused at once where a field makes no sense or the fit would take more memory or time than it may
//!   ([`RefitError`]); nobody finds that out from a job.
//! - The same specification gives the same version: one that is there already is the answer, whoever asks.
//! - Work is done in shards of [`RefitConfig::shard`]. At the end of each the state of the fit is kept as a blob, so that a
//!   kill loses one shard, and the table is the same to the last bit however often that happens. Some work can
//!   only be done in one piece, such as entries that start from each other; specifications whose longest piece would take long
//!   are refused, too ([`RefitConfig::piece_seconds`]).
//! - Threads that fit have the lowest priority: requests get the cores first.
//! - A result is published in this order: payload, version, alias, end of the job. A kill in between leaves what the next
//!   attempt finds and completes. The alias stays where the new version is worse on the standard draw than the one it points
//!   at, unless the request forces it.
//! - A worker that was given up for dead can neither report nor publish any more: its claim has a number that the store
//!   checks.
//!
//! ```no_run
//! # async fn run() -> Result<(), Box<dyn std::error::Error>> {
//! use std::sync::Arc;
//! use ltc_refit::{Ask, RefitConfig, Refits};
//! use ltc_store::EmbeddedStore;
//!
//! let store = Arc::new(EmbeddedStore::open("data".as_ref())?);
//! let refits = Refits::new(store.clone(), store.clone(), store, RefitConfig::default());
//! let workers = refits.start();
//! let spec = serde_json::json!({ "preset": "ggx-isotropic", "joint": { "steps": 400 } });
//! let (job, _) = refits.request(Ask { alias: Some("latest".to_owned()), ..Ask::new(spec) }).await?;
//! println!("{}", job.id);
//! workers.stop().await;
//! # Ok(())
//! # }
//! ```

mod checkpoints;
mod config;
mod error;
mod fitting;
mod live;
mod metrics;
mod priority;
mod publish;
mod refits;
mod run;
mod spec;
mod worker;

pub use config::RefitConfig;
pub use error::RefitError;
pub use metrics::RefitMetrics;
pub use refits::{Ask, Refits};
pub use spec::{Checked, check, spec_digest};
pub use worker::Workers;
