//! What a request knows already, and which part it wants.

use std::convert::Infallible;

use axum::extract::FromRequestParts;
use axum::http::{HeaderValue, Method, header, request::Parts};

use crate::etag::{ETag, TagList, if_range_holds};
use crate::range::{Part, part};

/// The conditional and range headers of a request.
#[derive(Clone, Debug, Default)]
pub(crate) struct Preconditions {
    if_match: Option<TagList>,
    if_none_match: Option<TagList>,
    range: Option<HeaderValue>,
    if_range: Option<HeaderValue>,
}

/// What the headers ask for, by the order of RFC 9110, section 13.2.2.
#[derive(Debug, PartialEq)]
pub(crate) enum Wanted {
    /// Nothing: `If-Match` fails.
    Nothing,
    /// Only the news that it has not changed.
    NotModified,
    /// All of it or a part.
    Part(Part),
}

impl Preconditions {
    /// Judges the headers for a representation of that tag and length.
    pub(crate) fn judge(&self, etag: &ETag, length: usize) -> Wanted {
        if self.if_match.as_ref().is_some_and(|tags| !tags.matches_strongly(etag)) {
            return Wanted::Nothing;
        }
        if self.if_none_match.as_ref().is_some_and(|tags| tags.matches_weakly(etag)) {
            return Wanted::NotModified;
        }
        let current = self.if_range.as_ref().is_none_or(|tag| if_range_holds(tag, etag));
        let range = self.range.as_ref().filter(|_| current).and_then(|r| r.to_str().ok());
        Wanted::Part(range.map_or(Part::Whole, |range| part(range, length)))
    }
}

impl<S: Sync> FromRequestParts<S> for Preconditions {
    type Rejection = Infallible;

    async fn from_request_parts(parts: &mut Parts, _: &S) -> Result<Self, Infallible> {
        let headers = &parts.headers;
        // Ranges are defined for GET alone, and a header that comes twice is no range.
        let mut ranges = headers.get_all(header::RANGE).iter();
        let range = match (ranges.next(), ranges.next()) {
            (Some(range), None) if parts.method == Method::GET => Some(range.clone()),
            _ => None,
        };
        Ok(Self {
            if_match: TagList::of(headers, &header::IF_MATCH),
            if_none_match: TagList::of(headers, &header::IF_NONE_MATCH),
            range,
            if_range: headers.get(header::IF_RANGE).cloned(),
        })
    }
}
