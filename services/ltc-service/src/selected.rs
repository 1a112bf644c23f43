//! The table version that a path names.

use std::sync::Arc;

use axum::extract::{FromRequestParts, Path, RawPathParams};
use axum::http::{HeaderName, HeaderValue, request::Parts};
use axum::response::Response;
use ltc_table::{Manifest, TableVersion};

use crate::representation::Caching;
use crate::{ApiError, AppState};

/// From `…/tables/{name}/versions/{version}…`.
#[derive(Clone, Debug)]
pub(crate) struct Selected {
    pub manifest: Arc<Manifest>,
    /// Whether the path names it by what cannot change: digest or number, not an alias.
    pub pinned: bool,
}

impl Selected {
    /// How long table data and manifests may be kept under this path.
    pub(crate) fn caching(&self) -> Caching {
        if self.pinned { Caching::Immutable } else { Caching::Short }
    }

    /// The numbers.
    pub(crate) async fn table(&self, state: &AppState) -> Result<Arc<TableVersion>, ApiError> {
        state.table(&self.manifest).await
    }

    /// Headers that say which version answers, whatever the path called it.
    pub(crate) fn names(&self) -> [(HeaderName, String); 2] {
        let Manifest { name, version, digest, .. } = &*self.manifest;
        [
            (HeaderName::from_static("x-table-version"), format!("{name}@{version}")),
            (HeaderName::from_static("x-table-digest"), digest.clone()),
        ]
    }

    /// With those headers.
    pub(crate) fn named(&self, mut response: Response) -> Response {
        for (name, value) in self.names() {
            // Names and digests are checked on the way into a version, and are plain text.
            if let Ok(value) = HeaderValue::from_str(&value) {
                response.headers_mut().insert(name, value);
            }
        }
        response
    }
}

impl FromRequestParts<AppState> for Selected {
    type Rejection = ApiError;

    async fn from_request_parts(parts: &mut Parts, state: &AppState) -> Result<Self, ApiError> {
        let name = path_parameter(parts, state, "name").await?;
        let version = path_parameter(parts, state, "version").await?;
        let found = state.index().version(&name, &version)?;
        Ok(Self { manifest: found.manifest, pinned: found.pinned })
    }
}

/// A parameter of the path, decoded.
pub(crate) async fn path_parameter(
    parts: &mut Parts,
    state: &AppState,
    name: &'static str,
) -> Result<String, ApiError> {
    let broken = |_| ApiError::malformed(None, "the path cannot be read: it is not UTF-8 when decoded");
    let raw = RawPathParams::from_request_parts(parts, state).await.map_err(broken)?;
    let value = raw.iter().find(|(known, _)| *known == name).map(|(_, value)| value.to_owned());
    value.ok_or_else(|| ApiError::internal(format!("the route has no parameter {name}")))
}

/// A table's name, from `/v1/tables/{name}…`.
pub(crate) struct TableName(pub String);

impl FromRequestParts<AppState> for TableName {
    type Rejection = ApiError;

    async fn from_request_parts(parts: &mut Parts, state: &AppState) -> Result<Self, ApiError> {
        path_parameter(parts, state, "name").await.map(Self)
    }
}

/// From `/v1/refits/{id}…`.
pub(crate) struct RefitId(pub String);

impl FromRequestParts<AppState> for RefitId {
    type Rejection = ApiError;

    async fn from_request_parts(parts: &mut Parts, state: &AppState) -> Result<Self, ApiError> {
        let Path(id) = Path::<String>::from_request_parts(parts, state).await?;
        Ok(Self(id))
    }
}
