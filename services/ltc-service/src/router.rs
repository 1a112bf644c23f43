//! Every route, and what surrounds them all.

use std::any::Any;

use axum::Router;
use axum::extract::DefaultBodyLimit;
use axum::response::{IntoResponse, Response};
use axum::routing::{MethodRouter, any, get, post, put};
use tower::util::MapResponseLayer;
use tower_http::catch_panic::CatchPanicLayer;

use crate::gate::Gate;
use crate::metrics::RouteLabel;
use crate::routes::{
    aliases, benchmarks, data, diff, docs, events, health, history, index, lookup, metrics, problems, refits,
    shaders, tables, upload,
};
use crate::{ApiError, AppState};

/// Every path with its methods. `GET` answers `HEAD` too. The document at `/openapi.json` has the same paths and methods, or a
/// test fails.
fn routes(upload_bytes: usize) -> Vec<(&'static str, MethodRouter<AppState>)> {
    let versions =
        get(tables::versions).merge(post(upload::version).layer(DefaultBodyLimit::max(upload_bytes)));
    vec![
        ("/", get(index::page)),
        ("/benchmarks", get(history::charts)),
        ("/docs", get(docs::page)),
        ("/openapi.json", get(docs::openapi)),
        ("/problems", get(problems::list)),
        ("/problems/{slug}", get(problems::one)),
        ("/healthz", get(health::alive)),
        ("/readyz", get(health::ready)),
        ("/metrics", get(metrics::text)),
        ("/v1/tables", get(tables::list)),
        ("/v1/tables/{name}", get(tables::latest)),
        ("/v1/tables/{name}/aliases", get(aliases::list)),
        ("/v1/tables/{name}/aliases/{alias}", get(aliases::one).merge(put(aliases::moved))),
        ("/v1/tables/{name}/versions", versions),
        ("/v1/tables/{name}/versions/{version}", get(tables::manifest)),
        ("/v1/tables/{name}/versions/{version}/data", get(data::table)),
        ("/v1/tables/{name}/versions/{version}/fresnel", get(data::fresnel)),
        ("/v1/tables/{name}/versions/{version}/lookup", get(lookup::one).merge(post(lookup::batch))),
        ("/v1/tables/{name}/versions/{version}/diff/{other}", get(diff::between)),
        ("/v1/refits", get(refits::list).merge(post(refits::ask))),
        ("/v1/refits/{id}", get(refits::one).delete(refits::cancel)),
        ("/v1/refits/{id}/events", get(events::stream)),
        ("/v1/shaders/{lang}", get(shaders::source)),
        ("/v1/benchmarks", get(benchmarks::list).merge(post(benchmarks::add))),
    ]
}

/// The patterns that metrics are labelled with; the first stands for requests that match none.
pub(crate) fn patterns() -> Vec<&'static str> {
    ["none"].into_iter().chain(routes(0).into_iter().map(|(path, _)| path)).collect()
}

/// The service over a state, to be asked without a connection.
pub fn app(state: AppState) -> Router {
    // The gate is asked before any route is looked for: what was answered before is answered again from there.
    Router::new().fallback_service(any(Gate::handle).with_state(gate(state)))
}

/// The service over a state.
pub(crate) fn gate(state: AppState) -> Gate {
    let mut router = Router::new();
    for (index, (path, methods)) in routes(state.limits().upload_bytes).into_iter().enumerate() {
        let label = RouteLabel(index + 1);
        router = router.route(path, labelled(methods, label));
    }
    surrounded(router, state)
}

/// Says in the answer's extensions which route it is of.
fn labelled(methods: MethodRouter<AppState>, label: RouteLabel) -> MethodRouter<AppState> {
    methods.layer(MapResponseLayer::new(move |mut response: Response| {
        response.extensions_mut().insert(label);
        response
    }))
}

