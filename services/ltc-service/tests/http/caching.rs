//! ETag, If-None-Match, If-Match, Cache-Control, HEAD.

use axum::http::{Method, StatusCode};
use ltc_table::digest::digest;

use crate::support::*;

/// Every kind of thing that is fetched.
fn paths() -> Vec<String> {
    let mut paths = vec!["/".to_owned(), "/v1/tables".into(), "/v1/tables/ggx-isotropic".into()];
    paths.push("/benchmarks".into());
    paths.push("/v1/tables/ggx-isotropic/versions".into());
    for rest in [
        "",
        "/data",
        "/data?format=ktx2",
        "/data?alpha=0.1..0.5&format=json",
        "/fresnel",
        "/lookup?theta=0.5&phi=1&alpha_x=0.2&alpha_y=0.2",
    ] {
        paths.push(at(ISO, "2", rest));
    }
    paths
}

#[tokio::test]
async fn the_tag_is_the_digest_of_the_body() {
    let app = service().await;
    for path in paths() {
        let answer = get(&app, &path).await;
        assert_eq!(answer.status, StatusCode::OK, "{path}");
        assert_eq!(answer.header("etag"), format!("\"{}\"", digest(&answer.body)), "{path}");
        assert_eq!(answer.header("vary"), "accept-encoding");
    }
}

#[tokio::test]
async fn tags_of_different_things_differ() {
    let app = service().await;
    let mut tags = Vec::new();
    let forms = [
        "",
        "/data",
        "/data?precision=f32",
        "/data?format=json",
        "/data?channels=m",
        "/data?alpha=0.1..0.2",
        "/data?alpha=0.1..0.9",
        "/data?theta=0.1..0.2",
        "/fresnel",
    ];
    for rest in forms {
        for version in ["1", "2"] {
            tags.push(get(&app, &at(ISO, version, rest)).await.header("etag").to_owned());
        }
    }
    let count = tags.len();
    tags.sort();
    tags.dedup();
    assert_eq!(tags.len(), count);
}

#[tokio::test]
async fn a_known_tag_gives_304() {
    let app = service().await;
    for path in paths() {
        let full = get(&app, &path).await;
        let tag = full.header("etag");
        for known in [
            tag.to_owned(),
            format!("W/{tag}"),
            "*".to_owned(),
            format!("\"other\", {tag}"),
            format!("\"a,b\",W/\"x\" , W/{tag},\"y\""),
        ] {
            for method in [Method::GET, Method::HEAD] {
                let answer = ask_with(&app, method, &path, &[("if-none-match", &known)]).await;
                assert_eq!(answer.status, StatusCode::NOT_MODIFIED, "{path} {known}");
                assert!(answer.body.is_empty());
                for name in ["etag", "cache-control", "vary"] {
                    assert_eq!(answer.header(name), full.header(name), "{name}");
                }
                assert!(!answer.headers.contains_key("content-type"));
                // The router around the service adds a length; on the wire there is none (`socket.rs`).
                let names = answer.headers.keys().filter(|name| *name != "content-length").count();
                assert_eq!(names, 5, "tag, caching, vary, origin and the request's id: {answer:?}");
            }
        }
        for unknown in ["\"other\"", &tag[1..tag.len() - 1], "W/\"other\"", ""] {
            let answer = get_with(&app, &path, &[("if-none-match", unknown)]).await;
            assert_eq!(answer.status, StatusCode::OK, "{path} {unknown}");
            assert_eq!(answer.body, full.body);
        }
        let lines = [("if-none-match", "\"other\""), ("if-none-match", tag)];
        assert_eq!(get_with(&app, &path, &lines).await.status, StatusCode::NOT_MODIFIED);
    }
}

