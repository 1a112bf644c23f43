//! The tables themselves.

use axum::extract::{RawQuery, State};
use axum::http::header;
use axum::response::Response;

use crate::params::Params;
use crate::preconditions::Preconditions;
use crate::representation::Representation;
use crate::selected::Selected;
use crate::variant::Format;
use crate::{ApiError, AppState, Variant};

/// `GET …/data`
pub(crate) async fn table(
    State(state): State<AppState>,
    selected: Selected,
    RawQuery(query): RawQuery,
    request: Preconditions,
) -> Result<Response, ApiError> {
    let variant = Variant::of_data(Params::parse(query.as_deref())?)?;
    respond(&state, &selected, variant, &request).await
}

/// `GET …/fresnel`
pub(crate) async fn fresnel(
    State(state): State<AppState>,
    selected: Selected,
    RawQuery(query): RawQuery,
    request: Preconditions,
) -> Result<Response, ApiError> {
    let variant = Variant::of_fresnel(Params::parse(query.as_deref())?)?;
    respond(&state, &selected, variant, &request).await
}

async fn respond(
    state: &AppState,
    selected: &Selected,
    variant: Variant,
    request: &Preconditions,
) -> Result<Response, ApiError> {
    // A browser shows JSON; it can only store the others.
    let disposition = if variant.format == Format::Json { "inline" } else { "attachment" };
    let disposition = format!("{disposition}; filename=\"{}\"", variant.file_name(&selected.manifest));
    let content_type = variant.format.content_type();
    let key = variant.key(&selected.manifest);
    let content = state.encoded(&selected.manifest, variant).await?;
    let gzip = if request.wants_gzip() { state.gzipped(&key, &content).await? } else { None };
    let mut data = Representation::new(content, content_type, selected.caching())
        .with_gzip(gzip)
        .with(header::CONTENT_DISPOSITION, &disposition)
        .kept();
    for (name, value) in selected.names() {
        data = data.with(name, &value);
    }
    data.respond(request)
}
