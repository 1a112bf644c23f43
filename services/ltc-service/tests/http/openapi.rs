//! The description against what is served.

use std::collections::BTreeSet;

use axum::http::Method;

use crate::support::*;

fn filled(path: &str) -> String {
    path.replace("{name}", ISO)
        .replace("{version}", "1")
        .replace("{other}", "2")
        .replace("{alias}", "stable")
        .replace("{lang}", "wgsl")
        .replace("{slug}", "malformed")
        .replace("{id}", "00000000000000000000000000000000")
}

#[tokio::test]
async fn every_path_has_the_methods_that_are_described() {
    let app = service().await;
    let document = get(&app, "/openapi.json").await;
    assert_eq!(document.header("content-type"), "application/json");
    let document = document.json();
    assert_eq!(document["openapi"], "3.1.0");
    for (path, item) in document["paths"].as_object().unwrap() {
        let mut described: BTreeSet<String> =
            item.as_object().unwrap().keys().map(|m| m.to_uppercase()).collect();
        if described.contains("GET") {
            described.insert("HEAD".to_owned());
        }
        let answer = ask_with(&app, Method::PATCH, &filled(path), &[]).await;
        assert_eq!(answer.status, 405, "{path}");
        let allowed: BTreeSet<String> =
            answer.header("allow").split(',').map(|m| m.trim().to_owned()).collect();
        assert_eq!(allowed, described, "{path}");
    }
}

#[tokio::test]
async fn what_is_answered_is_described() {
    let app = service().await;
    let document = get(&app, "/openapi.json").await.json();
    for (path, item) in document["paths"].as_object().unwrap() {
        for (method, operation) in item.as_object().unwrap() {
            let method = Method::from_bytes(method.to_uppercase().as_bytes()).unwrap();
            for path in [filled(path), filled(path) + "?nothing=1"] {
                let answer = ask_with(&app, method.clone(), &path, &[]).await;
                let status = answer.status.as_str();
                let response = &operation["responses"][status];
                assert!(response.is_object(), "{method} {path} {status} is not described");
                let media_type = answer.header("content-type").split(';').next().unwrap();
                assert!(response["content"][media_type].is_object(), "{method} {path} {status} {media_type}");
            }
        }
    }
}

#[tokio::test]
async fn the_page_loads_nothing_and_names_every_operation() {
    let app = service().await;
    let document = get(&app, "/openapi.json").await.json();
    let page = get(&app, "/docs").await;
    let text = String::from_utf8(page.body.to_vec()).unwrap();
    for (path, item) in document["paths"].as_object().unwrap() {
        assert!(text.contains(path), "{path}");
        for operation in item.as_object().unwrap().values() {
            assert!(text.contains(operation["summary"].as_str().unwrap()));
        }
    }
    assert!(page.header("content-security-policy").starts_with("default-src 'none'"));
    for needle in ["<script", "src=", "http://", "https://", "{{"] {
        assert!(!text.contains(needle), "{needle}");
    }
}
