//! A name for each request: for its log line, its answer and its problem document.

use std::hash::{BuildHasher, RandomState};
use std::sync::LazyLock;
use std::sync::atomic::{AtomicU64, Ordering};

use axum::http::{HeaderMap, HeaderName, HeaderValue};

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

    pub(crate) fn header(&self) -> HeaderValue {
        self.0.clone()
    }

    pub(crate) fn into_header(self) -> HeaderValue {
        self.0
    }

    pub(crate) fn of(headers: &HeaderMap) -> Self {
        headers.get(&X_REQUEST_ID).filter(|v| is_plain(v.as_bytes())).cloned().map_or_else(Self::fresh, Self)
    }

    /// Unique, not secret: a number drawn for the process, and a count. Written by hand: every answer has one.
    fn fresh() -> Self {
        static PROCESS: LazyLock<u64> = LazyLock::new(|| RandomState::new().hash_one(std::process::id()));
        static COUNT: AtomicU64 = AtomicU64::new(1);
        let mut text = [b'-'; 33];
        write_hex(*PROCESS, &mut text[..16]);
        write_hex(COUNT.fetch_add(1, Ordering::Relaxed), &mut text[17..]);
        Self(HeaderValue::from_bytes(&text).unwrap_or(HeaderValue::from_static("unnamed")))
    }
}

/// The last digits of a number, with zeros before it.
fn write_hex(mut number: u64, out: &mut [u8]) {
    for digit in out.iter_mut().rev() {
        *digit = b"0123456789abcdef"[(number & 15) as usize];
        number >>= 4;
    }
}

fn is_plain(id: &[u8]) -> bool {
    let plain = |b: &u8| b.is_ascii_alphanumeric() || b"-_.:/+=".contains(b);
    (1..=MAX_LENGTH).contains(&id.len()) && id.iter().all(plain)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fresh_ids_differ_and_are_plain() {
        let (a, b) = (RequestId::fresh(), RequestId::fresh());
        assert_ne!(a, b);
        assert!(is_plain(a.as_str().as_bytes()));
        let mut text = [0; 4];
        write_hex(0x0a_bcde, &mut text);
        assert_eq!(&text, b"bcde");
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
