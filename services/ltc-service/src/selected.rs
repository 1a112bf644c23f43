//! The table version that a path names.

use std::sync::Arc;

use axum::extract::{FromRequestParts, Path};
use axum::http::{HeaderValue, request::Parts};
use axum::response::Response;
use ltc_table::TableVersion;

use crate::representation::Caching;
use crate::{ApiError, AppState};

/// From `…/tables/{name}/versions/{version}…`.
#[derive(Clone, Debug)]
pub(crate) struct Selected {
    pub version: Arc<TableVersion>,
    /// Whether the path names it by what cannot change: digest or number, not an alias.
    pinned: bool,
}

impl Selected {
    /// How long table data and manifests may be kept under this path.
    pub(crate) fn caching(&self) -> Caching {
        if self.pinned { Caching::Immutable } else { Caching::Short }
    }

    /// Says in the headers which version answers, whatever the path called it.
    pub(crate) fn named(&self, mut response: Response) -> Response {
        let manifest = self.version.manifest();
        let version = format!("{}@{}", manifest.name, manifest.version);
        for (name, value) in [("x-table-version", &version), ("x-table-digest", &manifest.digest)] {
            // Names and digests are checked on the way into a version, and are plain text.
            if let Ok(value) = HeaderValue::from_str(value) {
                response.headers_mut().insert(name, value);
            }
        }
        response
    }
}

impl FromRequestParts<AppState> for Selected {
    type Rejection = ApiError;

    async fn from_request_parts(parts: &mut Parts, state: &AppState) -> Result<Self, ApiError> {
        let Path((name, version)) = Path::<(String, String)>::from_request_parts(parts, state).await?;
        let found = state.catalogue().version(&name, &version)?;
        let manifest = found.manifest();
        let pinned = version == manifest.digest || version.parse() == Ok(manifest.version);
        Ok(Self { version: Arc::clone(found), pinned })
    }
}

/// A table's name, from `…/tables/{name}…`.
pub(crate) struct TableName(pub String);

impl FromRequestParts<AppState> for TableName {
    type Rejection = ApiError;

    async fn from_request_parts(parts: &mut Parts, state: &AppState) -> Result<Self, ApiError> {
        let Path(name) = Path::from_request_parts(parts, state).await?;
        Ok(Self(name))
    }
}
