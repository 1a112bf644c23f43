//! What can go wrong with a request, and its place in HTTP.

use axum::extract::rejection::{BytesRejection, PathRejection};
use axum::http::{HeaderName, HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use ltc_core::InputError;
use ltc_fit::FitError;
use ltc_refit::RefitError;
use ltc_store::{Scope, StoreError};
use ltc_table::TableError;
use serde_json::{Map, Value, json};

use crate::problem::Problem;
use crate::problem_types::{self as types, ProblemType};

/// Why a request got no answer. `crate::problem_types` lists the types that clients see.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ApiError {
    /// No route matches the path.
    #[error("there is nothing at this path; GET /openapi.json lists the routes")]
    NoSuchRoute,
    /// The route has no such method.
    #[error("this path does not take this method; the Allow header lists those it takes")]
    MethodNotAllowed,
    /// A table refused the request.
    #[error(transparent)]
    Table(#[from] TableError),
    /// There is no such alias, refit or problem type.
    #[error("there is no {what} \"{name}\"")]
    NoSuchThing {
        /// What.
        what: &'static str,
        /// Its name.
        name: String,
    },
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
    /// The body is declared to be something else than it must be.
    #[error("the body must be {expected}")]
    WrongMediaType {
        /// The media types that are taken.
        expected: &'static str,
    },
    /// `If-Match` or `If-None-Match` does not hold.
    #[error("{reason}")]
    PreconditionFailed {
        /// What is there instead.
        reason: String,
    },
    /// A change must say what it changes.
    #[error(
        "send If-Match with the ETag of what you want to replace, or If-None-Match: * where there is nothing yet"
    )]
    PreconditionRequired,
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
    /// There are too many requests at once.
    #[error("there is more to do than can be done now; try again in a moment")]
    Overloaded,
    /// One client asks too often.
    #[error("too many requests of this client; try again in {seconds} s")]
    RateLimited {
        /// When.
        seconds: u64,
    },
    /// The service is not ready.
    #[error("{reason}")]
    NotReady {
        /// Why.
        reason: String,
    },
    /// Who asks is not known.
    #[error("{reason}")]
    Unauthenticated {
        /// What is wrong with the token.
        reason: &'static str,
        /// Whether there was one.
        presented: bool,
    },
    /// Who asks may not.
    #[error("this token has no scope \"{}\"", scope.name())]
    Forbidden {
        /// The scope that it would need.
        scope: Scope,
    },
    /// The state of things does not allow it.
    #[error("{reason}")]
    Conflict {
        /// Why.
        reason: String,
    },
    /// As many refits wait as may.
    #[error("{limit} refits wait already; try again later")]
    QueueFull {
        /// How many may.
        limit: u64,
    },
    /// A refit would take more than it may.
    #[error("{reason}")]
    TooCostly {
        /// The estimate in words.
        reason: String,
        /// The estimate in numbers.
        estimate: Value,
    },
    /// An uploaded table is not what it must be.
    #[error("the table is kept for inspection and not listed: {}", faults.join("; "))]
    Quarantined {
        /// What is wrong with it.
        faults: Vec<String>,
        /// The number under which it is kept.
        version: u32,
        /// Its digest.
        digest: String,
    },
    /// The store cannot be written.
    #[error("nothing can be written now: {reason}; reading goes on")]
    StoreUnwritable {
        /// Why.
        reason: String,
    },
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

    /// The one place where errors become types and statuses.
    fn class(&self) -> &'static ProblemType {
        match self {
            Self::NoSuchRoute => &types::NO_SUCH_ROUTE,
            Self::MethodNotAllowed => &types::METHOD_NOT_ALLOWED,
            Self::Table(TableError::NoSuchTable { .. }) => &types::NO_SUCH_TABLE,
            Self::Table(TableError::NoSuchVersion { .. }) => &types::NO_SUCH_VERSION,
            Self::NoSuchThing { .. } => &types::NO_SUCH_THING,
            Self::Table(
                TableError::Input(_)
                | TableError::NotIsotropic { .. }
                | TableError::BadAxis { .. }
                | TableError::NotDropIn { .. }
                | TableError::BadName { .. },
            )
            | Self::Invalid { .. }
            | Self::Unwritable { .. }
            | Self::NotAnArray { .. } => &types::INVALID_VALUE,
            Self::Malformed { .. } => &types::MALFORMED,
            Self::BodyTooLarge { .. } => &types::BODY_TOO_LARGE,
            Self::TooManyQueries { .. } => &types::TOO_MANY_QUERIES,
            Self::WrongMediaType { .. } => &types::UNSUPPORTED_MEDIA_TYPE,
            Self::PreconditionFailed { .. } => &types::PRECONDITION_FAILED,
            Self::PreconditionRequired => &types::PRECONDITION_REQUIRED,
            Self::RangeNotSatisfiable { .. } => &types::RANGE_NOT_SATISFIABLE,
            Self::BodyTimeout => &types::BODY_TIMEOUT,
            Self::Timeout => &types::TIMEOUT,
            Self::Overloaded => &types::OVERLOADED,
            Self::RateLimited { .. } => &types::RATE_LIMITED,
            Self::NotReady { .. } => &types::NOT_READY,
            Self::Unauthenticated { .. } => &types::UNAUTHENTICATED,
            Self::Forbidden { .. } => &types::FORBIDDEN,
            Self::Conflict { .. } => &types::CONFLICT,
            Self::QueueFull { .. } => &types::QUEUE_FULL,
            Self::TooCostly { .. } => &types::TOO_COSTLY,
            Self::Quarantined { .. } => &types::QUARANTINED,
            Self::StoreUnwritable { .. } => &types::STORE_UNWRITABLE,
            Self::Table(_) | Self::Internal => &types::INTERNAL,
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
            Self::Table(TableError::NotDropIn { .. }) => "format",
            Self::Table(TableError::BadName { .. }) => "name",
            _ => return None,
        };
        Some(name.to_owned())
    }

    /// What the problem document says besides.
    fn members(&self) -> Map<String, Value> {
        let members = match self {
            Self::TooCostly { estimate, .. } => json!({ "estimate": estimate }),
            Self::Quarantined { faults, version, digest } => {
                json!({ "faults": faults, "version": version, "digest": digest })
            }
            _ => return Map::new(),
        };
        members.as_object().cloned().unwrap_or_default()
    }

    /// Seconds after which it may be different.
    fn retry_after(&self) -> Option<u64> {
        match self {
            Self::Timeout | Self::Overloaded | Self::NotReady { .. } => Some(1),
            Self::RateLimited { seconds } => Some(*seconds),
            Self::QueueFull { .. } => Some(60),
            Self::StoreUnwritable { .. } => Some(30),
            _ => None,
        }
    }

    /// Headers that belong to the error.
    fn headers(&self) -> Vec<(HeaderName, String)> {
        let mut headers = Vec::new();
        if let Some(seconds) = self.retry_after() {
            headers.push((header::RETRY_AFTER, seconds.to_string()));
        }
        match self {
            Self::RangeNotSatisfiable { length } => {
                headers.push((header::CONTENT_RANGE, format!("bytes */{length}")));
            }
            Self::Unauthenticated { presented, .. } => {
                let error = if *presented { ", error=\"invalid_token\"" } else { "" };
                headers.push((header::WWW_AUTHENTICATE, format!("Bearer realm=\"ltc\"{error}")));
            }
            Self::Forbidden { scope } => {
                let scope = scope.name();
                let value = format!("Bearer realm=\"ltc\", error=\"insufficient_scope\", scope=\"{scope}\"");
                headers.push((header::WWW_AUTHENTICATE, value));
            }
            _ => {}
        }
        headers
    }
}

