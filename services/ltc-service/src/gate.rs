//! What every request passes on its way in, and every answer on its way out.

use std::net::IpAddr;
use std::time::Instant;

use axum::Router;
use axum::extract::{Request, State};
use axum::http::{self, HeaderMap, Method};
use axum::response::{IntoResponse, Response};
use tower::ServiceExt;

use crate::answers::Question;
use crate::auth::{Caller, is_presented};
use crate::metrics::RouteLabel;
use crate::rates::Client;
use crate::request_id::{RequestId, X_REQUEST_ID};
use crate::settings::Access;
use crate::{ApiError, AppState, headers, problem};

/// Everything before and after the routes.
#[derive(Clone)]
pub(crate) struct Gate {
    state: AppState,
    routes: Router,
}

/// What a log line says.
struct Line {
    method: Method,
    path: String,
    start: Instant,
}

impl Gate {
    pub(crate) fn new(state: AppState, routes: Router) -> Self {
        Self { state, routes }
    }

    /// [`Gate::answer`] as a handler, without a connection.
    pub(crate) async fn handle(State(gate): State<Self>, request: Request) -> Response {
        gate.answer(request, None).await
    }

    /// Answers a request from that address, whatever happens.
    pub(crate) async fn answer(&self, request: Request, peer: Option<IpAddr>) -> Response {
        let start = Instant::now();
        match self.answer_again(&request, peer, start) {
            Some(response) => response,
            None => self.answer_anew(request, peer, start).await,
        }
    }

    /// The short way of what is asked for all day: an answer that was given before, to somebody without a token, where none is
    /// needed. Nothing is waited for, and nothing is built but the list of its headers.
    pub(crate) fn answer_again<B>(
        &self,
        request: &http::Request<B>,
        peer: Option<IpAddr>,
        start: Instant,
    ) -> Option<Response> {
        if self.state.settings().read != Access::Open || is_presented(request.headers()) {
            return None;
        }
        let (response, route) = self.state.answers().find(request, self.state.revision())?;
        // A client that asks too often is counted, and told so, on the long way.
        self.state.rates().read(|| Client::of_address(peer)).ok()?;
        Some(self.finish_again(response, route, request, start))
    }

    /// What is left to do for such an answer.
    fn finish_again<B>(
        &self,
        mut response: Response,
        route: RouteLabel,
        request: &http::Request<B>,
        start: Instant,
    ) -> Response {
        let id = RequestId::of(request.headers());
        self.state.metrics().answer_hits.add(1);
        let (status, time) = (response.status().as_u16(), start.elapsed());
        self.state.metrics().answered(route, status, time);
        if tracing::enabled!(tracing::Level::DEBUG) {
            let line =
                Line { method: request.method().clone(), path: request.uri().path().to_owned(), start };
            log(&line, &id, status, time.as_micros() as u64);
        }
        response.headers_mut().insert(X_REQUEST_ID, id.into_header());
        response
    }

    /// The long way of everything else.
    pub(crate) async fn answer_anew(
        &self,
        request: Request,
        peer: Option<IpAddr>,
        start: Instant,
    ) -> Response {
        let id = RequestId::of(request.headers());
        let line = Line { method: request.method().clone(), path: request.uri().path().to_owned(), start };
        let (response, route) = if headers::is_preflight(&request) {
            (headers::answer_preflight(), RouteLabel(0))
        } else {
            self.admit(request, peer).await
        };
        self.finish(response, route, &id, &line)
    }

    async fn admit(&self, mut request: Request, peer: Option<IpAddr>) -> (Response, RouteLabel) {
        let refused = |error: ApiError| (error.into_response(), RouteLabel(0));
        let path = request.uri().path();
        let reads = request.method().is_safe() || path.ends_with("/lookup");
        let caller = match self.identify(request.headers(), path, reads, peer).await {
            Ok(caller) => caller,
            Err(error) => return refused(error),
        };
        if let Err(error) = self.check_rate(caller.as_ref(), peer) {
            self.state.metrics().limited.add(1);
            return refused(error);
        }
        let revision = self.state.revision();
        if let Some(known) = self.state.answers().find(&request, revision) {
            self.state.metrics().answer_hits.add(1);
            return known;
        }
        let Ok(_permit) = self.state.requests().try_acquire() else {
            self.state.metrics().shed.add(1);
            return refused(ApiError::Overloaded);
        };
        if let Some(caller) = caller {
            request.extensions_mut().insert(caller);
        }
        let question = Question::of(&request);
        let mut response = self.route(request).await;
        let route = response.extensions().get().copied().unwrap_or(RouteLabel(0));
        if let Some(question) = question {
            self.state.answers().keep(&question, &mut response, revision, route);
        }
        (response, route)
    }

    /// Who asks, where that matters: a token that is sent must be good, and reading may need one. What writes asks for its own scope.
    async fn identify(
        &self,
        headers: &HeaderMap,
        path: &str,
        reads: bool,
        address: Option<IpAddr>,
    ) -> Result<Option<Caller>, ApiError> {
        let private = self.state.settings().read == Access::Token && is_private(path);
        if !private && !is_presented(headers) {
            return Ok(None);
        }
        let (metadata, guess) = (&self.state.stores().metadata, || self.state.allow_guess(address));
        let caller = self.state.tokens().caller(headers, &**metadata, guess).await?;
        if private {
            let caller = caller.as_ref().ok_or(ApiError::Unauthenticated {
                reason: "reading needs a bearer token here; ltc token create makes one",
                presented: false,
            })?;
            if reads {
                caller.must(ltc_store::Scope::Read)?;
            }
        }
        Ok(caller)
    }

    /// Every request is counted here, and writes once more where their token's scope is known.
    fn check_rate(&self, caller: Option<&Caller>, peer: Option<IpAddr>) -> Result<(), ApiError> {
        self.state.rates().read(|| match caller {
            Some(caller) => Client::Token(caller.id.clone()),
            None => Client::of_address(peer),
        })
    }

    async fn route(&self, request: Request) -> Response {
        // An upload is measured anew, which takes as long as it takes.
        let long = request.method() == Method::POST && request.uri().path().ends_with("/versions");
        let time = self.state.limits().request_time() * if long { 10 } else { 1 };
        match tokio::time::timeout(time, self.routes.clone().oneshot(request)).await {
            Ok(Ok(response)) => response,
            Ok(Err(never)) => match never {},
            Err(_) => ApiError::Timeout.into_response(),
        }
    }

    fn finish(&self, response: Response, route: RouteLabel, id: &RequestId, line: &Line) -> Response {
        let mut response = problem::render(response, &line.path, id);
        let status = response.status();
        let headers = response.headers_mut();
        headers::add(headers, status);
        headers.insert(X_REQUEST_ID, id.header());
        let time = line.start.elapsed();
        self.state.metrics().answered(route, status.as_u16(), time);
        log(line, id, status.as_u16(), time.as_micros() as u64);
        response
    }
}

/// One line for each request: those that read and get what they asked for at the level `debug`, others at `info`. The path without
/// the query, which may one day hold what a log must not; no header ever.
fn log(line: &Line, id: &RequestId, status: u16, microseconds: u64) {
    let (request_id, method, path) = (id.as_str(), line.method.as_str(), line.path.as_str());
    if line.method.is_safe() && status < 400 {
        tracing::debug!(request_id, method, path, status, microseconds, "request");
    } else {
        tracing::info!(request_id, method, path, status, microseconds, "request");
    }
}

/// Whether a path needs a token where reading does. What tells nothing about tables never does.
fn is_private(path: &str) -> bool {
    path == "/" || path == "/benchmarks" || path.starts_with("/v1/")
}