/// Gives routes their fallbacks and layers, and puts the gate before them.
fn surrounded(routes: Router<AppState>, state: AppState) -> Gate {
    let routes = routes
        .fallback(async || ApiError::NoSuchRoute)
        .method_not_allowed_fallback(async || ApiError::MethodNotAllowed)
        .layer(DefaultBodyLimit::max(state.limits().body_bytes))
        .layer(CatchPanicLayer::custom(answer_panic))
        .with_state(state.clone());
    Gate::new(state, routes)
}

fn answer_panic(panic: Box<dyn Any + Send>) -> Response {
    let cause = panic.downcast_ref::<&str>().copied();
    let cause = cause.or_else(|| panic.downcast_ref::<String>().map(String::as_str));
    ApiError::internal(cause.unwrap_or("panic of unknown type")).into_response()
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;
    use std::time::Duration;

    use super::*;
    use crate::metrics::MOST_ROUTES;
    use crate::{Limits, Settings, Stores};
    use axum::body::Body;
    use axum::extract::State;
    use axum::http::{Request, StatusCode};
    use http_body_util::BodyExt;
    use ltc_store::MemoryStore;

    async fn answer(limits: Limits, path: &str) -> (Response<()>, serde_json::Value) {
        let routes = Router::new()
            .route("/panic", get(async || -> StatusCode { panic!("planted, with a secret") }))
            .route("/panic-off-thread", get(panic_off_thread))
            .route("/sleep", get(sleep))
            .route("/plain", get(async || (StatusCode::IM_A_TEAPOT, "plain text")));
        let settings = Settings { limits, ..Settings::default() };
        let state = AppState::new(Stores::of(Arc::new(MemoryStore::default())), settings).await.unwrap();
        let app: Gate = surrounded(routes, state);
        let request = Request::get(path).body(Body::empty()).unwrap();
        let (parts, body) = app.answer(request, None).await.into_parts();
        let body = body.collect().await.unwrap().to_bytes();
        (Response::from_parts(parts, ()), serde_json::from_slice(&body).unwrap())
    }

    async fn panic_off_thread(State(state): State<AppState>) -> Result<(), ApiError> {
        state.compute().run(|| panic!("planted, with a secret")).await
    }

    async fn sleep() -> StatusCode {
        tokio::time::sleep(Duration::from_secs(60)).await;
        StatusCode::OK
    }

    #[tokio::test]
    async fn panics_are_problems_that_tell_no_secrets() {
        for path in ["/panic", "/panic-off-thread"] {
            let (response, problem) = answer(Limits::default(), path).await;
            assert_eq!(response.status(), StatusCode::INTERNAL_SERVER_ERROR);
            assert_eq!(response.headers()["content-type"], "application/problem+json");
            assert_eq!(problem["type"], "urn:ltc:problem:internal");
            assert_eq!(problem["instance"], path);
            assert_eq!(problem["request_id"], response.headers()["x-request-id"].to_str().unwrap());
            assert!(!problem.to_string().contains("secret"), "{problem}");
        }
    }

    #[tokio::test]
    async fn a_slow_answer_is_a_problem() {
        let limits = Limits { request_seconds: 0.02, ..Limits::default() };
        let (response, problem) = answer(limits, "/sleep").await;
        assert_eq!(response.status(), StatusCode::SERVICE_UNAVAILABLE);
        assert_eq!(response.headers()["retry-after"], "1");
        assert_eq!(problem["type"], "urn:ltc:problem:timeout");
    }

    #[tokio::test]
    async fn errors_from_elsewhere_become_problems() {
        let (response, problem) = answer(Limits::default(), "/plain").await;
        assert_eq!(response.status(), StatusCode::IM_A_TEAPOT);
        assert_eq!(response.headers()["content-type"], "application/problem+json");
        assert_eq!(problem["status"], 418);
        assert_eq!(problem["title"], "I'm a teapot");
    }

    #[test]
    fn every_route_has_room_in_the_metrics() {
        assert!(patterns().len() <= MOST_ROUTES);
    }
}
