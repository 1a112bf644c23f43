//! What a request knows already, which part it wants, and how.

use axum::extract::FromRequestParts;
use axum::http::{HeaderMap, HeaderValue, Method, header, request::Parts};
use std::convert::Infallible;

use crate::AppState;
use crate::etag::{ETag, TagList, if_range_holds};
use crate::range::{Part, part};
use crate::settings::Access;

/// The conditional, range and encoding headers of a request.
#[derive(Clone, Debug, Default)]
pub(crate) struct Preconditions {
    if_match: Option<TagList>,
    if_none_match: Option<TagList>,
    range: Option<HeaderValue>,
    if_range: Option<HeaderValue>,
    gzip: bool,
    private: bool,
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
    fn of(method: &Method, headers: &HeaderMap, private: bool) -> Self {
        // Ranges are defined for GET alone, and a header that comes twice is no range.
        let mut ranges = headers.get_all(header::RANGE).iter();
        let range = match (ranges.next(), ranges.next()) {
            (Some(range), None) if *method == Method::GET => Some(range.clone()),
            _ => None,
        };
        Self {
            if_match: TagList::of(headers, &header::IF_MATCH),
            if_none_match: TagList::of(headers, &header::IF_NONE_MATCH),
            // Ranges are of the plain bytes: whoever continues a download need not know how its beginning was encoded.
            gzip: accepts_gzip(headers) && !headers.contains_key(header::RANGE),
            range,
            if_range: headers.get(header::IF_RANGE).cloned(),
            private,
        }
    }

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

    /// Whether a compressed body is welcome.
    pub(crate) fn wants_gzip(&self) -> bool {
        self.gzip
    }

    /// Whether the answer is for this client alone.
    pub(crate) fn private(&self) -> bool {
        self.private
    }
}

/// Whether `Accept-Encoding` asks for gzip: it or `*` is named with a weight above 0.
pub(crate) fn accepts_gzip(headers: &HeaderMap) -> bool {
    let mut star = false;
    for line in headers.get_all(header::ACCEPT_ENCODING) {
        for item in line.to_str().unwrap_or_default().split(',') {
            let mut parts = item.split(';').map(str::trim);
            let name = parts.next().unwrap_or_default();
            let weight = parts.find_map(|part| part.strip_prefix("q=").or_else(|| part.strip_prefix("Q=")));
            let welcome = weight.is_none_or(|q| q.trim().parse::<f32>().is_ok_and(|q| q > 0.0));
            if name.eq_ignore_ascii_case("gzip") {
                return welcome;
            }
            star |= name == "*" && welcome;
        }
    }
    star
}

impl FromRequestParts<AppState> for Preconditions {
    type Rejection = Infallible;

    async fn from_request_parts(parts: &mut Parts, state: &AppState) -> Result<Self, Infallible> {
        let private = state.settings().read == Access::Token;
        Ok(Self::of(&parts.method, &parts.headers, private))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gzip_is_sent_to_whoever_asks_for_it() {
        let asks = |text: &str| {
            let value = HeaderValue::from_str(text).unwrap();
            accepts_gzip(&HeaderMap::from_iter([(header::ACCEPT_ENCODING, value)]))
        };
        for text in ["gzip", "br, gzip", "GZIP;q=0.1", "deflate, gzip; q=1.0", "*", "br;q=1, *;q=0.5"] {
            assert!(asks(text), "{text}");
        }
        for text in ["", "identity", "gzip;q=0", "gzip;q=0.000, *", "br", "*;q=0", "gzip;q=x", "xgzip"] {
            assert!(!asks(text), "{text}");
        }
        assert!(!accepts_gzip(&HeaderMap::new()));
    }
}
