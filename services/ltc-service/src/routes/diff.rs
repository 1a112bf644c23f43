//! What changed from one version to another.

use axum::extract::{FromRequestParts, State};
use axum::http::request::Parts;
use axum::response::Response;

use crate::preconditions::Preconditions;
use crate::representation::{Caching, Representation};
use crate::selected::{Selected, path_parameter};
use crate::{ApiError, AppState, background};

/// The other version of `…/diff/{other}`: of the same table, or `NAME@VERSION` of any.
pub(crate) struct Other(Selected);

impl FromRequestParts<AppState> for Other {
    type Rejection = ApiError;

    async fn from_request_parts(parts: &mut Parts, state: &AppState) -> Result<Self, ApiError> {
        let other = path_parameter(parts, state, "other").await?;
        let index = state.index();
        let found = if other.contains('@') {
            index.find(&other)?
        } else {
            index.version(&path_parameter(parts, state, "name").await?, &other)?
        };
        Ok(Self(Selected { manifest: found.manifest, pinned: found.pinned }))
    }
}

/// `GET …/diff/{other}`
pub(crate) async fn between(
    State(state): State<AppState>,
    selected: Selected,
    Other(other): Other,
    request: Preconditions,
) -> Result<Response, ApiError> {
    let (first, second) = (selected.table(&state).await?, other.table(&state).await?);
    let name = |s: &Selected| format!("{}@{} {}", s.manifest.name, s.manifest.version, s.manifest.digest);
    let key = format!("diff {} {}", name(&selected), name(&other));
    let make = move || {
        let found = background::run(|| ltc_fit::diff::diff(&first, &second))??;
        serde_json::to_vec(&found).map_err(ApiError::internal)
    };
    let content = state.derived().get(&key, state.long(), state.metrics(), make).await?;
    // As lookups: what the comparison says of the same tables may be corrected.
    Representation::new(content, "application/json", Caching::Short).kept().respond(&request)
}
