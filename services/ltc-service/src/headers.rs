//! Headers that every answer has, and the browser's question before a cross-origin request.

use axum::body::Body;
use axum::extract::Request;
use axum::http::{HeaderMap, HeaderValue, Method, StatusCode, header};
use axum::response::{IntoResponse, Response};

const EXPOSED: HeaderValue = HeaderValue::from_static(
    "accept-ranges, allow, content-disposition, content-encoding, content-range, etag, location, retry-after, www-authenticate, \
     x-request-id, x-table-digest, x-table-version",
);

/// Any origin may read: browsers send no credentials of their own here, so there is nothing to steal. A page that was given a
/// token may send it.
///
/// Of a 304 what RFC 9110, section 15.4.5, asks for is left, and what makes a browser take it. The rest is in the answer that the client
/// has, and would be most of what is sent.
pub(crate) fn add(headers: &mut HeaderMap, status: StatusCode) {
    if status == StatusCode::NOT_MODIFIED {
        let all = std::mem::replace(headers, HeaderMap::with_capacity(8));
        for name in [header::ETAG, header::CACHE_CONTROL, header::VARY] {
            if let Some(value) = all.get(&name) {
                headers.insert(name, value.clone());
            }
        }
        headers.insert(header::ACCESS_CONTROL_ALLOW_ORIGIN, HeaderValue::from_static("*"));
        return;
    }
    headers.insert(header::ACCESS_CONTROL_ALLOW_ORIGIN, HeaderValue::from_static("*"));
    headers.insert(header::ACCESS_CONTROL_EXPOSE_HEADERS, EXPOSED);
    headers.insert(header::X_CONTENT_TYPE_OPTIONS, HeaderValue::from_static("nosniff"));
}

/// Whether a browser asks if it may.
pub(crate) fn is_preflight(request: &Request<Body>) -> bool {
    request.method() == Method::OPTIONS
        && request.headers().contains_key(header::ACCESS_CONTROL_REQUEST_METHOD)
}

pub(crate) fn answer_preflight() -> Response {
    let allowed = [
        (header::ACCESS_CONTROL_ALLOW_METHODS, "GET, HEAD, POST"),
        (
            header::ACCESS_CONTROL_ALLOW_HEADERS,
            "authorization, content-type, if-match, if-none-match, if-range, last-event-id, range, x-request-id",
        ),
        (header::ACCESS_CONTROL_MAX_AGE, "86400"),
    ];
    (StatusCode::NO_CONTENT, allowed).into_response()
}
