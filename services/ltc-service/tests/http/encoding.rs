//! Compressed answers are representations of their own.

use std::io::Read;

use axum::http::Method;
use ltc_table::digest::digest;

use crate::support::*;

const GZIP: (&str, &str) = ("accept-encoding", "gzip, deflate, br");

fn unpacked(bytes: &[u8]) -> Vec<u8> {
    let mut out = Vec::new();
    flate2::read::GzDecoder::new(bytes).read_to_end(&mut out).unwrap();
    out
}

fn paths() -> Vec<String> {
    vec![at(ISO, "2", ""), at(ISO, "2", "/data?format=json"), "/openapi.json".to_owned(), "/docs".to_owned()]
}

#[tokio::test]
async fn compressed_bytes_have_a_tag_of_their_own() {
    let app = service().await;
    for path in paths() {
        let plain = get(&app, &path).await;
        // The second time from what was kept.
        for _ in 0..2 {
            let packed = get_with(&app, &path, &[GZIP]).await;
            assert_eq!(packed.header("content-encoding"), "gzip", "{path}");
            assert_eq!(packed.header("vary"), "accept-encoding");
            assert_eq!(unpacked(&packed.body), plain.body, "{path}");
            assert!(packed.body.len() < plain.body.len());
            assert_ne!(packed.header("etag"), plain.header("etag"));
            assert_eq!(packed.header("etag"), format!("\"{}\"", digest(&packed.body)));
            assert_eq!(get(&app, &path).await.body, plain.body, "the plain form stays plain");
            let tag = packed.header("etag");
            let again = get_with(&app, &path, &[GZIP, ("if-none-match", tag)]).await;
            assert_eq!(again.status, 304);
            assert!(!again.headers.contains_key("content-encoding"));
            let other = get_with(&app, &path, &[("if-none-match", tag)]).await;
            assert_eq!(other.status, 200, "the plain form has not that tag");
        }
    }
}

#[tokio::test]
async fn ranges_are_of_the_plain_bytes() {
    let app = service().await;
    for path in paths() {
        let plain = get(&app, &path).await;
        let part = get_with(&app, &path, &[GZIP, ("range", "bytes=10-19")]).await;
        assert_eq!(part.status, 206, "{path}");
        assert!(!part.headers.contains_key("content-encoding"));
        assert_eq!(part.body, plain.body[10..20]);
        assert_eq!(part.header("etag"), plain.header("etag"));
        // A download that began compressed does not go on plain.
        let packed = get_with(&app, &path, &[GZIP]).await;
        let headers = [GZIP, ("range", "bytes=10-19"), ("if-range", packed.header("etag"))];
        let whole = get_with(&app, &path, &headers).await;
        assert_eq!((whole.status.as_u16(), &whole.body), (200, &plain.body));
    }
}

#[tokio::test]
async fn what_is_kept_is_what_was_said_the_first_time() {
    let app = service().await;
    for path in [at(ISO, "2", "/data"), at(ISO, "latest", "/data?format=ktx2"), "/v1/tables".to_owned()] {
        for headers in [&[][..], &[GZIP]] {
            let mut answers = Vec::new();
            for _ in 0..3 {
                answers.push(get_with(&app, &path, headers).await);
            }
            for answer in &answers[1..] {
                assert_eq!(answer.body, answers[0].body);
                for (name, value) in &answers[0].headers {
                    if name != "x-request-id" {
                        assert_eq!(answer.headers.get(name), Some(value), "{path} {name}");
                    }
                }
                assert_eq!(answer.headers.len(), answers[0].headers.len());
            }
            let head = ask_with(&app, Method::HEAD, &path, headers).await;
            assert_eq!(head.header("content-length"), answers[0].body.len().to_string());
        }
    }
}
