//! Paths, methods, headers and bodies that are wrong; CORS; request ids.

use std::convert::Infallible;
use std::pin::Pin;
use std::task::{Context, Poll};

use axum::body::{Body, Bytes, HttpBody};
use axum::http::{Method, Request, StatusCode};
use hyper::body::Frame;
use ltc_service::{Limits, Settings};

use crate::support::*;

#[tokio::test]
async fn unknown_routes_are_problems() {
    let app = service().await;
    for path in [
        "/v1",
        "/v1/",
        "/v2/tables",
        "/v1/tables/",
        "/v1/tables/ggx-isotropic/",
        "/favicon.ico",
        "//",
        "/v1/tables/ggx-isotropic/versions/",
        "/v1/tables/ggx-isotropic/versions/1/",
        "/v1/tables/ggx-isotropic/versions/1/data/",
        "/v1/tables/ggx-isotropic/versions/1/nothing",
        "/v1/tables/../tables",
        "/metrics/",
        "/v1/refits/",
    ] {
        for method in [Method::GET, Method::HEAD, Method::POST, Method::DELETE] {
            let answer = ask_with(&app, method, path, &[]).await;
            assert_eq!(answer.status, StatusCode::NOT_FOUND, "{path}");
        }
        assert_eq!(get(&app, path).await.json()["type"], "urn:ltc:problem:no-such-route", "{path}");
    }
}

#[tokio::test]
async fn names_that_try_to_lead_elsewhere_are_names_that_do_not_exist() {
    let app = service().await;
    for name in [
        "..",
        "%2e%2e",
        "..%2f..%2fetc%2fpasswd",
        "%2Fetc%2Fpasswd",
        "ggx-isotropic%2Fversions",
        "%00",
        "ggx-isotropic%00",
        "GGX-ISOTROPIC",
        "ggx-isotropic%20",
        "%0d%0aset-cookie:%20a=b",
        "%22%3e%3cb%3e",
        "%E2%80%AE",
        "*",
        "ggx-isotropic@1",
        "%25%32%65",
    ] {
        for rest in ["", "/versions", "/versions/1", "/versions/1/data"] {
            let answer = get(&app, &format!("/v1/tables/{name}{rest}")).await;
            assert_eq!(answer.status, StatusCode::NOT_FOUND, "{name}{rest}");
            assert!(!answer.headers.contains_key("set-cookie"));
        }
        assert_eq!(get(&app, &at(ISO, name, "")).await.status, StatusCode::NOT_FOUND, "{name}");
    }
    for name in ["%ff", "%c3%28"] {
        let answer = get(&app, &format!("/v1/tables/{name}")).await;
        assert_eq!(answer.status, StatusCode::BAD_REQUEST, "{name} is not UTF-8");
        assert_eq!(get(&app, &at(ISO, name, "/data")).await.status, StatusCode::BAD_REQUEST);
    }
    let long = "a".repeat(20_000);
    assert_eq!(get(&app, &format!("/v1/tables/{long}")).await.status, StatusCode::NOT_FOUND);
    // The same escapes spell a name that exists.
    assert_eq!(get(&app, "/v1/tables/%67gx-isotropic").await.status, StatusCode::OK);
}

#[tokio::test]
async fn wrong_methods_are_told_the_right_ones() {
    let app = service().await;
    let data = at(ISO, "1", "/data");
    let lookup = at(ISO, "1", "/lookup");
    for path in [
        "/",
        "/healthz",
        "/readyz",
        "/v1/tables",
        "/v1/tables/ggx-isotropic",
        "/v1/tables/ggx-isotropic/versions",
        &at(ISO, "1", ""),
        &data,
        &at(ISO, "1", "/fresnel"),
        &lookup,
        "/v1/refits",
        "/v1/benchmarks",
        "/metrics",
        "/openapi.json",
    ] {
        let posts =
            ["/v1/refits", "/v1/benchmarks", "/v1/tables/ggx-isotropic/versions", &lookup].contains(&path);
        for method in ["PUT", "DELETE", "PATCH", "OPTIONS", "TRACE", "BREW", "POST"] {
            if posts && method == "POST" {
                continue;
            }
            let answer = ask_with(&app, Method::from_bytes(method.as_bytes()).unwrap(), path, &[]).await;
            assert_eq!(answer.status, StatusCode::METHOD_NOT_ALLOWED, "{method} {path}");
            let allowed = if posts { "GET,HEAD,POST" } else { "GET,HEAD" };
            assert_eq!(answer.header("allow"), allowed);
            assert_eq!(answer.json()["type"], "urn:ltc:problem:method-not-allowed");
        }
    }
}

