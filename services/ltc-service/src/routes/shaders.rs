//! Shader source.

use axum::extract::{FromRequestParts, RawQuery, State};
use axum::http::{header, request::Parts};
use axum::response::Response;

use crate::params::Params;
use crate::preconditions::Preconditions;
use crate::representation::{Caching, Representation, Tagged};
use crate::selected::path_parameter;
use crate::{ApiError, AppState};

/// From `/v1/shaders/{lang}`.
pub(crate) struct Language(String);

impl FromRequestParts<AppState> for Language {
    type Rejection = ApiError;

    async fn from_request_parts(parts: &mut Parts, state: &AppState) -> Result<Self, ApiError> {
        path_parameter(parts, state, "lang").await.map(Self)
    }
}

/// `GET /v1/shaders/{lang}?lights=&features=`: just what is asked for, as `ltc shader` writes it.
pub(crate) async fn source(
    State(state): State<AppState>,
    Language(language): Language,
    RawQuery(query): RawQuery,
    request: Preconditions,
) -> Result<Response, ApiError> {
    let known = state.shaders().filter(|source| source.languages().contains(&language.as_str()));
    let Some(source) = known else {
        return Err(ApiError::NoSuchThing { what: "shading language", name: language });
    };
    let mut params = Params::parse(query.as_deref())?;
    let (lights, features) = (params.take("lights").unwrap_or_default(), params.take("features"));
    params.finish(&["lights", "features"])?;
    let name = language.clone();
    let make = move || source.shader(&name, &lights, features.as_deref());
    let made = state.compute().run(make).await?;
    let file = made.map_err(|refusal| ApiError::invalid(refusal.field, refusal.reason))?;
    let content_type = if file.is_text { "text/plain; charset=utf-8" } else { "application/octet-stream" };
    let disposition = format!("inline; filename=\"ltc-{language}.{}\"", file.extension);
    // Another version of the program may write another shader.
    Representation::new(Tagged::new(file.bytes), content_type, Caching::Short)
        .with(header::CONTENT_DISPOSITION, &disposition)
        .kept()
        .respond(&request)
}
