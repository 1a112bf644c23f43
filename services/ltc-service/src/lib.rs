//! The HTTP service that hands out versioned LTC tables.
//!
//! [`app`] is the router over an [`AppState`]; [`serve`] binds an address and runs it until SIGINT or SIGTERM.
//!
//! ```no_run
//! use ltc_service::{ServeConfig, serve};
//!
//! # async fn run(catalogue: ltc_table::Catalogue) -> Result<(), ltc_service::ServeError> {
//! serve(ServeConfig::default(), catalogue, |address| println!("http://{address}")).await
//! # }
//! ```
//!
//! # Routes
//! | route | gives |
//! |---|---|
//! | `GET /` | a page that lists the tables and these routes |
//! | `GET /healthz` | 200 while the process answers |
//! | `GET /readyz` | 200 when there is a table to serve, else 503 |
//! | `GET /v1/tables` | every table with its versions |
//! | `GET /v1/tables/{name}` | the manifest of the latest version, with `latest` and `versions` |
//! | `GET /v1/tables/{name}/versions` | number, digest and date of each version |
//! | `GET /v1/tables/{name}/versions/{version}` | the manifest |
//! | `GET …/{version}/data?format=&precision=&channels=&alpha=&lambda=&theta=` | the table; see [`Variant`] |
//! | `GET …/{version}/fresnel?format=&precision=` | the magnitude and Fresnel channels alone |
//! | `GET …/{version}/lookup?theta=&phi=&alpha_x=&alpha_y=` | what the table says about one query |
//! | `POST …/{version}/lookup` | the same for a JSON array of queries; an array of the same length and order |
//!
//! `{version}` is a number, a digest (`sha256:<hex>`) or `latest`.
//!
//! # Caching
//! The strong `ETag` of every 200 is `"sha256:<hex>"` of its body; for the default form of `data` that is the
//! table's digest. Table data and manifests addressed by digest or number are `immutable`; addressed by `latest`, as
//! lists and lookups, they may be kept for a minute. `x-table-version` and `x-table-digest` say which version
//! answered.
//!
//! # Errors
//! Every error is `application/problem+json` (RFC 9457); [`ApiError`] lists the types.

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
mod index;
mod json_table;
mod metrics;
mod openapi;
mod params;
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
mod state;
mod stop;
mod stores;
mod uploaded;
mod variant;

pub use error::ApiError;
pub use problem_types::ProblemType;
pub use router::app;
pub use serve::{ServeError, serve, serve_until};
pub use settings::{Limits, Settings};
pub use state::AppState;
pub use stop::Stop;
pub use stores::Stores;
pub use variant::{Format, Variant};
