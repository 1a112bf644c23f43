//! Whether the service lives, and whether it can do its work.

use axum::Json;
use axum::extract::State;
use axum::http::{HeaderName, header};
use serde::Serialize;

use crate::{ApiError, AppState};

const NO_STORE: [(HeaderName, &str); 1] = [(header::CACHE_CONTROL, "no-store")];

#[derive(Serialize)]
pub(crate) struct Alive {
    status: &'static str,
    version: &'static str,
}

/// 200 while the process answers at all.
pub(crate) async fn alive() -> ([(HeaderName, &'static str); 1], Json<Alive>) {
    (NO_STORE, Json(Alive { status: "ok", version: env!("CARGO_PKG_VERSION") }))
}

#[derive(Serialize)]
pub(crate) struct Ready {
    status: &'static str,
    tables: usize,
}

/// 200 when there is a table to serve. Tables are checked against their digests before they enter the catalogue.
pub(crate) async fn ready(
    State(state): State<AppState>,
) -> Result<([(HeaderName, &'static str); 1], Json<Ready>), ApiError> {
    match state.catalogue().names().count() {
        0 => Err(ApiError::NotReady),
        tables => Ok((NO_STORE, Json(Ready { status: "ready", tables }))),
    }
}
