//! Bytes that can be fetched: with a tag, conditionally, in parts.

use axum::body::{Body, Bytes};
use axum::http::{HeaderMap, HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use serde::Serialize;

use crate::ApiError;
use crate::etag::ETag;
use crate::preconditions::{Preconditions, Wanted};
use crate::range::Part;

/// How long an answer may be kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Caching {
    /// For ever: addressed by what cannot change.
    Immutable,
    /// A minute: what an alias or a list names may change.
    Short,
}

impl Caching {
    fn header(self) -> HeaderValue {
        HeaderValue::from_static(match self {
            Self::Immutable => "public, max-age=31536000, immutable",
            Self::Short => "public, max-age=60",
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
        Self { etag: ETag::of_bytes(&bytes), bytes: bytes.into() }
    }
}

/// Bytes with everything that their answer says about them.
#[derive(Clone, Debug)]
pub(crate) struct Representation {
    content: Tagged,
    headers: HeaderMap,
}

impl Representation {
    pub(crate) fn new(content: Tagged, content_type: &'static str, caching: Caching) -> Self {
        let mut headers = HeaderMap::new();
        headers.insert(header::CONTENT_TYPE, HeaderValue::from_static(content_type));
        headers.insert(header::CACHE_CONTROL, caching.header());
        headers.insert(header::ACCEPT_RANGES, HeaderValue::from_static("bytes"));
        // Whoever compresses on the way must keep the encodings apart.
        headers.insert(header::VARY, HeaderValue::from_static("accept-encoding"));
        if let Some(etag) = content.etag.header() {
            headers.insert(header::ETAG, etag);
        }
        Self { content, headers }
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

    /// The answer to a request with these headers: 200, 206, or 304.
    ///
    /// # Errors
    /// [`ApiError::PreconditionFailed`], [`ApiError::RangeNotSatisfiable`].
    pub(crate) fn respond(self, request: &Preconditions) -> Result<Response, ApiError> {
        let Self { content, mut headers } = self;
        let length = content.bytes.len();
        match request.judge(&content.etag, length) {
            Wanted::Nothing => Err(ApiError::PreconditionFailed),
            Wanted::NotModified => {
                headers.remove(header::CONTENT_TYPE);
                headers.remove(header::CONTENT_DISPOSITION);
                Ok((StatusCode::NOT_MODIFIED, headers).into_response())
            }
            Wanted::Part(Part::Whole) => Ok((headers, Body::from(content.bytes)).into_response()),
            Wanted::Part(Part::Unsatisfiable) => Err(ApiError::RangeNotSatisfiable { length }),
            Wanted::Part(Part::Bytes(range)) => {
                let content_range = format!("bytes {}-{}/{length}", range.start, range.end - 1);
                let content_range = HeaderValue::from_str(&content_range).map_err(ApiError::internal)?;
                headers.insert(header::CONTENT_RANGE, content_range);
                let part = Body::from(content.bytes.slice(range));
                Ok((StatusCode::PARTIAL_CONTENT, headers, part).into_response())
            }
        }
    }
}
