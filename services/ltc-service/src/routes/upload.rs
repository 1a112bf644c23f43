//! Tables made elsewhere.

use axum::extract::multipart::MultipartError;
use axum::extract::{FromRequest, Multipart, Request, State};
use axum::http::{HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use ltc_store::{BlobKind, NewVersion, StoredVersion, VersionState};
use ltc_table::check_name;
use ltc_table::digest::digest;
use serde_json::Value;

use crate::auth::Publisher;
use crate::request_body::{check_length, media_type};
use crate::routes::tables::manifest_json;
use crate::selected::TableName;
use crate::uploaded::{Checked, Uploaded, check};
use crate::{ApiError, AppState, background};

/// `multipart/form-data` with the parts `manifest` (JSON) and `payload` (NPZ).
pub(crate) struct Form(Uploaded);

const EXPECTED: &str = "multipart/form-data with the parts manifest (JSON) and payload (NPZ)";

impl FromRequest<AppState> for Form {
    type Rejection = ApiError;

    async fn from_request(request: Request, state: &AppState) -> Result<Self, ApiError> {
        if media_type(request.headers()).as_deref() != Some("multipart/form-data") {
            return Err(ApiError::WrongMediaType { expected: EXPECTED });
        }
        let limits = state.limits();
        check_length(&request, limits.upload_bytes)?;
        // As many times the usual time as the usual size.
        let times = (limits.upload_bytes / limits.body_bytes).clamp(1, 64) as u32;
        let parts = tokio::time::timeout(limits.body_time() * times, parts(request, state));
        parts.await.map_err(|_| ApiError::BodyTimeout)?.map(Self)
    }
}

async fn parts(request: Request, state: &AppState) -> Result<Uploaded, ApiError> {
    let limit = state.limits().upload_bytes;
    let bad = |error: MultipartError| {
        if error.status() == StatusCode::PAYLOAD_TOO_LARGE {
            ApiError::BodyTooLarge { limit }
        } else {
            ApiError::malformed(None, format!("the body cannot be read: {}", error.body_text()))
        }
    };
    let form = Multipart::from_request(request, state).await;
    let mut form =
        form.map_err(|e| ApiError::malformed(None, format!("the body cannot be read: {}", e.body_text())))?;
    let (mut manifest, mut payload) = (None, None);
    while let Some(part) = form.next_field().await.map_err(bad)? {
        let name = part.name().unwrap_or_default().to_owned();
        let place = match name.as_str() {
            "manifest" => &mut manifest,
            "payload" => &mut payload,
            _ => {
                return Err(ApiError::invalid("body", format!("has a part {name:?}; it must be {EXPECTED}")));
            }
        };
        if place.is_some() {
            return Err(ApiError::invalid(name, "is given more than once"));
        }
        *place = Some(part.bytes().await.map_err(bad)?);
    }
    let missing = |name| ApiError::invalid(name, format!("is missing; the body must be {EXPECTED}"));
    let manifest = manifest.ok_or_else(|| missing("manifest"))?;
    let payload = payload.ok_or_else(|| missing("payload"))?;
    let manifest = serde_json::from_slice(&manifest)
        .map_err(|error| ApiError::malformed(Some("manifest"), format!("manifest is not JSON: {error}")))?;
    Ok(Uploaded { manifest, payload })
}

/// `POST /v1/tables/{name}/versions`: checked, its errors measured anew, then published or quarantined.
pub(crate) async fn version(
    State(state): State<AppState>,
    TableName(name): TableName,
    Publisher(caller): Publisher,
    Form(uploaded): Form,
) -> Result<Response, ApiError> {
    check_name(&name)?;
    if !uploaded.manifest.is_object() {
        return Err(ApiError::invalid("manifest", "must be an object"));
    }
    let (table, copy) = (name.clone(), uploaded.clone());
    let checked = state.long().run(move || background::run(|| check(&table, &copy))).await??;
    let Checked { manifest, payload, faults } = checked;
    if !faults.is_empty() {
        return Err(quarantine(&state, &name, &caller.id, &uploaded, faults).await?);
    }
    let version = keep(&state, &name, manifest, &payload, None).await?;
    let (number, is_new) = (version.0.number, version.1);
    tracing::info!(table = name, version = number, new = is_new, token = caller.id, "table uploaded");
    state.refresh().await?;
    let manifest = state.index().version(&name, &number.to_string())?.manifest;
    let status = if is_new { StatusCode::CREATED } else { StatusCode::OK };
    let location = format!("/v1/tables/{name}/versions/{number}");
    let mut response = (status, manifest_json(&manifest)?).into_response();
    let headers = response.headers_mut();
    headers.insert(header::CONTENT_TYPE, HeaderValue::from_static("application/json"));
    headers.insert(header::CACHE_CONTROL, HeaderValue::from_static("no-store"));
    headers.insert(header::LOCATION, HeaderValue::from_str(&location).map_err(ApiError::internal)?);
    Ok(response)
}

/// Keeps a version: the payload first, so that no version is ever without.
async fn keep(
    state: &AppState,
    table: &str,
    manifest: Value,
    payload: &[u8],
    reason: Option<String>,
) -> Result<(StoredVersion, bool), ApiError> {
    let digest = digest(payload);
    state.stores().blobs.put(BlobKind::Payload, &digest, payload).await?;
    let new = NewVersion {
        table: table.to_owned(),
        digest,
        manifest,
        state: if reason.is_some() { VersionState::Quarantined } else { VersionState::Published },
        spec_digest: None,
        reason,
    };
    Ok(state.stores().metadata.add_version(new, None).await?)
}

/// Keeps what came for inspection: the manifest as a line of JSON, then the payload. It has a digest of its own, so that the same
/// payload may come again with a better manifest.
async fn quarantine(
    state: &AppState,
    table: &str,
    token: &str,
    Uploaded { manifest, payload }: &Uploaded,
    faults: Vec<String>,
) -> Result<ApiError, ApiError> {
    let whole = [manifest.to_string().as_bytes(), b"\n", payload].concat();
    let (kept, _) = keep(state, table, manifest.clone(), &whole, Some(faults.join("; "))).await?;
    tracing::info!(table, version = kept.number, token, "table uploaded, and quarantined");
    Ok(ApiError::Quarantined { faults, version: kept.number, digest: kept.digest })
}
