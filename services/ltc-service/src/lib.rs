//! The HTTP service that hands out versioned LTC tables, takes in others, fits new ones, and keeps benchmark history.
//!
//! [`AppState`] is the service over [`Stores`]; [`app`] is its router, to be asked without a connection; [`serve`] binds an address
//! and runs it until SIGINT or SIGTERM. [`settings`] says what can be configured, and from where.
//!
//! ```no_run
//! use std::sync::Arc;
//!
//! use ltc_service::{AppState, Settings, Stores, serve};
//! use ltc_store::EmbeddedStore;
//!
//! # async fn run() -> Result<(), Box<dyn std::error::Error>> {
//! let store = EmbeddedStore::open("data".as_ref())?;
//! let state = AppState::new(Stores::of(Arc::new(store)), Settings::default()).await?;
//! serve(state, |address| println!("http://{address}")).await?;
//! # Ok(())
//! # }
//! ```
//!
//! The routes are in `router.rs`, described at `/openapi.json`, and explained in `docs/http.md`. How a request goes:
//! 1. `gate.rs` names it, finds out who asks, counts it, and answers at once what was answered before (`answers.rs`).
//! 2. A handler in `routes` reads the index (`index.rs`, all metadata in memory) and tables (from the store, kept in memory), and
//!    leaves what takes more than a moment to other threads (`compute.rs`, `background.rs`).
//! 3. `representation.rs` gives bytes their tag, their compressed form, and the parts and conditions that were asked for.
//! 4. Back in the gate, every error becomes a problem document (`problem.rs`), and the answer is counted and logged.
//!
//! Errors are [`ApiError`]; the one place where they become statuses is in `error.rs`.

mod answers;
mod auth;
mod background;
mod binary_lookup;
mod cache;
mod compute;
mod derived;
mod error;
mod etag;
mod gate;
mod headers;
mod history;
mod index;
mod json_table;
mod loops;
mod memory;
mod metrics;
mod openapi;
mod params;
mod patience;
mod preconditions;
mod problem;
mod problem_types;
mod range;
mod rates;
mod representation;
mod request_body;
mod request_id;
mod router;
mod routes;
mod selected;
mod serve;
pub mod settings;
mod shaders;
mod state;
mod stop;
mod stores;
mod uploaded;
mod variant;

pub use error::ApiError;
pub use memory::share_heaps;
pub use problem_types::ProblemType;
pub use router::app;
pub use serve::{ServeError, serve, serve_until};
pub use settings::{Limits, Settings};
pub use shaders::{ShaderFile, ShaderRefusal, ShaderSource};
pub use state::AppState;
pub use stop::Stop;
pub use stores::Stores;
pub use variant::{Format, Variant};
