//! Every route, and what surrounds them all.

use std::any::Any;

use axum::Router;
use axum::extract::{DefaultBodyLimit, Request, State};
use axum::middleware::{Next, from_fn, from_fn_with_state};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use tower_http::catch_panic::CatchPanicLayer;

use crate::routes::{data, health, index, lookup, tables};
use crate::{ApiError, AppState, headers, problem, request_id};

/// The service over these tables.
pub fn app(state: AppState) -> Router {
    let version = Router::new()
        .route("/", get(tables::manifest))
        .route("/data", get(data::table))
        .route("/fresnel", get(data::fresnel))
        .route("/lookup", get(lookup::one).post(lookup::batch));
    let routes = Router::new()
        .route("/", get(index::page))
        .route("/healthz", get(health::alive))
        .route("/readyz", get(health::ready))
        .route("/v1/tables", get(tables::list))
        .route("/v1/tables/{name}", get(tables::latest))
        .route("/v1/tables/{name}/versions", get(tables::versions))
        .nest("/v1/tables/{name}/versions/{version}", version);
    surrounded(routes, state)
}

/// Gives routes their fallbacks and layers. The last layer is the outermost.
fn surrounded(routes: Router<AppState>, state: AppState) -> Router {
    routes
        .fallback(async || ApiError::NoSuchRoute)
        .method_not_allowed_fallback(async || ApiError::MethodNotAllowed)
        .layer(DefaultBodyLimit::max(state.limits().body_bytes))
        .layer(from_fn_with_state(state.clone(), limit_time))
        .layer(CatchPanicLayer::custom(answer_panic))
        .layer(from_fn(problem::render))
        .layer(from_fn(headers::add))
        .layer(from_fn(request_id::name_and_log))
        .with_state(state)
}

async fn limit_time(State(state): State<AppState>, request: Request, next: Next) -> Response {
    match tokio::time::timeout(state.limits().request_time, next.run(request)).await {
        Ok(response) => response,
        Err(_) => ApiError::Timeout.into_response(),
    }
}

fn answer_panic(panic: Box<dyn Any + Send>) -> Response {
    let cause = panic.downcast_ref::<&str>().copied();
    let cause = cause.or_else(|| panic.downcast_ref::<String>().map(String::as_str));
    ApiError::internal(cause.unwrap_or("panic of unknown type")).into_response()
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use axum::body::Body;
    use axum::http::StatusCode;
    use http_body_util::BodyExt;
    use ltc_table::Catalogue;
    use tower::ServiceExt;

    use super::*;
    use crate::Limits;

    async fn answer(limits: Limits, path: &str) -> (Response<()>, serde_json::Value) {
        let routes = Router::new()
            .route("/panic", get(async || -> StatusCode { panic!("planted, with a secret") }))
            .route("/panic-off-thread", get(panic_off_thread))
            .route("/sleep", get(sleep))
            .route("/plain", get(async || (StatusCode::IM_A_TEAPOT, "plain text")));
        let app = surrounded(routes, AppState::new(Catalogue::default(), limits));
        let request = Request::get(path).body(Body::empty()).unwrap();
        let (parts, body) = app.oneshot(request).await.unwrap().into_parts();
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
        let limits = Limits { request_time: Duration::from_millis(20), ..Limits::default() };
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
    }
}
