//! What there is: lists and manifests.

use axum::extract::State;
use axum::response::Response;
use ltc_table::Manifest;
use serde::Serialize;

use crate::preconditions::Preconditions;
use crate::representation::{Caching, Representation, Tagged};
use crate::selected::{Selected, TableName};
use crate::{ApiError, AppState};

#[derive(Serialize)]
struct List<'a> {
    tables: Vec<Summary<'a>>,
}

/// A table in the list.
#[derive(Serialize)]
struct Summary<'a> {
    name: &'a str,
    /// Number of the latest version.
    latest: u32,
    versions: Vec<u32>,
    /// Of the latest version.
    digest: &'a str,
    lobes: u32,
    brdf: &'a str,
    licence: &'a str,
}

/// `GET /v1/tables`
pub(crate) async fn list(
    State(state): State<AppState>,
    request: Preconditions,
) -> Result<Response, ApiError> {
    let mut tables = Vec::new();
    for name in state.catalogue().names() {
        let (latest, versions) = latest_and_versions(&state, name)?;
        let Manifest { version, digest, lobes, brdf, licence, .. } = latest;
        let versions = versions.iter().map(|v| v.version).collect();
        let brdf = &brdf.name;
        tables.push(Summary { name, latest: *version, versions, digest, lobes: *lobes, brdf, licence });
    }
    Representation::json(&List { tables }, Caching::Short)?.respond(&request)
}

/// The latest version's manifest, and which versions there are.
#[derive(Serialize)]
struct Latest<'a> {
    latest: u32,
    versions: Vec<u32>,
    #[serde(flatten)]
    manifest: &'a Manifest,
}

/// `GET /v1/tables/{name}`
pub(crate) async fn latest(
    State(state): State<AppState>,
    TableName(name): TableName,
    request: Preconditions,
) -> Result<Response, ApiError> {
    let (latest, versions) = latest_and_versions(&state, &name)?;
    let versions = versions.iter().map(|v| v.version).collect();
    let document = Latest { latest: latest.version, versions, manifest: latest };
    Representation::json(&document, Caching::Short)?.respond(&request)
}

#[derive(Serialize)]
struct Versions<'a> {
    name: &'a str,
    latest: u32,
    versions: Vec<VersionSummary<'a>>,
}

/// A version in the list of a table's versions.
#[derive(Serialize)]
struct VersionSummary<'a> {
    version: u32,
    digest: &'a str,
    created: &'a str,
    payload_bytes: u64,
    tv_mean: f64,
}

/// `GET /v1/tables/{name}/versions`
pub(crate) async fn versions(
    State(state): State<AppState>,
    TableName(name): TableName,
    request: Preconditions,
) -> Result<Response, ApiError> {
    let (latest, versions) = latest_and_versions(&state, &name)?;
    let versions = versions.iter().map(|v| {
        let Manifest { version, digest, created, payload_bytes, errors, .. } = v;
        let tv_mean = errors.standard_draw.tv_mean;
        VersionSummary { version: *version, digest, created, payload_bytes: *payload_bytes, tv_mean }
    });
    let document = Versions { name: &name, latest: latest.version, versions: versions.collect() };
    Representation::json(&document, Caching::Short)?.respond(&request)
}

/// `GET /v1/tables/{name}/versions/{version}`: the bytes of `manifest.json`.
pub(crate) async fn manifest(selected: Selected, request: Preconditions) -> Result<Response, ApiError> {
    let content = Tagged::new(selected.version.manifest_json()?.into_bytes());
    let manifest = Representation::new(content, "application/json", selected.caching());
    Ok(selected.named(manifest.respond(&request)?))
}

/// The manifests of a table's latest version and of all, oldest first.
fn latest_and_versions<'a>(
    state: &'a AppState,
    name: &str,
) -> Result<(&'a Manifest, Vec<&'a Manifest>), ApiError> {
    let latest = state.catalogue().version(name, "latest")?.manifest();
    Ok((latest, state.catalogue().versions(name)?.map(|version| version.manifest()).collect()))
}
