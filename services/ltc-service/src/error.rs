//! What can go wrong with a request, and its place in HTTP.

use axum::extract::rejection::{BytesRejection, PathRejection};
use axum::http::{HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use ltc_core::InputError;
use ltc_table::TableError;

use crate::problem::Problem;

/// Why a request got no answer.
///
/// `type` in the response is `urn:ltc:problem:` and one of these:
///
/// | type | status | means |
/// |---|---|---|
/// | `no-such-route` | 404 | nothing is at this path |
/// | `no-such-table`, `no-such-version` | 404 | `detail` lists what there is |
/// | `method-not-allowed` | 405 | `Allow` lists the methods |
/// | `malformed` | 400 | path, query or body cannot be read |
/// | `invalid-value` | 422 | readable, but means nothing here; `field` names what |
/// | `body-too-large`, `too-many-queries` | 413 | `detail` names the limit |
/// | `unsupported-media-type` | 415 | the body must be JSON |
/// | `precondition-failed` | 412 | `If-Match` names another version |
/// | `range-not-satisfiable` | 416 | `Content-Range` names the length |
/// | `body-timeout` | 408 | the body did not arrive in time |
/// | `timeout` | 503 | the answer took too long |
/// | `not-ready` | 503 | there is no table to serve |
/// | `internal` | 500 | a fault of the service; the log has it under the request's id |
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ApiError {
    /// No route matches the path.
    #[error("there is nothing at this path; GET / lists the routes")]
    NoSuchRoute,
    /// The route has no such method.
    #[error("this path does not take this method; the Allow header lists those it takes")]
    MethodNotAllowed,
    /// A table refused the request.
    #[error(transparent)]
    Table(#[from] TableError),
    /// Path, query or body cannot be read.
    #[error("{reason}")]
    Malformed {
        /// The parameter it is about, where it is about one.
        field: Option<String>,
        /// Why.
        reason: String,
    },
    /// A value can be read but means nothing here.
    #[error("{field} {reason}")]
    Invalid {
        /// Which parameter.
        field: String,
        /// What is wrong with it.
        reason: String,
    },
    /// The table cannot be written as asked.
    #[error("{source}")]
    Unwritable {
        /// Why.
        source: TableError,
    },
    /// The body is no array of queries.
    #[error("the body must be a JSON array of queries: {reason}")]
    NotAnArray {
        /// What it is.
        reason: String,
    },
    /// The body is larger than the limit.
    #[error("the body is larger than {limit} bytes")]
    BodyTooLarge {
        /// Bytes.
        limit: usize,
    },
    /// A batch has more queries than the limit.
    #[error("{count} queries in one request; at most {limit} are answered")]
    TooManyQueries {
        /// How many.
        count: usize,
        /// How many at most.
        limit: usize,
    },
    /// The body is declared to be something else than JSON.
    #[error("the body must be application/json")]
    NotJson,
    /// `If-Match` names none of this representation.
    #[error("the current representation is not one that If-Match names")]
    PreconditionFailed,
    /// The range lies outside of the representation.
    #[error("the range lies outside of the {length} bytes there are")]
    RangeNotSatisfiable {
        /// Bytes of the whole.
        length: usize,
    },
    /// The body did not arrive in time.
    #[error("the body did not arrive in time")]
    BodyTimeout,
    /// The answer took too long.
    #[error("the answer took too long")]
    Timeout,
    /// There is no table.
    #[error("there is no table to serve")]
    NotReady,
    /// A fault of the service. Its cause goes to the log, not to the client.
    #[error("the service failed; its log says why under this request's id")]
    Internal,
}

impl ApiError {
    /// A value that can be read but means nothing here.
    pub(crate) fn invalid(field: impl Into<String>, reason: impl Into<String>) -> Self {
        Self::Invalid { field: field.into(), reason: reason.into() }
    }

    /// A parameter, or the request around it, that cannot be read.
    pub(crate) fn malformed(field: Option<&str>, reason: impl Into<String>) -> Self {
        Self::Malformed { field: field.map(str::to_owned), reason: reason.into() }
    }

    /// A fault of the service, logged here.
    pub(crate) fn internal(cause: impl std::fmt::Display) -> Self {
        tracing::error!(%cause, "internal error");
        Self::Internal
    }

    /// The one place where errors become statuses.
    fn class(&self) -> (StatusCode, &'static str, &'static str) {
        use StatusCode as S;
        match self {
            Self::NoSuchRoute => (S::NOT_FOUND, "no-such-route", "No such route"),
            Self::MethodNotAllowed => (S::METHOD_NOT_ALLOWED, "method-not-allowed", "Method not allowed"),
            Self::Table(TableError::NoSuchTable { .. }) => (S::NOT_FOUND, "no-such-table", "No such table"),
            Self::Table(TableError::NoSuchVersion { .. }) => {
                (S::NOT_FOUND, "no-such-version", "No such version")
            }
            Self::Table(
                TableError::Input(_) | TableError::NotIsotropic { .. } | TableError::BadAxis { .. },
            )
            | Self::Invalid { .. }
            | Self::Unwritable { .. }
            | Self::NotAnArray { .. } => (S::UNPROCESSABLE_ENTITY, "invalid-value", "Invalid value"),
            Self::Malformed { .. } => (S::BAD_REQUEST, "malformed", "Malformed request"),
            Self::BodyTooLarge { .. } => (S::PAYLOAD_TOO_LARGE, "body-too-large", "Body too large"),
            Self::TooManyQueries { .. } => (S::PAYLOAD_TOO_LARGE, "too-many-queries", "Too many queries"),
            Self::NotJson => (S::UNSUPPORTED_MEDIA_TYPE, "unsupported-media-type", "Unsupported media type"),
            Self::PreconditionFailed => {
                (S::PRECONDITION_FAILED, "precondition-failed", "Precondition failed")
            }
            Self::RangeNotSatisfiable { .. } => {
                (S::RANGE_NOT_SATISFIABLE, "range-not-satisfiable", "Range not satisfiable")
            }
            Self::BodyTimeout => (S::REQUEST_TIMEOUT, "body-timeout", "Body timed out"),
            Self::Timeout => (S::SERVICE_UNAVAILABLE, "timeout", "Timed out"),
            Self::NotReady => (S::SERVICE_UNAVAILABLE, "not-ready", "Not ready"),
            Self::Table(_) | Self::Internal => (S::INTERNAL_SERVER_ERROR, "internal", "Internal error"),
        }
    }

    /// The parameter that the error is about.
    fn field(&self) -> Option<String> {
        let name = match self {
            Self::Malformed { field, .. } => return field.clone(),
            Self::Invalid { field, .. } => field,
            Self::Unwritable { .. } => "precision",
            Self::Table(TableError::Input(
                InputError::NotFinite { name }
                | InputError::OutOfRange { name, .. }
                | InputError::Degenerate { name },
            )) => name,
            Self::Table(TableError::NotIsotropic { .. }) => "alpha_y",
            Self::Table(TableError::BadAxis { quantity, .. }) => quantity,
            _ => return None,
        };
        Some(name.to_owned())
    }
}

impl IntoResponse for ApiError {
    fn into_response(self) -> Response {
        let (status, slug, title) = self.class();
        let detail = if let (Self::Table(cause), StatusCode::INTERNAL_SERVER_ERROR) = (&self, status) {
            Self::internal(cause).to_string()
        } else {
            self.to_string()
        };
        let mut response = Problem { slug, title, status, detail, field: self.field() }.into_response();
        let headers = response.headers_mut();
        if let Self::RangeNotSatisfiable { length } = self {
            headers.insert(header::CONTENT_RANGE, content_range_of_none(length));
        }
        if status == StatusCode::SERVICE_UNAVAILABLE {
            headers.insert(header::RETRY_AFTER, HeaderValue::from_static("1"));
        }
        response
    }
}

fn content_range_of_none(length: usize) -> HeaderValue {
    HeaderValue::from_str(&format!("bytes */{length}")).unwrap_or(HeaderValue::from_static("bytes */*"))
}

impl From<PathRejection> for ApiError {
    fn from(rejection: PathRejection) -> Self {
        if rejection.status().is_server_error() {
            Self::internal(rejection)
        } else {
            Self::malformed(None, format!("the path cannot be read: {}", rejection.body_text()))
        }
    }
}

impl ApiError {
    /// A body that could not be read: too large, or broken off.
    pub(crate) fn body(rejection: &BytesRejection, limit: usize) -> Self {
        if rejection.status() == StatusCode::PAYLOAD_TOO_LARGE {
            Self::BodyTooLarge { limit }
        } else {
            Self::malformed(None, format!("the body cannot be read: {}", rejection.body_text()))
        }
    }
}
