//! Range, If-Range, 206, 416.

use axum::http::{Method, StatusCode};

use crate::support::*;

#[tokio::test]
async fn one_range_gives_its_bytes() {
    let app = service().await;
    for rest in ["/data", "/data?format=ktx2", "/fresnel?precision=f32"] {
        let path = at(ISO, "1", rest);
        let full = get(&app, &path).await;
        assert_eq!(full.header("accept-ranges"), "bytes");
        let n = full.body.len();
        for (range, first, last) in [
            ("bytes=0-0", 0, 0),
            ("bytes=0-99", 0, 99),
            ("bytes=100-", 100, n - 1),
            ("bytes=-7", n - 7, n - 1),
            ("bytes=-99999999", 0, n - 1),
            ("bytes=5-99999999999999999999999", 5, n - 1),
            (&format!("bytes={}-", n - 1), n - 1, n - 1),
        ] {
            let answer = get_with(&app, &path, &[("range", range)]).await;
            assert_eq!(answer.status, StatusCode::PARTIAL_CONTENT, "{range}");
            assert_eq!(answer.body, full.body.slice(first..=last), "{range}");
            assert_eq!(answer.header("content-range"), format!("bytes {first}-{last}/{n}"));
            assert_eq!(answer.header("content-length"), (last - first + 1).to_string());
            for name in ["etag", "cache-control", "vary", "content-type", "content-disposition"] {
                assert_eq!(answer.header(name), full.header(name), "{name}");
            }
        }
    }
}

#[tokio::test]
async fn parts_put_together_are_the_whole() {
    let app = service().await;
    let path = at(ANISO, "1", "/data");
    let full = get(&app, &path).await.body;
    let mut together = Vec::new();
    while together.len() < full.len() {
        let range = format!("bytes={}-{}", together.len(), together.len() + 999);
        together.extend(get_with(&app, &path, &[("range", &range)]).await.body);
    }
    assert_eq!(together, full);
}

#[tokio::test]
async fn ranges_outside_are_416_with_the_length() {
    let app = service().await;
    let path = at(ISO, "1", "/data");
    let n = get(&app, &path).await.body.len();
    for range in
        [&format!("bytes={n}-"), "bytes=99999999-99999999", "bytes=-0", "bytes=99999999999999999999-"]
    {
        let answer = get_with(&app, &path, &[("range", range)]).await;
        assert_eq!(answer.status, StatusCode::RANGE_NOT_SATISFIABLE, "{range}");
        assert_eq!(answer.header("content-range"), format!("bytes */{n}"));
        assert_eq!(answer.json()["type"], "urn:ltc:problem:range-not-satisfiable");
    }
}

#[tokio::test]
async fn what_is_not_one_byte_range_gives_the_whole() {
    let app = service().await;
    let path = at(ISO, "1", "/data");
    let full = get(&app, &path).await;
    for range in ["bytes=0-1,4-5", "bytes=5-2", "bytes=x-y", "bytes=", "items=0-5", "0-5", "bytes 0-5"] {
        let answer = get_with(&app, &path, &[("range", range)]).await;
        assert_eq!(answer.status, StatusCode::OK, "{range}");
        assert_eq!(answer.body, full.body);
        assert!(!answer.headers.contains_key("content-range"));
    }
    let twice = [("range", "bytes=0-1"), ("range", "bytes=4-5")];
    assert_eq!(get_with(&app, &path, &twice).await.status, StatusCode::OK);
    let head = ask_with(&app, Method::HEAD, &path, &[("range", "bytes=0-1")]).await;
    assert_eq!(head.status, StatusCode::OK, "ranges are for GET");
    assert_eq!(head.header("content-length"), full.body.len().to_string());
}

#[tokio::test]
async fn if_range_serves_a_part_only_of_what_the_client_has() {
    let app = service().await;
    let path = at(ISO, "latest", "/data");
    let full = get(&app, &path).await;
    let tag = full.header("etag");
    let older = get(&app, &at(ISO, "1", "/data")).await.header("etag").to_owned();
    for (if_range, status) in [
        (tag, 206),
        (&format!("W/{tag}"), 200),
        (&older, 200),
        ("Wed, 21 Oct 2015 07:28:00 GMT", 200),
        ("", 200),
    ] {
        let headers = [("range", "bytes=10-19"), ("if-range", if_range)];
        let answer = get_with(&app, &path, &headers).await;
        assert_eq!(answer.status.as_u16(), status, "{if_range}");
        let expected = if status == 206 { full.body.slice(10..20) } else { full.body.clone() };
        assert_eq!(answer.body, expected);
    }
    // An unsatisfiable range of something else is no error: the client gets the new whole.
    let headers = [("range", "bytes=99999999-"), ("if-range", &older)];
    assert_eq!(get_with(&app, &path, &headers).await.status, StatusCode::OK);
    let alone = [("if-range", tag)];
    assert_eq!(get_with(&app, &path, &alone).await.status, StatusCode::OK);
}

#[tokio::test]
async fn preconditions_come_before_ranges() {
    let app = service().await;
    let path = at(ISO, "1", "/data");
    let tag = get(&app, &path).await.header("etag").to_owned();
    for range in ["bytes=0-9", "bytes=99999999-"] {
        let headers = [("range", range), ("if-none-match", &*tag)];
        assert_eq!(get_with(&app, &path, &headers).await.status, StatusCode::NOT_MODIFIED);
        let headers = [("range", range), ("if-match", "\"x\"")];
        assert_eq!(get_with(&app, &path, &headers).await.status, StatusCode::PRECONDITION_FAILED);
    }
    let headers = [("range", "bytes=0-9"), ("if-none-match", "\"x\"")];
    assert_eq!(get_with(&app, &path, &headers).await.status, StatusCode::PARTIAL_CONTENT);
}
