//! What the types of problems mean: `help` in a problem document leads here.

use axum::extract::{FromRequestParts, State};
use axum::http::request::Parts;
use axum::response::Response;
use serde_json::json;

use crate::preconditions::Preconditions;
use crate::problem_types::{self, ProblemType};
use crate::representation::{Caching, Representation};
use crate::selected::path_parameter;
use crate::{ApiError, AppState};

fn shown(kind: &ProblemType) -> serde_json::Value {
    json!({
        "type": format!("urn:ltc:problem:{}", kind.slug),
        "title": kind.title,
        "status": kind.status.as_u16(),
        "meaning": kind.meaning,
    })
}

/// `GET /problems`
pub(crate) async fn list(request: Preconditions) -> Result<Response, ApiError> {
    let all: Vec<_> = problem_types::ALL.iter().map(|kind| shown(kind)).collect();
    Representation::json(&json!({ "problems": all }), Caching::Short)?.respond(&request)
}

/// The name of a type, from the path.
pub(crate) struct Slug(String);

impl FromRequestParts<AppState> for Slug {
    type Rejection = ApiError;

    async fn from_request_parts(parts: &mut Parts, state: &AppState) -> Result<Self, ApiError> {
        path_parameter(parts, state, "slug").await.map(Self)
    }
}

/// `GET /problems/{slug}`
pub(crate) async fn one(
    State(_): State<AppState>,
    Slug(slug): Slug,
    request: Preconditions,
) -> Result<Response, ApiError> {
    let kind =
        problem_types::by_slug(&slug).ok_or(ApiError::NoSuchThing { what: "problem type", name: slug })?;
    Representation::json(&shown(kind), Caching::Short)?.respond(&request)
}
