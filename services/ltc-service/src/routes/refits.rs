//! Refits: fits that the service does when there is time, and that outlive it.

use axum::extract::{FromRequestParts, RawQuery, State};
use axum::http::{HeaderName, HeaderValue, StatusCode, header, request::Parts};
use axum::response::{IntoResponse, Response};
use ltc_refit::Ask;
use ltc_store::{Job, JobState, NewJob};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::auth::Refitter;
use crate::params::Params;
use crate::preconditions::Preconditions;
use crate::representation::{Caching, Representation};
use crate::request_body::JsonBody;
use crate::routes::aliases::check_name;
use crate::selected::RefitId;
use crate::{ApiError, AppState};

/// A refit as it is shown.
#[derive(Serialize)]
struct Shown<'a> {
    id: &'a str,
    state: JobState,
    progress: f64,
    table: &'a str,
    version: Option<u32>,
    error: Option<&'a str>,
    seconds_left: Option<f64>,
    tv: Option<f64>,
    priority: i32,
    alias: Option<&'a str>,
    even_if_worse: bool,
    cancel_requested: bool,
    attempts: u32,
    created: &'a str,
    updated: &'a str,
    spec_digest: &'a str,
    /// Left out in lists.
    #[serde(skip_serializing_if = "Option::is_none")]
    spec: Option<&'a Value>,
}

fn shown(job: &Job, with_spec: bool) -> Shown<'_> {
    let NewJob { table, spec, spec_digest, priority, alias, .. } = &job.request;
    Shown {
        id: &job.id,
        state: job.state,
        progress: job.progress,
        table,
        version: job.version,
        error: job.error.as_deref(),
        seconds_left: job.seconds_left,
        tv: job.tv,
        priority: *priority,
        alias: alias.as_ref().map(|(alias, _)| alias.as_str()),
        even_if_worse: alias.as_ref().is_some_and(|(_, even_if_worse)| *even_if_worse),
        cancel_requested: job.cancel_requested,
        attempts: job.attempts,
        created: &job.created,
        updated: &job.updated,
        spec_digest,
        spec: with_spec.then_some(spec),
    }
}

#[derive(Serialize)]
struct List<'a> {
    refits: Vec<Shown<'a>>,
}

/// Refits in a list, unless asked for more or fewer.
const LISTED: u32 = 50;
/// Refits in a list at most.
const MOST_LISTED: u32 = 500;

/// `GET /v1/refits?limit=`: the newest, newest first.
pub(crate) async fn list(
    State(state): State<AppState>,
    RawQuery(query): RawQuery,
    request: Preconditions,
) -> Result<Response, ApiError> {
    let mut params = Params::parse(query.as_deref())?;
    let limit = params.count("limit", LISTED, MOST_LISTED)?;
    params.finish(&["limit"])?;
    let jobs = state.stores().jobs.jobs(limit).await?;
    let list = List { refits: jobs.iter().map(|job| shown(job, false)).collect() };
    Representation::json(&list, Caching::Checked)?.respond(&request)
}

/// `GET /v1/refits/{id}`
pub(crate) async fn one(
    State(state): State<AppState>,
    RefitId(id): RefitId,
    request: Preconditions,
) -> Result<Response, ApiError> {
    let job = state.stores().jobs.job(&id).await?;
    Representation::json(&shown(&job, true), Caching::Checked)?.respond(&request)
}

/// `DELETE /v1/refits/{id}`: 200 when it has stopped, 202 when it will at its next shard.
pub(crate) async fn cancel(
    State(state): State<AppState>,
    RefitId(id): RefitId,
    Refitter(caller): Refitter,
) -> Result<Response, ApiError> {
    let job = state.stores().jobs.cancel(&id).await?;
    tracing::info!(refit = id, token = caller.id, "refit cancelled");
    let status = if job.state.is_final() { StatusCode::OK } else { StatusCode::ACCEPTED };
    Ok((status, [(header::CACHE_CONTROL, "no-store")], axum::Json(shown(&job, true))).into_response())
}

/// What to fit.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Asked {
    /// A preset by name.
    preset: Option<String>,
    /// The fields of a specification: all of them, or those that differ from the preset.
    spec: Option<Value>,
    /// Higher first.
    #[serde(default)]
    priority: i32,
    /// The alias to move to the result.
    alias: Option<String>,
    /// Whether the alias moves even to a result that is worse than what it points at.
    #[serde(default)]
    even_if_worse: bool,
}

/// Priorities that can be asked for, either way.
const MOST_PRIORITY: i32 = 100;

impl Asked {
    /// The specification as [`ltc_refit::check`] takes it.
    fn spec(&mut self) -> Result<Value, ApiError> {
        let mut spec = match (self.spec.take(), &self.preset) {
            (Some(Value::Object(spec)), _) => spec,
            (Some(_), _) => return Err(ApiError::invalid("spec", "must be an object")),
            (None, Some(_)) => serde_json::Map::new(),
            (None, None) => return Err(ApiError::invalid("preset", "or spec must be given")),
        };
        if let Some(preset) = self.preset.take()
            && spec.insert("preset".to_owned(), preset.into()).is_some()
        {
            return Err(ApiError::invalid("preset", "is given twice"));
        }
        Ok(spec.into())
    }
}

/// The key under which the same request is the same refit.
pub(crate) struct IdempotencyKey(Option<String>);

const IDEMPOTENCY_KEY: HeaderName = HeaderName::from_static("idempotency-key");

impl FromRequestParts<AppState> for IdempotencyKey {
    type Rejection = ApiError;

    async fn from_request_parts(parts: &mut Parts, _: &AppState) -> Result<Self, ApiError> {
        let mut values = parts.headers.get_all(IDEMPOTENCY_KEY).iter();
        let Some(value) = values.next() else { return Ok(Self(None)) };
        let plain =
            |v: &&HeaderValue| (1..=128).contains(&v.len()) && v.as_bytes().iter().all(u8::is_ascii_graphic);
        let key = Some(value).filter(plain).and_then(|v| v.to_str().ok()).filter(|_| values.next().is_none());
        let reason = "must be given once, 1 to 128 visible characters of ASCII";
        let key = key.ok_or_else(|| {
            ApiError::malformed(Some("idempotency-key"), format!("Idempotency-Key {reason}"))
        })?;
        Ok(Self(Some(key.to_owned())))
    }
}

/// `POST /v1/refits`
pub(crate) async fn ask(
    State(state): State<AppState>,
    Refitter(caller): Refitter,
    IdempotencyKey(key): IdempotencyKey,
    JsonBody(mut asked): JsonBody<Asked>,
) -> Result<Response, ApiError> {
    if !(-MOST_PRIORITY..=MOST_PRIORITY).contains(&asked.priority) {
        return Err(ApiError::invalid("priority", format!("must be -{MOST_PRIORITY} to {MOST_PRIORITY}")));
    }
    if let Some(alias) = &asked.alias {
        check_name(alias)?;
    }
    let ask = Ask {
        spec: asked.spec()?,
        priority: asked.priority,
        alias: asked.alias,
        force: asked.even_if_worse,
        idempotency: key.map(|key| (caller.id.clone(), key)),
    };
    let (job, new) = state.refits().request(ask).await?;
    tracing::info!(refit = job.id, table = job.request.table, token = caller.id, new, "refit asked for");
    let location = format!("/v1/refits/{}", job.id);
    let headers = [(header::LOCATION, location), (header::CACHE_CONTROL, "no-store".to_owned())];
    Ok((StatusCode::ACCEPTED, headers, axum::Json(shown(&job, true))).into_response())
}
