//! What there is: lists and manifests.

use std::collections::BTreeMap;

use axum::extract::State;
use axum::response::Response;
use ltc_table::Manifest;
use serde::Serialize;

use crate::index::{Entry, Index};
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
    /// Numbers by alias.
    aliases: BTreeMap<String, u32>,
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
    let index = state.index();
    let mut tables = Vec::new();
    for name in index.names() {
        let entry = index.table(name)?;
        let Some(latest) = entry.latest() else { continue };
        let Manifest { version, digest, lobes, brdf, licence, .. } = &**latest;
        let (versions, aliases) = (entry.numbers(), numbers_by_alias(name, entry));
        let brdf = &brdf.name;
        tables.push(Summary {
            name,
            latest: *version,
            versions,
            aliases,
            digest,
            lobes: *lobes,
            brdf,
            licence,
        });
    }
    Representation::json(&List { tables }, Caching::Short)?.kept().respond(&request)
}

/// The latest version's manifest, and which versions there are.
#[derive(Serialize)]
struct Latest<'a> {
    latest: u32,
    versions: Vec<u32>,
    aliases: BTreeMap<String, u32>,
    #[serde(flatten)]
    manifest: &'a Manifest,
}

/// `GET /v1/tables/{name}`
pub(crate) async fn latest(
    State(state): State<AppState>,
    TableName(name): TableName,
    request: Preconditions,
) -> Result<Response, ApiError> {
    let index = state.index();
    let (entry, latest) = table_and_latest(&index, &name)?;
    let document = Latest {
        latest: latest.version,
        versions: entry.numbers(),
        aliases: numbers_by_alias(&name, entry),
        manifest: latest,
    };
    Representation::json(&document, Caching::Short)?.kept().respond(&request)
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
    let index = state.index();
    let (entry, latest) = table_and_latest(&index, &name)?;
    let versions = entry.versions().map(|v| {
        let Manifest { version, digest, created, payload_bytes, errors, .. } = &**v;
        let tv_mean = errors.standard_draw.tv_mean;
        VersionSummary { version: *version, digest, created, payload_bytes: *payload_bytes, tv_mean }
    });
    let document = Versions { name: &name, latest: latest.version, versions: versions.collect() };
    Representation::json(&document, Caching::Short)?.kept().respond(&request)
}

/// `GET /v1/tables/{name}/versions/{version}`: the bytes of `manifest.json`.
pub(crate) async fn manifest(selected: Selected, request: Preconditions) -> Result<Response, ApiError> {
    let content = Tagged::new(manifest_json(&selected.manifest)?.into_bytes());
    let mut manifest = Representation::new(content, "application/json", selected.caching()).kept();
    for (name, value) in selected.names() {
        manifest = manifest.with(name, &value);
    }
    manifest.respond(&request)
}

/// As [`ltc_table::TableVersion::manifest_json`] writes it.
pub(crate) fn manifest_json(manifest: &Manifest) -> Result<String, ApiError> {
    Ok(serde_json::to_string_pretty(manifest).map_err(ApiError::internal)? + "\n")
}

fn numbers_by_alias(table: &str, entry: &Entry) -> BTreeMap<String, u32> {
    entry.aliases(table).into_iter().map(|alias| (alias.name, alias.number)).collect()
}

/// A table, and the manifest of its latest version.
fn table_and_latest<'a>(index: &'a Index, name: &str) -> Result<(&'a Entry, &'a Manifest), ApiError> {
    let entry = index.table(name)?;
    // A table is in the index because it has a version.
    let latest = entry.latest().ok_or_else(|| ApiError::internal("a table without versions"))?;
    Ok((entry, latest))
}