#[tokio::test]
async fn browsers_may_read_from_anywhere() {
    let app = service().await;
    let headers = [
        ("origin", "https://example.org"),
        ("access-control-request-method", "GET"),
        ("access-control-request-headers", "if-none-match, range"),
    ];
    for path in [&at(ISO, "1", "/data"), "/v1/tables"] {
        let answer = ask_with(&app, Method::OPTIONS, path, &headers).await;
        assert_eq!(answer.status, StatusCode::NO_CONTENT);
        assert_eq!(answer.header("access-control-allow-methods"), "GET, HEAD, POST");
        for name in ["if-none-match", "if-range", "range", "content-type"] {
            assert!(answer.header("access-control-allow-headers").contains(name));
        }
    }
    let read = get_with(&app, &at(ISO, "1", "/data"), &[("origin", "https://example.org")]).await;
    for name in ["etag", "content-range", "x-request-id", "x-table-digest"] {
        assert!(read.header("access-control-expose-headers").contains(name), "{name}");
    }
    assert!(!read.headers.contains_key("access-control-allow-credentials"));
}

#[tokio::test]
async fn a_request_keeps_its_id_or_gets_one() {
    let app = service().await;
    for path in ["/v1/tables", "/nowhere"] {
        let named = get_with(&app, path, &[("x-request-id", "build-42")]).await;
        assert_eq!(named.header("x-request-id"), "build-42");
        let refused = get_with(&app, path, &[("x-request-id", "a b\"c")]).await;
        assert_ne!(refused.header("x-request-id"), "a b\"c");
        let (one, two) = (get(&app, path).await, get(&app, path).await);
        assert_ne!(one.header("x-request-id"), two.header("x-request-id"));
    }
}

/// A body that sends its first bytes and then nothing more.
struct Stalled(Option<Bytes>);

impl HttpBody for Stalled {
    type Data = Bytes;
    type Error = Infallible;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        _: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, Infallible>>> {
        self.0.take().map_or(Poll::Pending, |bytes| Poll::Ready(Some(Ok(Frame::data(bytes)))))
    }
}

#[tokio::test]
async fn a_body_that_does_not_come_is_not_waited_for() {
    let path = at(ISO, "1", "/lookup");
    for (limits, status, slug) in [
        (Limits { body_seconds: 0.03, ..Limits::default() }, 408, "body-timeout"),
        (Limits { request_seconds: 0.03, ..Limits::default() }, 503, "timeout"),
    ] {
        let stalled = Body::new(Stalled(Some(Bytes::from_static(b"["))));
        let answer = post(&service_with(limits).await, &path, stalled).await;
        assert_eq!(answer.status.as_u16(), status);
        assert_eq!(answer.json()["type"], format!("urn:ltc:problem:{slug}"));
    }
}

/// A body whose connection is lost.
struct Lost;

impl HttpBody for Lost {
    type Data = Bytes;
    type Error = std::io::Error;

