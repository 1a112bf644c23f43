//! Names that move from version to version.

use axum::extract::{FromRequestParts, State};
use axum::http::{HeaderMap, HeaderValue, StatusCode, header, request::Parts};
use axum::response::{IntoResponse, Response};
use ltc_store::{Alias, StoreError};
use ltc_table::Manifest;
use serde::{Deserialize, Serialize};

use crate::auth::Publisher;
use crate::etag::TagList;
use crate::index::Index;
use crate::preconditions::Preconditions;
use crate::representation::{Caching, Representation, Tagged};
use crate::request_body::JsonBody;
use crate::selected::{TableName, path_parameter};
use crate::{ApiError, AppState};

/// An alias as it is shown.
#[derive(Serialize)]
struct Shown<'a> {
    table: &'a str,
    alias: &'a str,
    version: u32,
    digest: &'a str,
    revision: u64,
}

impl<'a> Shown<'a> {
    fn of(alias: &'a Alias, manifest: &'a Manifest) -> Self {
        let Alias { table, name, number, revision } = alias;
        Self { table, alias: name, version: *number, digest: &manifest.digest, revision: *revision }
    }
}

/// The JSON of an alias; its tag is what compare-and-swap compares.
fn shown(alias: &Alias, manifest: &Manifest) -> Result<Tagged, ApiError> {
    serde_json::to_vec(&Shown::of(alias, manifest)).map(Tagged::new).map_err(ApiError::internal)
}

/// A table's name and an alias, from the path.
pub(crate) struct Named {
    table: String,
    alias: String,
}

impl FromRequestParts<AppState> for Named {
    type Rejection = ApiError;

    async fn from_request_parts(parts: &mut Parts, state: &AppState) -> Result<Self, ApiError> {
        let table = path_parameter(parts, state, "name").await?;
        let alias = path_parameter(parts, state, "alias").await?;
        Ok(Self { table, alias })
    }
}

impl Named {
    /// The alias as it is now and its JSON, if there is one.
    fn current(&self, index: &Index) -> Result<Option<(Alias, Tagged)>, ApiError> {
        let entry = index.table(&self.table)?;
        let Some(alias) = entry.alias(&self.table, &self.alias) else { return Ok(None) };
        let manifest = index.version(&self.table, &alias.number.to_string())?.manifest;
        let content = shown(&alias, &manifest)?;
        Ok(Some((alias, content)))
    }
}

/// # Errors
/// [`ApiError::Invalid`] for a name that could be taken for a number or a digest.
pub(crate) fn check_name(alias: &str) -> Result<(), ApiError> {
    let plain = |b: u8| matches!(b, b'a'..=b'z' | b'0'..=b'9' | b'-');
    let name = alias.as_bytes();
    let good =
        (1..=64).contains(&name.len()) && name[0].is_ascii_lowercase() && name.iter().all(|b| plain(*b));
    let reason = "must be 1 to 64 of a-z, 0-9 and -, a letter first";
    if good { Ok(()) } else { Err(ApiError::invalid("alias", reason)) }
}

#[derive(Serialize)]
struct List<'a> {
    table: &'a str,
    aliases: Vec<Shown<'a>>,
}

/// `GET /v1/tables/{name}/aliases`
pub(crate) async fn list(
    State(state): State<AppState>,
    TableName(name): TableName,
    request: Preconditions,
) -> Result<Response, ApiError> {
    let index = state.index();
    let entry = index.table(&name)?;
    let mut aliases = Vec::new();
    for alias in entry.aliases(&name) {
        let manifest = index.version(&name, &alias.number.to_string())?.manifest;
        aliases.push((alias, manifest));
    }
    let shown = aliases.iter().map(|(alias, manifest)| Shown::of(alias, manifest)).collect();
    let list = List { table: &name, aliases: shown };
    Representation::json(&list, Caching::Checked)?.respond(&request)
}

/// `GET /v1/tables/{name}/aliases/{alias}`
pub(crate) async fn one(
    State(state): State<AppState>,
    named: Named,
    request: Preconditions,
) -> Result<Response, ApiError> {
    let found = named.current(&state.index())?;
    let (_, content) =
        found.ok_or_else(|| ApiError::NoSuchThing { what: "alias", name: named.alias.clone() })?;
    Representation::new(content, "application/json", Caching::Checked).respond(&request)
}

/// Where an alias is to point.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Target {
    version: VersionName,
}

/// A version as paths name it; a number may stand there as a number.
#[derive(Deserialize)]
#[serde(untagged)]
enum VersionName {
    Number(u32),
    Text(String),
}

/// `PUT /v1/tables/{name}/aliases/{alias}`: compare and swap.
pub(crate) async fn moved(
    State(state): State<AppState>,
    named: Named,
    Publisher(caller): Publisher,
    headers: HeaderMap,
    JsonBody(target): JsonBody<Target>,
) -> Result<Response, ApiError> {
    check_name(&named.alias)?;
    // What other processes changed counts too.
    state.refresh().await?;
    let index = state.index();
    let current = named.current(&index)?;
    let expected = expected_revision(&headers, current.as_ref())?;
    let version = match target.version {
        VersionName::Number(number) => number.to_string(),
        VersionName::Text(text) => text,
    };
    let manifest = index.version(&named.table, &version).map_err(|error| match error {
        ApiError::Table(cause) => ApiError::invalid("version", format!("cannot be pointed at: {cause}")),
        other => other,
    })?;
    let manifest = manifest.manifest;
    let Named { table, alias } = &named;
    let moved = state.stores().metadata.move_alias(table, alias, manifest.version, Some(expected)).await;
    let moved = moved.map_err(|error| match error {
        StoreError::Conflict { reason } => ApiError::PreconditionFailed { reason },
        other => other.into(),
    })?;
    tracing::info!(table, alias, version = moved.number, token = caller.id, "alias moved");
    state.refresh().await?;
    let content = shown(&moved, &manifest)?;
    let status = if moved.revision == 1 { StatusCode::CREATED } else { StatusCode::OK };
    let headers = [(header::CONTENT_TYPE, HeaderValue::from_static("application/json"))];
    let mut response = (status, headers, content.bytes).into_response();
    if let Some(etag) = content.etag.header() {
        response.headers_mut().insert(header::ETAG, etag);
    }
    response.headers_mut().insert(header::CACHE_CONTROL, HeaderValue::from_static("no-cache"));
    Ok(response)
}

/// The revision that the request says the alias has: 0 where it says that there is none.
fn expected_revision(headers: &HeaderMap, current: Option<&(Alias, Tagged)>) -> Result<u64, ApiError> {
    let failed = |reason: &str| ApiError::PreconditionFailed { reason: reason.to_owned() };
    if let Some(tags) = TagList::of(headers, &header::IF_MATCH) {
        let (alias, content) = current.ok_or_else(|| failed("there is no such alias yet"))?;
        if !tags.matches_strongly(&content.etag) {
            return Err(failed("the alias has moved since: its ETag is not one that If-Match names"));
        }
        return Ok(alias.revision);
    }
    // With any other value than * it would say nothing of what the client has seen.
    if !TagList::of(headers, &header::IF_NONE_MATCH).is_some_and(|tags| tags.is_any()) {
        return Err(ApiError::PreconditionRequired);
    }
    match current {
        // Nobody has set it: `latest`, which every table has, is not in the way.
        Some((alias, _)) if alias.revision > 0 => {
            Err(failed("there is such an alias already, as If-None-Match says there must not"))
        }
        _ => Ok(0),
    }
}
