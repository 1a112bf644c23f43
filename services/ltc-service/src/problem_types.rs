//! The types of problems: what clients tell errors apart by.

use axum::http::StatusCode;

/// One type; `type` in a problem document is `urn:ltc:problem:` and its slug.
#[derive(Debug, PartialEq)]
pub struct ProblemType {
    /// Its name; never changes.
    pub slug: &'static str,
    /// The status that it comes with.
    pub status: StatusCode,
    /// In a few words.
    pub title: &'static str,
    /// What it means, and what helps.
    pub meaning: &'static str,
}

macro_rules! problem_types {
    ($($name:ident = $slug:literal, $status:ident, $title:literal, $meaning:literal;)*) => {
        $(pub(crate) static $name: ProblemType =
            ProblemType { slug: $slug, status: StatusCode::$status, title: $title, meaning: $meaning };)*
        /// All of them.
        pub static ALL: &[&ProblemType] = &[$(&$name),*];
    };
}

problem_types! {
    MALFORMED = "malformed", BAD_REQUEST, "Malformed request",
        "Path, query, header or body cannot be read; `field` names the parameter where it is about one.";
    UNAUTHENTICATED = "unauthenticated", UNAUTHORIZED, "Unauthenticated",
        "This needs a bearer token, and there is none, or it is unknown, expired or revoked. `ltc token` makes them.";
    FORBIDDEN = "forbidden", FORBIDDEN, "Forbidden",
        "The token is good, but lacks the scope that `WWW-Authenticate` names.";
    NO_SUCH_ROUTE = "no-such-route", NOT_FOUND, "No such route", "Nothing is at this path.";
    NO_SUCH_TABLE = "no-such-table", NOT_FOUND, "No such table", "`detail` lists the tables there are.";
    NO_SUCH_VERSION = "no-such-version", NOT_FOUND, "No such version",
        "The table has no published version of that number, digest or alias; `detail` lists some.";
    NO_SUCH_THING = "no-such-thing", NOT_FOUND, "No such thing", "There is no such alias, refit or problem type.";
    METHOD_NOT_ALLOWED = "method-not-allowed", METHOD_NOT_ALLOWED, "Method not allowed", "`Allow` lists the methods.";
    BODY_TIMEOUT = "body-timeout", REQUEST_TIMEOUT, "Body timed out", "The body did not arrive in time.";
    CONFLICT = "conflict", CONFLICT, "Conflict",
        "The state of things does not allow it: an idempotency key was used for another request, or a refit has ended.";
    PRECONDITION_FAILED = "precondition-failed", PRECONDITION_FAILED, "Precondition failed",
        "What is there is not what `If-Match` or `If-None-Match` says. Fetch it again, look at it, and decide anew.";
    BODY_TOO_LARGE = "body-too-large", PAYLOAD_TOO_LARGE, "Body too large", "`detail` names the limit.";
    TOO_MANY_QUERIES = "too-many-queries", PAYLOAD_TOO_LARGE, "Too many queries",
        "`detail` names the limit; send several requests.";
    UNSUPPORTED_MEDIA_TYPE = "unsupported-media-type", UNSUPPORTED_MEDIA_TYPE, "Unsupported media type",
        "`detail` names the media types that the body may have.";
    RANGE_NOT_SATISFIABLE = "range-not-satisfiable", RANGE_NOT_SATISFIABLE, "Range not satisfiable",
        "`Content-Range` names the length.";
    INVALID_VALUE = "invalid-value", UNPROCESSABLE_ENTITY, "Invalid value",
        "Everything can be read, but a value means nothing here; `field` names it.";
    TOO_COSTLY = "too-costly", UNPROCESSABLE_ENTITY, "Too costly",
        "The refit would take more memory or time than it may. `estimate` has the numbers: ask for fewer entries or samples.";
    QUARANTINED = "quarantined", UNPROCESSABLE_ENTITY, "Quarantined",
        "The uploaded table is not what its manifest says, or no table at all. It is kept under `version` and `digest` for inspection, \
         and neither listed nor served. `faults` lists what is wrong.";
    PRECONDITION_REQUIRED = "precondition-required", PRECONDITION_REQUIRED, "Precondition required",
        "An alias is moved by compare and swap: send `If-Match` with its ETag, or `If-None-Match: *` where there is none yet.";
    RATE_LIMITED = "rate-limited", TOO_MANY_REQUESTS, "Too many requests",
        "This client asks too often; `Retry-After` says when to go on.";
    QUEUE_FULL = "queue-full", TOO_MANY_REQUESTS, "Queue full", "As many refits wait as may.";
    INTERNAL = "internal", INTERNAL_SERVER_ERROR, "Internal error",
        "A fault of the service; its log has the cause under `request_id`.";
    TIMEOUT = "timeout", SERVICE_UNAVAILABLE, "Timed out", "The answer took too long.";
    OVERLOADED = "overloaded", SERVICE_UNAVAILABLE, "Overloaded",
        "There are too many requests at once; `Retry-After` says when to try again.";
    NOT_READY = "not-ready", SERVICE_UNAVAILABLE, "Not ready",
        "The store does not answer, there is no table to serve, or the service is about to stop.";
    STORE_UNWRITABLE = "store-unwritable", SERVICE_UNAVAILABLE, "Store unwritable",
        "The device is full or read-only. Nothing was changed; reading goes on.";
}

/// For errors that come from outside of the handlers.
pub(crate) static HTTP: ProblemType = ProblemType {
    slug: "http",
    status: StatusCode::INTERNAL_SERVER_ERROR,
    title: "Error",
    meaning: "An error of the protocol; the status says which.",
};

/// The type of that name.
pub(crate) fn by_slug(slug: &str) -> Option<&'static ProblemType> {
    ALL.iter().copied().chain([&HTTP]).find(|kind| kind.slug == slug)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_plain_and_differ() {
        for (i, kind) in ALL.iter().enumerate() {
            assert!(kind.slug.bytes().all(|b| b.is_ascii_lowercase() || b == b'-'), "{}", kind.slug);
            assert!(ALL[..i].iter().all(|other| other.slug != kind.slug), "{}", kind.slug);
            assert!(kind.status.is_client_error() || kind.status.is_server_error());
        }
    }

    #[test]
    fn the_documents_explain_every_type() {
        let page = include_str!("../../../docs/http.md");
        for kind in ALL {
            let row = format!("| `{}` | {} |", kind.slug, kind.status.as_u16());
            assert!(page.contains(&row), "docs/http.md lacks a row that begins with {row}");
        }
    }
}
