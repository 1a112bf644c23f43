//! Benchmark runs in, history out.

use std::time::SystemTime;

use axum::extract::{RawQuery, State};
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};
use ltc_store::{Benchmark, BenchmarkFilter};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use crate::auth::Benchmarker;
use crate::params::Params;
use crate::preconditions::Preconditions;
use crate::representation::{Caching, Representation};
use crate::request_body::JsonBody;
use crate::{ApiError, AppState};

/// One run, as it is sent.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Run {
    /// Name of the series.
    name: String,
    /// When it ran; now, unless it says.
    at: Option<String>,
    /// What was measured.
    run: Value,
}

fn check_name(name: &str) -> Result<(), ApiError> {
    let plain = !name.is_empty() && name.len() <= 128 && name.chars().all(|c| !c.is_control());
    if plain {
        Ok(())
    } else {
        Err(ApiError::invalid("name", "must be 1 to 128 bytes without control characters"))
    }
}

/// A time as the store takes it: RFC 3339 in UTC.
pub(super) fn check_time(field: &str, text: &str) -> Result<(), ApiError> {
    let read = humantime::parse_rfc3339(text);
    read.map(drop).map_err(|_| {
        ApiError::invalid(field, format!("is not a time in UTC such as 2026-01-31T12:00:00Z: {text:?}"))
    })
}

/// `POST /v1/benchmarks`
pub(crate) async fn add(
    State(state): State<AppState>,
    Benchmarker(caller): Benchmarker,
    JsonBody(Run { name, at, run }): JsonBody<Run>,
) -> Result<Response, ApiError> {
    check_name(&name)?;
    if !run.is_object() {
        return Err(ApiError::invalid("run", "must be an object"));
    }
    let at = match at {
        Some(at) => {
            check_time("at", &at)?;
            at
        }
        None => humantime::format_rfc3339_millis(SystemTime::now()).to_string(),
    };
    let id = state.stores().metadata.add_benchmark(&name, &at, run).await?;
    tracing::info!(benchmark = id, name, token = caller.id, "benchmark run kept");
    let answer = json!({ "id": id, "name": name, "at": at });
    Ok((StatusCode::CREATED, [(header::CACHE_CONTROL, "no-store")], axum::Json(answer)).into_response())
}

#[derive(Serialize)]
struct Shown<'a> {
    id: u64,
    name: &'a str,
    at: &'a str,
    run: &'a Value,
}

#[derive(Serialize)]
struct List<'a> {
    benchmarks: Vec<Shown<'a>>,
}

/// Runs in a list, unless asked for more or fewer.
const LISTED: u32 = 1000;
/// Runs in a list at most.
const MOST_LISTED: u32 = 10_000;

/// `GET /v1/benchmarks?name=&since=&limit=`: the newest that fit, into 16 MiB too, oldest first.
pub(crate) async fn list(
    State(state): State<AppState>,
    RawQuery(query): RawQuery,
    request: Preconditions,
) -> Result<Response, ApiError> {
    let mut params = Params::parse(query.as_deref())?;
    let (name, since) = (params.words("name"), params.take("since"));
    let limit = params.count("limit", LISTED, MOST_LISTED)?;
    params.finish(&["name", "since", "limit"])?;
    if let Some(since) = &since {
        check_time("since", since)?;
    }
    let filter = BenchmarkFilter { name, since, limit, ..BenchmarkFilter::default() };
    let found = state.stores().metadata.benchmarks(&filter).await?;
    let benchmarks =
        found.iter().map(|Benchmark { id, name, at, run }| Shown { id: *id, name, at, run }).collect();
    Representation::json(&List { benchmarks }, Caching::Checked)?.respond(&request)
}