#[tokio::test]
async fn who_asks_only_for_news_is_answered_at_once_the_second_time() {
    let app = service().await;
    let path = at(ISO, "1", "/data");
    let known = format!("\"{}\"", digest_of(ISO, "1"));
    let hits = async || {
        let text = String::from_utf8(get(&app, "/metrics").await.body.to_vec()).unwrap();
        let line = text.lines().find(|line| line.starts_with("ltc_answer_cache_hits_total ")).unwrap();
        line.rsplit_once(' ').unwrap().1.to_owned()
    };
    for times in ["0", "1", "2"] {
        let answer = get_with(&app, &path, &[("if-none-match", &known)]).await;
        assert_eq!(answer.status, StatusCode::NOT_MODIFIED);
        assert_eq!(hits().await, times);
    }
    let whole = get(&app, &path).await;
    assert_eq!((whole.header("etag"), digest(&whole.body)), (&*known, digest_of(ISO, "1")));
    assert_eq!(hits().await, "3", "the whole is there as well");
}

#[tokio::test]
async fn another_versions_tag_is_not_this_ones() {
    let app = service().await;
    let tag = get(&app, &at(ISO, "1", "/data")).await.header("etag").to_owned();
    let answer = get_with(&app, &at(ISO, "latest", "/data"), &[("if-none-match", &tag)]).await;
    assert_eq!(answer.status, StatusCode::OK, "latest has moved on");
    let answer = get_with(&app, &at(ISO, "1", "/data?precision=f32"), &[("if-none-match", &tag)]).await;
    assert_eq!(answer.status, StatusCode::OK, "another variant");
}

#[tokio::test]
async fn if_match_must_name_the_current_tag() {
    let app = service().await;
    let path = at(ISO, "1", "/data");
    let tag = get(&app, &path).await.header("etag").to_owned();
    for (value, status) in [
        (tag.clone(), 200),
        ("*".to_owned(), 200),
        (format!("\"x\", {tag}"), 200),
        ("\"x\"".to_owned(), 412),
        (format!("W/{tag}"), 412),
    ] {
        let answer = get_with(&app, &path, &[("if-match", &value)]).await;
        assert_eq!(answer.status.as_u16(), status, "{value}");
    }
}

#[tokio::test]
async fn what_cannot_change_is_immutable_and_the_rest_is_not() {
    let app = service().await;
    let digest = digest_of(ISO, "10");
    for rest in ["", "/data", "/data?format=ktx2", "/fresnel"] {
        for version in ["10", &digest] {
            let answer = get(&app, &at(ISO, version, rest)).await;
            assert_eq!(answer.header("cache-control"), "public, max-age=31536000, immutable");
        }
        let answer = get(&app, &at(ISO, "latest", rest)).await;
        assert_eq!(answer.header("cache-control"), "public, max-age=60");
    }
    let lookup = at(ISO, &digest, "/lookup?theta=0&alpha_x=0.1&alpha_y=0.1");
    for path in ["/", "/v1/tables", "/v1/tables/ggx-isotropic", "/v1/tables/ggx-isotropic/versions", &lookup]
    {
        assert_eq!(get(&app, path).await.header("cache-control"), "public, max-age=60", "{path}");
    }
    let missing = get(&app, &at(ISO, "10", "/data?format=none")).await;
    assert_eq!(missing.header("cache-control"), "no-store");
}

#[tokio::test]
async fn head_is_get_without_the_body() {
    let app = service().await;
    let mut all = paths();
    all.extend(["/healthz".to_owned(), "/readyz".into(), "/nowhere".into(), at(ISO, "7", "/data")]);
    for path in all {
        let get = get(&app, &path).await;
        let head = ask_with(&app, Method::HEAD, &path, &[]).await;
        assert_eq!(head.status, get.status);
        assert_eq!(head.header("content-length"), get.body.len().to_string(), "{path}");
        let names = |headers: &axum::http::HeaderMap| {
            let mut names: Vec<_> = headers.keys().map(ToString::to_string).collect();
            names.sort();
            names
        };
        assert_eq!(names(&head.headers), names(&get.headers), "{path}");
    }
}
