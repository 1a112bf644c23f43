//! Bytes that can be fetched: with a tag, conditionally, in parts, compressed.

use std::io::Write;
use std::sync::Arc;

use axum::body::{Body, Bytes};
use axum::http::{HeaderMap, HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use flate2::Compression;
use flate2::write::GzEncoder;
use serde::Serialize;

use crate::ApiError;
use crate::etag::ETag;
use crate::preconditions::{Preconditions, Wanted};
use crate::range::Part;
use crate::request_id::X_REQUEST_ID;

/// How long an answer may be kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Caching {
    /// For ever: addressed by what cannot change.
    Immutable,
    /// A minute: what an alias or a list names may change.
    Short,
    /// Kept, but asked about each time.
    Checked,
}

impl Caching {
    /// Where reading needs a token, caches that several share keep nothing.
    fn header(self, private: bool) -> HeaderValue {
        HeaderValue::from_static(match (self, private) {
            (Self::Immutable, false) => "public, max-age=31536000, immutable",
            (Self::Immutable, true) => "private, max-age=31536000, immutable",
            (Self::Short, false) => "public, max-age=60",
            (Self::Short, true) => "private, max-age=60",
            (Self::Checked, _) => "no-cache",
        })
    }
}

/// Bytes and their tag.
#[derive(Clone, Debug)]
pub(crate) struct Tagged {
    pub bytes: Bytes,
    pub etag: ETag,
}

impl Tagged {
    pub(crate) fn new(bytes: Vec<u8>) -> Self {
        // Without the room that it grew into: it may be kept for long, and is counted by its length.
        Self::new_bytes(bytes.into_boxed_slice().into())
    }

    pub(crate) fn new_bytes(bytes: Bytes) -> Self {
        Self { etag: ETag::of_bytes(&bytes), bytes }
    }
}

/// Shorter ones are sent as they are: the headers weigh as much.
const COMPRESS_FROM: usize = 1024;
/// Longer ones are compressed off the threads that answer, or not at all.
const COMPRESS_AT_ONCE: usize = 256 << 10;

/// The bytes compressed; `None` where that saves less than a tenth.
pub(crate) fn compressed(bytes: &[u8]) -> Option<Vec<u8>> {
    if bytes.len() < COMPRESS_FROM {
        return None;
    }
    let mut encoder = GzEncoder::new(Vec::with_capacity(bytes.len() / 2), Compression::default());
    encoder.write_all(bytes).ok()?;
    let packed = encoder.finish().ok()?;
    (packed.len() < bytes.len() / 10 * 9).then_some(packed)
}

/// Bytes with everything that their answer says about them.
#[derive(Clone, Debug)]
pub(crate) struct Representation {
    content: Tagged,
    /// The same compressed. Bytes of their own have a tag of their own.
    gzip: Option<Tagged>,
    headers: HeaderMap,
    caching: Caching,
    kept: bool,
}

/// An answer of 200 that may be given again to the same question.
#[derive(Clone, Debug)]
pub(crate) struct Rendered {
    headers: HeaderMap,
    /// Those of a 304.
    headers_of_news: HeaderMap,
    pub content: Tagged,
    /// Whether it holds whatever is published.
    pub immutable: bool,
}

impl Rendered {
    /// With the headers that every answer has, so that nothing but the request's id is put into them later.
    fn new(mut headers: HeaderMap, content: Tagged, immutable: bool) -> Self {
        let mut headers_of_news = headers.clone();
        crate::headers::add(&mut headers_of_news, StatusCode::NOT_MODIFIED);
        crate::headers::add(&mut headers, StatusCode::OK);
        // A copy has no room for more: the request's id takes the place of this one.
        for headers in [&mut headers, &mut headers_of_news] {
            headers.insert(X_REQUEST_ID, HeaderValue::from_static(""));
        }
        Self { headers_of_news, headers, content, immutable }
    }

    /// The answer of 200; for `HEAD` without its body.
    pub(crate) fn whole(&self, head: bool) -> Response {
        let bytes = &self.content.bytes;
        let mut response = Response::new(if head { Body::empty() } else { Body::from(bytes.clone()) });
        *response.headers_mut() = self.headers.clone();
        // A body says its length itself; an empty one in place of it cannot.
        if head {
            response.headers_mut().insert(header::CONTENT_LENGTH, bytes.len().into());
        }
        response
    }

    /// The answer of 304.
    pub(crate) fn not_modified(&self) -> Response {
        news(self.headers_of_news.clone())
    }
}