    fn poll_frame(
        self: Pin<&mut Self>,
        _: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, std::io::Error>>> {
        Poll::Ready(Some(Err(std::io::ErrorKind::ConnectionReset.into())))
    }
}

#[tokio::test]
async fn a_body_that_breaks_off_is_malformed() {
    let answer = post(&service().await, &at(ISO, "1", "/lookup"), Body::new(Lost)).await;
    assert_eq!(answer.status, StatusCode::BAD_REQUEST);
}

#[tokio::test]
async fn thousands_of_malformed_requests_give_no_5xx() {
    let app = service().await;
    let pieces = [
        "?",
        "&",
        "=",
        "%",
        "%2",
        "%zz",
        "theta",
        "alpha",
        "=NaN",
        "=1e400",
        "..",
        "/",
        "//",
        "data",
        "lookup",
        "format=npz",
        "versions",
        "1",
        "latest",
        "sha256:",
        "ggx-isotropic",
        "v1",
        "tables",
        "%F0%9F",
        "-0",
        ";",
    ];
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    let mut next = |n: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % n
    };
    let mut seen = std::collections::BTreeMap::<u16, u32>::new();
    for i in 0..6000 {
        let mut path = if i % 2 == 0 { at(ISO, "1", "/lookup?") } else { "/v1/tables/".to_owned() };
        for _ in 0..1 + next(6) {
            path += pieces[next(pieces.len())];
        }
        let Ok(request) = Request::get(&path).body(Body::empty()) else { continue };
        let answer = ask(&app, request).await;
        assert!(answer.status.as_u16() < 500, "{path}: {}", answer.status);
        *seen.entry(answer.status.as_u16()).or_default() += 1;
    }
    for status in [400, 404, 422] {
        assert!(seen.get(&status).is_some_and(|n| *n > 50), "the requests are of many kinds: {seen:?}");
    }
}

#[tokio::test]
async fn thousands_of_malformed_writes_give_no_5xx_and_change_nothing() {
    let limits = Limits { writes_per_second: 0, ..Limits::default() };
    let service = Service::with(Settings { limits, ..Settings::default() }).await;
    let routes = [
        ("PUT", "/v1/tables/ggx-isotropic/aliases/stable"),
        ("POST", "/v1/tables/ggx-isotropic/versions"),
        ("POST", "/v1/refits"),
        ("DELETE", "/v1/refits/x"),
        ("POST", "/v1/benchmarks"),
    ];
    let types = [
        "application/json",
        "text/plain",
        "multipart/form-data; boundary=b",
        "multipart/form-data",
        "",
        "a/b;c",
    ];
    let pieces = [
        "{",
        "}",
        "[",
        "]",
        "\"",
        ":",
        ",",
        "null",
        "1e999",
        "-1",
        "\"version\"",
        "\"preset\"",
        "\"spec\"",
        "\"name\"",
        "\"run\"",
        "\"ggx-isotropic\"",
        "\u{0}",
        "--b\r\n",
        "--b--",
        "content-disposition: form-data; name=\"manifest\"\r\n\r\n",
        "\\ud800",
        "é",
    ];
    let before = get(&service.app, "/v1/tables/ggx-isotropic").await.body;
    let mut state = 41_u64;
    let mut next = |n: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % n
    };
    let mut seen = std::collections::BTreeMap::<u16, u32>::new();
    for i in 0..4000 {
        let (method, path) = routes[next(routes.len())];
        let body: String = (0..next(12)).map(|_| pieces[next(pieces.len())]).collect();
        let bad = "Bearer ltc_0123456789ab_x";
        let authorization = if i % 4 == 0 { bad } else { &service.token };
        let headers = [
            ("content-type", types[next(types.len())]),
            ("authorization", authorization),
            ("if-match", "\"x\""),
        ];
        let answer = send(&service.app, method, path, &headers, body.clone()).await;
        let status = answer.status.as_u16();
        assert!((400..500).contains(&status), "{method} {path} {body:?}: {status}");
        *seen.entry(status).or_default() += 1;
    }
    for status in [400, 401, 404, 415] {
        assert!(seen.get(&status).is_some_and(|n| *n > 50), "the requests are of many kinds: {seen:?}");
    }
    assert_eq!(get(&service.app, "/v1/tables/ggx-isotropic").await.body, before);
    assert_eq!(get(&service.app, "/v1/refits").await.body, "{\"refits\":[]}");
    assert_eq!(get(&service.app, "/v1/benchmarks").await.body, "{\"benchmarks\":[]}");
}
