//! What a table says about a view direction and a roughness.

use axum::extract::{RawQuery, State};
use axum::http::header;
use axum::response::{IntoResponse, Response};
use ltc_table::{Lookup, Query, TableVersion};
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;

use crate::params::Params;
use crate::preconditions::Preconditions;
use crate::representation::{Caching, Representation};
use crate::request_body::{Body, may_be_json};
use crate::selected::Selected;
use crate::{ApiError, AppState, binary_lookup};

/// `GET …/lookup`
pub(crate) async fn one(
    State(state): State<AppState>,
    selected: Selected,
    RawQuery(query): RawQuery,
    request: Preconditions,
) -> Result<Response, ApiError> {
    let mut params = Params::parse(query.as_deref())?;
    let query = Query {
        theta: params.required_number("theta")?,
        phi: params.number("phi")?.unwrap_or(0.0),
        alpha_x: params.required_number("alpha_x")?,
        alpha_y: params.required_number("alpha_y")?,
    };
    params.finish(&["theta", "phi", "alpha_x", "alpha_y"])?;
    let lookup = selected.table(&state).await?.table().lookup(&query)?;
    // Never immutable: the bytes of a table are for ever, the way to interpolate in them may be corrected.
    Ok(selected.named(Representation::json(&lookup, Caching::Short)?.respond(&request)?))
}

/// `POST …/lookup`: an array of queries in, an array of the same length and order out. An item that is no valid query
/// gives `{"error": "…"}` in its place, and the others their answers. Or the same in numbers: see [`binary_lookup`].
pub(crate) async fn batch(
    State(state): State<AppState>,
    selected: Selected,
    Body { bytes, media_type }: Body,
) -> Result<Response, ApiError> {
    let limit = state.limits().batch_queries;
    let binary = media_type.as_deref().and_then(binary_lookup::Form::of);
    if binary.is_none() && !may_be_json(media_type.as_deref()) {
        return Err(ApiError::WrongMediaType { expected: binary_lookup::EXPECTED });
    }
    let table = selected.table(&state).await?;
    let (answers, content_type) = match binary {
        Some(form) => {
            let work = move || binary_lookup::answer_all(&table, &bytes, form, limit);
            (state.compute().run(work).await??, form.answers())
        }
        None => (state.compute().run(move || answer_all(&table, &bytes, limit)).await??, "application/json"),
    };
    let headers = [(header::CONTENT_TYPE, content_type), (header::CACHE_CONTROL, "no-store")];
    Ok(selected.named((headers, answers).into_response()))
}

#[derive(Serialize)]
#[serde(untagged)]
enum Answer {
    Lookup(Lookup),
    Refused { error: String },
}

fn answer_all(version: &TableVersion, body: &[u8], limit: usize) -> Result<Vec<u8>, ApiError> {
    let items: Vec<&RawValue> = serde_json::from_slice(body).map_err(|error| {
        if error.is_data() {
            ApiError::NotAnArray { reason: error.to_string() }
        } else {
            ApiError::malformed(None, format!("the body is not JSON: {error}"))
        }
    })?;
    if items.len() > limit {
        return Err(ApiError::TooManyQueries { count: items.len(), limit });
    }
    let answers: Vec<Answer> = items.iter().map(|item| answer(version, item.get())).collect();
    serde_json::to_vec(&answers).map_err(ApiError::internal)
}

fn answer(version: &TableVersion, item: &str) -> Answer {
    let lookup = read(item).and_then(|query| version.table().lookup(&query).map_err(|e| e.to_string()));
    lookup.map_or_else(|error| Answer::Refused { error }, Answer::Lookup)
}

/// A query as it is sent. Stricter than [`Query`]: a misspelt `phi` must not be read as 0.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SentQuery {
    theta: f64,
    #[serde(default)]
    phi: f64,
    alpha_x: f64,
    alpha_y: f64,
}

fn read(item: &str) -> Result<Query, String> {
    if !item.starts_with('{') {
        // Serde would also take the fields in order from an array.
        return Err("a query must be an object".to_owned());
    }
    let SentQuery { theta, phi, alpha_x, alpha_y } =
        serde_json::from_str(item).map_err(|error| error.to_string())?;
    Ok(Query { theta, phi, alpha_x, alpha_y })
}