impl Representation {
    pub(crate) fn new(content: Tagged, content_type: &'static str, caching: Caching) -> Self {
        let mut headers = HeaderMap::with_capacity(16);
        headers.insert(header::CONTENT_TYPE, HeaderValue::from_static(content_type));
        headers.insert(header::ACCEPT_RANGES, HeaderValue::from_static("bytes"));
        headers.insert(header::VARY, HeaderValue::from_static("accept-encoding"));
        Self { content, gzip: None, headers, caching, kept: false }
    }

    /// A value as JSON.
    pub(crate) fn json(value: &impl Serialize, caching: Caching) -> Result<Self, ApiError> {
        let bytes = serde_json::to_vec(value).map_err(ApiError::internal)?;
        Ok(Self::new(Tagged::new(bytes), "application/json", caching))
    }

    /// With a header more; its value is ours and always fits one.
    pub(crate) fn with(mut self, name: impl header::IntoHeaderName, value: &str) -> Self {
        if let Ok(value) = HeaderValue::from_str(value) {
            self.headers.insert(name, value);
        }
        self
    }

    /// With its compressed form, where there is one.
    pub(crate) fn with_gzip(mut self, gzip: Option<Tagged>) -> Self {
        self.gzip = gzip;
        self
    }

    /// To be given again to the same question, as long as nothing is published.
    pub(crate) fn kept(mut self) -> Self {
        self.kept = true;
        self
    }

    /// The answer to a request with these headers: 200, 206, or 304.
    ///
    /// # Errors
    /// [`ApiError::PreconditionFailed`], [`ApiError::RangeNotSatisfiable`].
    pub(crate) fn respond(self, request: &Preconditions) -> Result<Response, ApiError> {
        let Self { content, gzip, mut headers, caching, kept } = self;
        let gzip = gzip.filter(|_| request.wants_gzip()).or_else(|| {
            let at_once = request.wants_gzip() && content.bytes.len() <= COMPRESS_AT_ONCE;
            let text =
                |v: &HeaderValue| v.as_bytes().starts_with(b"text/") || v.as_bytes().ends_with(b"/json");
            let packed = at_once && headers.get(header::CONTENT_TYPE).is_some_and(text);
            packed.then(|| compressed(&content.bytes)).flatten().map(Tagged::new)
        });
        let content = match gzip {
            Some(gzip) => {
                headers.insert(header::CONTENT_ENCODING, HeaderValue::from_static("gzip"));
                gzip
            }
            None => content,
        };
        headers.insert(header::CACHE_CONTROL, caching.header(request.private()));
        if let Some(etag) = content.etag.header() {
            headers.insert(header::ETAG, etag);
        }
        let length = content.bytes.len();
        let wanted = request.judge(&content.etag, length);
        // Whoever asks only whether something is new makes its answer known as well as who fetches it.
        let known = matches!(wanted, Wanted::NotModified | Wanted::Part(Part::Whole)) && kept;
        let rendered = known.then(|| {
            let (headers, content) = (headers.clone(), content.clone());
            Arc::new(Rendered::new(headers, content, caching == Caching::Immutable))
        });
        let mut response = match wanted {
            Wanted::Nothing => {
                let reason = "the current representation is not one that If-Match names".to_owned();
                return Err(ApiError::PreconditionFailed { reason });
            }
            Wanted::NotModified => news(headers),
            Wanted::Part(Part::Whole) => (headers, Body::from(content.bytes)).into_response(),
            Wanted::Part(Part::Unsatisfiable) => return Err(ApiError::RangeNotSatisfiable { length }),
            Wanted::Part(Part::Bytes(range)) => {
                let content_range = format!("bytes {}-{}/{length}", range.start, range.end - 1);
                let content_range = HeaderValue::from_str(&content_range).map_err(ApiError::internal)?;
                headers.insert(header::CONTENT_RANGE, content_range);
                let part = Body::from(content.bytes.slice(range));
                (StatusCode::PARTIAL_CONTENT, headers, part).into_response()
            }
        };
        if let Some(rendered) = rendered {
            response.extensions_mut().insert(rendered);
        }
        Ok(response)
    }
}

/// 304 with these headers.
fn news(headers: HeaderMap) -> Response {
    let mut response = Response::new(Body::empty());
    *response.status_mut() = StatusCode::NOT_MODIFIED;
    *response.headers_mut() = headers;
    response
}
