//! A request's JSON body, within limits of size and time.

use axum::body::Bytes;
use axum::extract::{FromRequest, Request};
use axum::http::{HeaderMap, header};

use crate::{ApiError, AppState};

/// The bytes of a body that calls itself JSON, or nothing at all.
pub(crate) struct JsonBytes(pub Bytes);

impl FromRequest<AppState> for JsonBytes {
    type Rejection = ApiError;

    async fn from_request(request: Request, state: &AppState) -> Result<Self, ApiError> {
        if !may_be_json(request.headers()) {
            return Err(ApiError::NotJson);
        }
        let limits = state.limits();
        let body = tokio::time::timeout(limits.body_time, Bytes::from_request(request, state));
        let body = body.await.map_err(|_| ApiError::BodyTimeout)?;
        body.map(Self).map_err(|rejection| ApiError::body(&rejection, limits.body_bytes))
    }
}

fn may_be_json(headers: &HeaderMap) -> bool {
    let Some(value) = headers.get(header::CONTENT_TYPE) else { return true };
    let essence = value.to_str().unwrap_or_default().split(';').next().unwrap_or_default().trim();
    let essence = essence.to_ascii_lowercase();
    essence == "application/json" || (essence.starts_with("application/") && essence.ends_with("+json"))
}
