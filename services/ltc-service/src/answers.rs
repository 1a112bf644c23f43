//! Answers that can be given again as they are: what pipelines ask for all day.

use std::sync::Arc;

use axum::body::Body;
use axum::http::{HeaderMap, Method, Request, header};
use axum::response::Response;

use crate::cache::Cache;
use crate::metrics::RouteLabel;
use crate::preconditions::accepts_gzip;
use crate::representation::Rendered;

/// What a kept answer costs besides its body: headers and the path.
const HEAD_BYTES: usize = 4096;

/// Answers of 200 by path and query, plain and compressed.
#[derive(Debug)]
pub(crate) struct Answers {
    plain: Cache<String, Kept>,
    gzip: Cache<String, Kept>,
}

#[derive(Clone, Debug)]
struct Kept {
    rendered: Arc<Rendered>,
    /// Revision of the index that it was made of.
    revision: u64,
    route: RouteLabel,
}

/// Whether a request is of the plain kind that is answered from here: no ranges, and no condition but `If-None-Match`.
fn is_plain(method: &Method, headers: &HeaderMap) -> bool {
    let reads = *method == Method::GET || *method == Method::HEAD;
    let others = [header::RANGE, header::IF_MATCH, header::IF_RANGE];
    reads && others.iter().all(|name| !headers.contains_key(name))
}

impl Answers {
    pub(crate) fn new(bytes: usize) -> Self {
        Self { plain: Cache::new(bytes / 2), gzip: Cache::new(bytes / 2) }
    }

    /// Bytes held now.
    pub(crate) fn bytes(&self) -> usize {
        self.plain.bytes() + self.gzip.bytes()
    }

    fn cache(&self, headers: &HeaderMap) -> &Cache<String, Kept> {
        if accepts_gzip(headers) { &self.gzip } else { &self.plain }
    }

    /// The answer to a request that was answered before.
    pub(crate) fn find<B>(&self, request: &Request<B>, revision: u64) -> Option<(Response, RouteLabel)> {
        let headers = request.headers();
        if !is_plain(request.method(), headers) {
            return None;
        }
        let target = request.uri().path_and_query()?.as_str();
        let Kept { rendered, revision: of, route } = self.cache(headers).get(target)?;
        if of != revision && !rendered.immutable {
            return None;
        }
        let mut tags = headers.get_all(header::IF_NONE_MATCH).iter();
        let response = match (tags.next(), tags.next()) {
            (None, _) => rendered.whole(*request.method() == Method::HEAD),
            (Some(tag), None) if tag.as_bytes() == rendered.content.etag.as_bytes() => {
                rendered.not_modified()
            }
            // Lists and weak tags are read with more care elsewhere.
            _ => return None,
        };
        Some((response, route))
    }

    /// Keeps an answer, if it is one to be kept.
    pub(crate) fn keep(
        &self,
        question: &Question,
        response: &mut Response,
        revision: u64,
        route: RouteLabel,
    ) {
        let Some(rendered) = response.extensions_mut().remove::<Arc<Rendered>>() else { return };
        let bytes = rendered.content.bytes.len() + HEAD_BYTES;
        let cache = if question.gzip { &self.gzip } else { &self.plain };
        cache.insert(question.target.clone(), Kept { rendered, revision, route }, bytes);
    }
}

/// What has to be remembered of a request to keep its answer.
#[derive(Debug)]
pub(crate) struct Question {
    target: String,
    gzip: bool,
}

/// Longer targets are not kept: nobody asks for them twice.
const LONGEST_TARGET: usize = 512;

impl Question {
    /// Of a request whose answer may be kept.
    pub(crate) fn of(request: &Request<Body>) -> Option<Self> {
        let headers = request.headers();
        let target = request.uri().path_and_query().filter(|t| t.as_str().len() <= LONGEST_TARGET)?;
        is_plain(request.method(), headers)
            .then(|| Self { target: target.as_str().to_owned(), gzip: accepts_gzip(headers) })
    }
}
