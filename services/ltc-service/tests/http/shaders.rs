//! Shaders, from a source of the tests' own.

use std::sync::Arc;

use axum::http::{Method, StatusCode};
use ltc_service::{Settings, ShaderFile, ShaderRefusal, ShaderSource, app};

use crate::support::*;

/// Writes down what it was asked.
struct Echo;

impl ShaderSource for Echo {
    fn languages(&self) -> Vec<&'static str> {
        vec!["wgsl", "spirv"]
    }

    fn shader(
        &self,
        language: &str,
        lights: &str,
        features: Option<&str>,
    ) -> Result<ShaderFile, ShaderRefusal> {
        if lights == "candle" {
            return Err(ShaderRefusal { field: "lights", reason: "has no candle".to_owned() });
        }
        let text = format!("{language} {lights} {features:?}\n");
        Ok(ShaderFile { bytes: text.into_bytes(), extension: "wgsl", is_text: language == "wgsl" })
    }
}

async fn echoing() -> axum::Router {
    let (state, _store) = state_over(&catalogue(), Settings::default()).await;
    state.serve_shaders(Arc::new(Echo));
    app(state)
}

#[tokio::test]
async fn what_is_asked_for_comes_with_a_tag_and_in_parts() {
    let app = echoing().await;
    let path = "/v1/shaders/wgsl?lights=quad,line&features=fresnel";
    let whole = get(&app, path).await;
    assert_eq!((whole.status, whole.header("content-type")), (StatusCode::OK, "text/plain; charset=utf-8"));
    assert_eq!(&whole.body[..], b"wgsl quad,line Some(\"fresnel\")\n");
    assert!(whole.header("content-disposition").contains("ltc-wgsl.wgsl"));
    let tag = whole.header("etag").to_owned();
    let again = ask_with(&app, Method::GET, path, &[("if-none-match", &tag)]).await;
    assert_eq!(again.status, StatusCode::NOT_MODIFIED);
    let part = ask_with(&app, Method::GET, path, &[("range", "bytes=0-3")]).await;
    assert_eq!((part.status, &part.body[..]), (StatusCode::PARTIAL_CONTENT, &b"wgsl"[..]));
    let usual = get(&app, "/v1/shaders/spirv?lights=quad").await;
    assert_eq!(usual.header("content-type"), "application/octet-stream");
    assert_eq!(&usual.body[..], b"spirv quad None\n");
}

#[tokio::test]
async fn what_is_not_known_is_refused() {
    let app = echoing().await;
    for (path, status, word) in [
        ("/v1/shaders/cobol?lights=quad", StatusCode::NOT_FOUND, "cobol"),
        ("/v1/shaders/wgsl?lights=candle", StatusCode::UNPROCESSABLE_ENTITY, "candle"),
        ("/v1/shaders/wgsl?lights=quad&colour=red", StatusCode::UNPROCESSABLE_ENTITY, "colour"),
    ] {
        let answer = get(&app, path).await;
        assert_eq!(answer.status, status, "{path}");
        assert_eq!(answer.header("content-type"), "application/problem+json");
        assert!(answer.json().to_string().contains(word), "{path}");
    }
    // A service that nobody gave a source has no language.
    let without = service().await;
    assert_eq!(get(&without, "/v1/shaders/wgsl?lights=quad").await.status, StatusCode::NOT_FOUND);
}
