//! A name for each request, for its log line, its answer and its problem document.

use std::hash::{BuildHasher, RandomState};
use std::sync::LazyLock;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use axum::extract::Request;
use axum::http::{HeaderMap, HeaderName, HeaderValue};
use axum::middleware::Next;
use axum::response::Response;

pub(crate) const X_REQUEST_ID: HeaderName = HeaderName::from_static("x-request-id");
const MAX_LENGTH: usize = 128;

/// The client's `x-request-id` where it is a plain word, else one of ours.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct RequestId(HeaderValue);

impl RequestId {
    pub(crate) fn as_str(&self) -> &str {
        // Both constructors let only visible ASCII through.
        self.0.to_str().unwrap_or_default()
    }

    fn of(headers: &HeaderMap) -> Self {
        headers.get(X_REQUEST_ID).filter(|v| is_plain(v.as_bytes())).cloned().map_or_else(Self::fresh, Self)
    }

    /// Unique, not secret: a number drawn for the process, and a count.
    fn fresh() -> Self {
        static PROCESS: LazyLock<u64> = LazyLock::new(|| RandomState::new().hash_one(std::process::id()));
        static COUNT: AtomicU64 = AtomicU64::new(1);
        let text = format!("{:016x}-{:x}", *PROCESS, COUNT.fetch_add(1, Ordering::Relaxed));
        Self(HeaderValue::from_str(&text).unwrap_or(HeaderValue::from_static("unnamed")))
    }
}

fn is_plain(id: &[u8]) -> bool {
    let plain = |b: &u8| b.is_ascii_alphanumeric() || b"-_.:/+=".contains(b);
    (1..=MAX_LENGTH).contains(&id.len()) && id.iter().all(plain)
}

/// Names the request, logs its end, and returns the name with the answer.
pub(crate) async fn name_and_log(mut request: Request, next: Next) -> Response {
    let id = RequestId::of(request.headers());
    request.extensions_mut().insert(id.clone());
    let (method, uri) = (request.method().clone(), request.uri().clone());
    let start = Instant::now();
    let mut response = next.run(request).await;
    // The path without the query: a query may one day hold what a log must not.
    tracing::info!(
        request_id = id.as_str(),
        method = method.as_str(),
        path = uri.path(),
        status = response.status().as_u16(),
        microseconds = start.elapsed().as_micros() as u64,
        "request"
    );
    response.headers_mut().insert(X_REQUEST_ID, id.0);
    response
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fresh_ids_differ_and_are_plain() {
        let (a, b) = (RequestId::fresh(), RequestId::fresh());
        assert_ne!(a, b);
        assert!(is_plain(a.as_str().as_bytes()));
    }

    #[test]
    fn only_plain_words_are_taken_over() {
        let of = |value: &[u8]| {
            let headers = [(X_REQUEST_ID, HeaderValue::from_bytes(value).unwrap())];
            RequestId::of(&HeaderMap::from_iter(headers)).as_str().to_owned()
        };
        assert_eq!(of(b"build-42"), "build-42");
        for bad in [&b""[..], b"a b", b"a\"b", b"\xff", &[b'a'; MAX_LENGTH + 1]] {
            assert_ne!(of(bad).as_bytes(), bad);
        }
        assert_eq!(of(&[b'a'; MAX_LENGTH]).len(), MAX_LENGTH);
    }
}