impl IntoResponse for ApiError {
    fn into_response(self) -> Response {
        let kind = self.class();
        let detail = match &self {
            Self::Table(cause) if kind.status == StatusCode::INTERNAL_SERVER_ERROR => {
                Self::internal(cause).to_string()
            }
            _ => self.to_string(),
        };
        let problem = Problem { kind, detail, field: self.field(), members: self.members() };
        let mut response = problem.into_response();
        for (name, value) in self.headers() {
            if let Ok(value) = HeaderValue::from_str(&value) {
                response.headers_mut().insert(name, value);
            }
        }
        response
    }
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

impl From<StoreError> for ApiError {
    fn from(error: StoreError) -> Self {
        match error {
            StoreError::NotFound { what, name } => Self::NoSuchThing { what, name },
            StoreError::Conflict { reason } => Self::Conflict { reason },
            StoreError::Full { limit, .. } => Self::QueueFull { limit },
            StoreError::Unwritable { reason } => {
                tracing::error!(reason, "the store cannot be written");
                Self::StoreUnwritable { reason: "the device is full or read-only".to_owned() }
            }
            other => Self::internal(other),
        }
    }
}

impl From<RefitError> for ApiError {
    fn from(error: RefitError) -> Self {
        match error {
            RefitError::Spec { field, reason } if field.is_empty() => Self::invalid("spec", reason),
            RefitError::Spec { field, reason } => Self::invalid(field, reason),
            RefitError::TooLarge { entries, memory, seconds, reason } => Self::TooCostly {
                reason,
                estimate: json!({ "entries": entries, "memory_bytes": memory, "core_seconds": seconds }),
            },
            RefitError::Store(error) => error.into(),
            other => Self::internal(other),
        }
    }
}

impl From<FitError> for ApiError {
    fn from(error: FitError) -> Self {
        match error {
            FitError::Table(error) => Self::Table(error),
            other => Self::internal(other),
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
