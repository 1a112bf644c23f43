//! Entity tags, RFC 9110, section 8.8.3.

use axum::http::{HeaderMap, HeaderName, HeaderValue};

/// A strong entity tag: the SHA-256 of the bytes it is of, `"sha256:<hex>"` with the quotes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct ETag(String);

impl ETag {
    /// The tag of bytes whose digest is known.
    pub(crate) fn of_digest(digest: &str) -> Self {
        Self(format!("\"{digest}\""))
    }

    /// The tag of these bytes.
    pub(crate) fn of_bytes(bytes: &[u8]) -> Self {
        Self::of_digest(&ltc_table::digest::digest(bytes))
    }

    pub(crate) fn header(&self) -> Option<HeaderValue> {
        HeaderValue::from_str(&self.0).ok()
    }

    /// With its quotes.
    pub(crate) fn as_bytes(&self) -> &[u8] {
        self.0.as_bytes()
    }

    fn is(&self, tag: &Tag<'_>) -> bool {
        self.0.as_bytes() == tag.quoted
    }
}

/// A tag in a request.
struct Tag<'a> {
    weak: bool,
    /// With its quotes.
    quoted: &'a [u8],
}

/// The value of `If-Match` or `If-None-Match`: `*`, or a list of tags.
#[derive(Clone, Debug, Default)]
pub(crate) struct TagList(Vec<HeaderValue>);

impl TagList {
    /// Every line of that header; `None` when there is none.
    pub(crate) fn of(headers: &HeaderMap, name: &HeaderName) -> Option<Self> {
        let lines: Vec<_> = headers.get_all(name).iter().cloned().collect();
        (!lines.is_empty()).then_some(Self(lines))
    }

    /// Whether a tag of the list has the same text, weak or not (for `If-None-Match`).
    pub(crate) fn matches_weakly(&self, etag: &ETag) -> bool {
        self.any(|tag| etag.is(tag))
    }

    /// Whether a strong tag of the list is the same (for `If-Match`).
    pub(crate) fn matches_strongly(&self, etag: &ETag) -> bool {
        self.any(|tag| !tag.weak && etag.is(tag))
    }

    /// Whether it is `*`.
    pub(crate) fn is_any(&self) -> bool {
        self.0.iter().any(|line| line.as_bytes().trim_ascii() == b"*")
    }

    fn any(&self, mut test: impl FnMut(&Tag<'_>) -> bool) -> bool {
        self.0.iter().any(|line| {
            let line = line.as_bytes().trim_ascii();
            line == b"*" || tags(line).any(|tag| test(&tag))
        })
    }
}

/// Whether an `If-Range` value is this tag. It must be strong; a date never matches, as nothing here has one.
pub(crate) fn if_range_holds(value: &HeaderValue, etag: &ETag) -> bool {
    value.as_bytes().trim_ascii() == etag.0.as_bytes()
}

/// The tags of a list, up to the first that is malformed. Commas within quotes belong to the tag.
fn tags(mut rest: &[u8]) -> impl Iterator<Item = Tag<'_>> {
    std::iter::from_fn(move || {
        let start = rest.iter().position(|b| !b", \t".contains(b))?;
        rest = &rest[start..];
        let weak = rest.starts_with(b"W/");
        let opening = if weak { &rest[2..] } else { rest };
        let inner = opening.strip_prefix(b"\"")?;
        let end = inner.iter().position(|b| *b == b'"')? + 2;
        let quoted = &opening[..end];
        rest = &opening[end..];
        Some(Tag { weak, quoted })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use axum::http::header::IF_NONE_MATCH;

    fn list(lines: &[&str]) -> TagList {
        let headers = lines.iter().map(|l| (IF_NONE_MATCH, HeaderValue::from_str(l).unwrap()));
        TagList::of(&headers.collect(), &IF_NONE_MATCH).unwrap()
    }

    #[test]
    fn lists_weak_tags_and_stars_match() {
        let etag = ETag("\"a,b\"".into());
        for lines in [
            &["\"a,b\""][..],
            &["W/\"a,b\""],
            &["*"],
            &[" * "],
            &["\"x\", \"a,b\""],
            &[",, W/\"x\" ,\t\"a,b\",\"y\""],
            &["\"x\"", "\"a,b\""],
        ] {
            assert!(list(lines).matches_weakly(&etag), "{lines:?}");
        }
        for lines in [
            &[""][..],
            &["a,b"],
            &["\"a\", \"b\""],
            &["\"A,B\""],
            &["\"a,b"],
            &["W/ \"a,b\""],
            &["w/\"a,b\""],
            &["junk \"a,b\""],
            &["\"*\""],
        ] {
            assert!(!list(lines).matches_weakly(&etag), "{lines:?}");
        }
        assert!(TagList::of(&HeaderMap::new(), &IF_NONE_MATCH).is_none());
    }

    #[test]
    fn strong_comparison_refuses_weak_tags() {
        let etag = ETag("\"a\"".into());
        assert!(list(&["\"a\""]).matches_strongly(&etag));
        assert!(list(&["*"]).matches_strongly(&etag));
        assert!(!list(&["W/\"a\""]).matches_strongly(&etag));
        let holds = |text| if_range_holds(&HeaderValue::from_static(text), &etag);
        assert!(holds("\"a\""));
        assert!(!holds("W/\"a\""));
        assert!(!holds("*"));
        assert!(!holds("Mon, 01 Jan 2024 00:00:00 GMT"));
    }

    #[test]
    fn the_tag_is_the_digest_of_the_bytes() {
        assert_eq!(ETag::of_bytes(b"x"), ETag::of_digest(&ltc_table::digest::digest(b"x")));
        assert_ne!(ETag::of_bytes(b"x"), ETag::of_bytes(b"y"));
    }
}
