//! A request's body, within limits of size and time.

use axum::body::{Bytes, HttpBody};
use axum::extract::{FromRequest, Request};
use axum::http::{HeaderMap, header};
use serde::de::DeserializeOwned;

use crate::{ApiError, AppState};

/// The media type of a body without its parameters, in lower case; `None` where there is no header.
pub(crate) fn media_type(headers: &HeaderMap) -> Option<String> {
    let value = headers.get(header::CONTENT_TYPE)?;
    let essence = value.to_str().unwrap_or_default().split(';').next().unwrap_or_default().trim();
    Some(essence.to_ascii_lowercase())
}

/// Whether a body calls itself JSON, or nothing at all.
pub(crate) fn may_be_json(media_type: Option<&str>) -> bool {
    media_type.is_none_or(|essence| {
        essence == "application/json" || (essence.starts_with("application/") && essence.ends_with("+json"))
    })
}

/// Refuses a body that says it is too large before any of it is read, and before a client that asks first is told to send it.
pub(crate) fn check_length(request: &Request, limit: usize) -> Result<(), ApiError> {
    let least = request.body().size_hint().lower();
    if least > limit as u64 { Err(ApiError::BodyTooLarge { limit }) } else { Ok(()) }
}

/// A body and what it calls itself.
pub(crate) struct Body {
    pub bytes: Bytes,
    pub media_type: Option<String>,
}

impl FromRequest<AppState> for Body {
    type Rejection = ApiError;

    async fn from_request(request: Request, state: &AppState) -> Result<Self, ApiError> {
        let media_type = media_type(request.headers());
        let limits = state.limits();
        check_length(&request, limits.body_bytes)?;
        let body = tokio::time::timeout(limits.body_time(), Bytes::from_request(request, state));
        let body = body.await.map_err(|_| ApiError::BodyTimeout)?;
        let bytes = body.map_err(|rejection| ApiError::body(&rejection, limits.body_bytes))?;
        Ok(Self { bytes, media_type })
    }
}

/// A JSON body of a known form.
pub(crate) struct JsonBody<T>(pub T);

impl<T: DeserializeOwned> FromRequest<AppState> for JsonBody<T> {
    type Rejection = ApiError;

    async fn from_request(request: Request, state: &AppState) -> Result<Self, ApiError> {
        if !may_be_json(media_type(request.headers()).as_deref()) {
            return Err(ApiError::WrongMediaType { expected: "application/json" });
        }
        let body = Body::from_request(request, state).await?;
        from_json(&body.bytes).map(Self)
    }
}

/// Reads JSON: what is none is malformed, what has another form is invalid.
pub(crate) fn from_json<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, ApiError> {
    serde_json::from_slice(bytes).map_err(|error| {
        if error.is_data() {
            ApiError::invalid("body", format!("is not what is asked for: {error}"))
        } else {
            ApiError::malformed(None, format!("the body is not JSON: {error}"))
        }
    })
}
