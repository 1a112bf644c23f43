//! Whether the service lives, and whether it can do its work.

use std::time::Duration;

use axum::Json;
use axum::extract::State;
use axum::http::{HeaderName, header};
use ltc_store::BlobKind;
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

/// How long the store may take to say that it is there.
const PATIENCE: Duration = Duration::from_secs(2);

/// 200 when the store answers, there is a table to serve, and the service is not about to stop.
pub(crate) async fn ready(
    State(state): State<AppState>,
) -> Result<([(HeaderName, &'static str); 1], Json<Ready>), ApiError> {
    let not = |reason: &str| ApiError::NotReady { reason: reason.to_owned() };
    if *state.stopping().borrow() {
        return Err(not("the service is about to stop"));
    }
    let ping = tokio::time::timeout(PATIENCE, state.stores().metadata.ping());
    match ping.await {
        Ok(Ok(())) => {}
        Ok(Err(error)) => {
            tracing::warn!(%error, "the store does not answer");
            return Err(not("the store does not answer"));
        }
        Err(_) => return Err(not("the store does not answer in time")),
    }
    let index = state.index();
    let tables = index.names().count();
    // Any payload stands for all: they lie in one place.
    let Some(manifest) = index.names().find_map(|name| index.table(name).ok()?.latest()) else {
        return Err(not("there is no table to serve"));
    };
    let blobs = &state.stores().blobs;
    match tokio::time::timeout(PATIENCE, blobs.contains(BlobKind::Payload, &manifest.digest)).await {
        Ok(Ok(true)) => Ok((NO_STORE, Json(Ready { status: "ready", tables }))),
        found => {
            tracing::warn!(?found, digest = manifest.digest, "the store has lost a payload");
            Err(not("the store does not have the tables' payloads"))
        }
    }
}
