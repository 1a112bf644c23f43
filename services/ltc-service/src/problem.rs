//! Problem details, RFC 9457: the one form of every error.

use axum::body::Body;
use axum::http::{HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use serde::Serialize;
use serde_json::{Map, Value};

use crate::problem_types::{HTTP, ProblemType};
use crate::request_id::RequestId;

/// An error on its way out; [`render`] turns it into a body once it knows the request.
#[derive(Clone, Debug)]
pub(crate) struct Problem {
    pub kind: &'static ProblemType,
    pub detail: String,
    pub field: Option<String>,
    /// What the document says besides.
    pub members: Map<String, Value>,
}

#[derive(Serialize)]
struct Document<'a> {
    r#type: String,
    title: &'a str,
    status: u16,
    detail: &'a str,
    instance: &'a str,
    /// Where the service explains the type.
    help: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    field: Option<&'a str>,
    request_id: &'a str,
    #[serde(flatten)]
    members: &'a Map<String, Value>,
}

/// The text with control characters escaped: details quote what a client sent, and stay one line.
fn one_line(text: &str) -> String {
    let mut line = String::with_capacity(text.len());
    for c in text.chars() {
        if c.is_control() { line.extend(c.escape_default()) } else { line.push(c) }
    }
    line
}

impl IntoResponse for Problem {
    fn into_response(mut self) -> Response {
        self.detail = one_line(&self.detail);
        let mut response = self.kind.status.into_response();
        response.extensions_mut().insert(self);
        response
    }
}

/// Gives an error response its problem document, whoever made it. Others stay as they are.
pub(crate) fn render(response: Response, path: &str, request_id: &RequestId) -> Response {
    let status = response.status();
    if !status.is_client_error() && !status.is_server_error() {
        return response;
    }
    let (mut parts, _) = response.into_parts();
    let problem = parts.extensions.remove::<Problem>().unwrap_or_else(|| of_status(status));
    let title = if problem.kind == &HTTP {
        status.canonical_reason().unwrap_or(HTTP.title)
    } else {
        problem.kind.title
    };
    let document = Document {
        r#type: format!("urn:ltc:problem:{}", problem.kind.slug),
        title,
        status: status.as_u16(),
        detail: &problem.detail,
        instance: path,
        help: format!("/problems/{}", problem.kind.slug),
        field: problem.field.as_deref(),
        request_id: request_id.as_str(),
        members: &problem.members,
    };
    // Text and numbers always serialise; should they not, the status alone still tells the truth.
    let body = serde_json::to_vec(&document).unwrap_or_default();
    parts.headers.remove(header::CONTENT_LENGTH);
    parts.headers.insert(header::CONTENT_TYPE, HeaderValue::from_static("application/problem+json"));
    parts.headers.insert(header::CACHE_CONTROL, HeaderValue::from_static("no-store"));
    Response::from_parts(parts, Body::from(body))
}

/// For an error response that came from outside of the handlers.
fn of_status(status: StatusCode) -> Problem {
    let detail = status.canonical_reason().unwrap_or("Error").to_owned();
    Problem { kind: &HTTP, detail, field: None, members: Map::new() }
}
