//! Who may do what.

use ltc_service::settings::Access;
use ltc_service::{Limits, Settings};
use ltc_store::{Metadata, Scope};
use serde_json::json;

use crate::support::*;

/// Every route that changes something, the scope that it needs, and a body that would change something.
const WRITES: [(&str, &str, Scope, &str); 5] = [
    ("PUT", "/v1/tables/ggx-isotropic/aliases/stable", Scope::Publish, "{\"version\": 1}"),
    ("POST", "/v1/tables/ggx-isotropic/versions", Scope::Publish, ""),
    ("POST", "/v1/refits", Scope::Refit, "{\"preset\": \"ggx-isotropic\"}"),
    ("DELETE", "/v1/refits/00000000000000000000000000000000", Scope::Refit, ""),
    ("POST", "/v1/benchmarks", Scope::Benchmark, "{\"name\": \"a\", \"run\": {}}"),
];

fn unlimited() -> Settings {
    Settings { limits: Limits { writes_per_second: 0, ..Limits::default() }, ..Settings::default() }
}

#[tokio::test]
async fn nothing_is_written_without_the_right_token() {
    let service = Service::with(unlimited()).await;
    let (_, unknown) =
        ltc_store::Secret::generate("unknown", Scope::ALL.into_iter().collect(), None).unwrap();
    let unknown = format!("Bearer {}", unknown.reveal());
    let before = get(&service.app, "/v1/tables/ggx-isotropic/aliases").await.body;
    for (method, path, scope, body) in WRITES {
        let try_with = async |authorization: Option<&str>| {
            let mut headers = vec![JSON, ("if-match", "*")];
            headers.extend(authorization.map(|value| ("authorization", value)));
            send(&service.app, method, path, &headers, body).await
        };
        let none = try_with(None).await;
        assert_eq!(
            (none.status.as_u16(), none.header("www-authenticate")),
            (401, "Bearer realm=\"ltc\""),
            "{path}"
        );
        for bad in [unknown.as_str(), "Bearer", "Bearer x", "Basic YTpi", "ltc_x", ""] {
            let answer = try_with(Some(bad)).await;
            assert_eq!(answer.status, 401, "{path} {bad}");
            assert_eq!(answer.json()["type"], "urn:ltc:problem:unauthenticated");
        }
        let others: Vec<Scope> = Scope::ALL.into_iter().filter(|s| *s != scope).collect();
        let answer = try_with(Some(&token(&service.store, &others).await)).await;
        assert_eq!(answer.status, 403, "{path}");
        let challenge = format!("scope=\"{}\"", scope.name());
        assert!(answer.header("www-authenticate").contains(&challenge), "{path}");
        if path.contains("/aliases/") {
            assert_eq!(get(&service.app, "/v1/tables/ggx-isotropic/aliases").await.body, before);
        }
        // The control: with the scope the request gets further.
        let right = try_with(Some(&token(&service.store, &[scope]).await)).await.status.as_u16();
        assert!(![401, 403].contains(&right), "{path} {right}");
    }
    assert_ne!(
        get(&service.app, "/v1/tables/ggx-isotropic/aliases").await.body,
        before,
        "the control moved it"
    );
}

#[tokio::test]
async fn every_other_method_of_every_route_changes_nothing() {
    let service = Service::with(unlimited()).await;
    let document = get(&service.app, "/openapi.json").await.json();
    let mut writes = Vec::new();
    for (path, item) in document["paths"].as_object().unwrap() {
        for (method, operation) in item.as_object().unwrap() {
            let lookup = path.ends_with("/lookup");
            if method != "get" && !lookup {
                writes.push((method.to_uppercase(), path.clone()));
                assert_eq!(operation["security"], json!([{ "token": [] }]), "{method} {path}");
            }
        }
    }
    assert_eq!(writes.len(), WRITES.len(), "a route that writes is missing in the table above: {writes:?}");
}

#[tokio::test]
async fn reading_can_be_bound_to_tokens() {
    let service = Service::with(Settings { read: Access::Token, ..unlimited() }).await;
    let reader = token(&service.store, &[Scope::Read]).await;
    let refitter = token(&service.store, &[Scope::Refit]).await;
    let data = at(ISO, "1", "/data");
    for path in ["/", "/v1/tables", &data, "/v1/refits", "/v1/benchmarks", "/v1/none"] {
        assert_eq!(get(&service.app, path).await.status, 401, "{path}");
        assert_eq!(get_with(&service.app, path, &[("authorization", &refitter)]).await.status, 403, "{path}");
    }
    for _ in 0..2 {
        let answer = get_with(&service.app, &data, &[("authorization", &reader)]).await;
        assert_eq!(answer.status, 200);
        assert_eq!(answer.header("cache-control"), "private, max-age=31536000, immutable");
        assert_eq!(get(&service.app, &data).await.status, 401, "an answer that is kept is not for everybody");
    }
    for path in ["/healthz", "/readyz", "/metrics", "/openapi.json", "/docs", "/problems"] {
        assert_eq!(get(&service.app, path).await.status, 200, "{path}");
    }
    // What writes asks for its own scope and for no other; a lookup that is posted reads.
    let with = async |path: &str, token: &str, body: &'static str| {
        send(&service.app, "POST", path, &[JSON, ("authorization", token)], body).await.status.as_u16()
    };
    let poster = token(&service.store, &[Scope::Benchmark]).await;
    let run = "{\"name\": \"a\", \"run\": {}}";
    assert_eq!(with("/v1/benchmarks", &poster, run).await, 201);
    assert_eq!(with("/v1/benchmarks", &reader, run).await, 403);
    assert_eq!(with("/v1/refits", &poster, "{}").await, 403);
    assert_eq!(with(&at(ISO, "1", "/lookup"), &poster, "[]").await, 403);
    assert_eq!(with(&at(ISO, "1", "/lookup"), &reader, "[]").await, 200);
    let ids: Vec<String> = service.store.tokens().await.unwrap().into_iter().map(|t| t.id).collect();
    for id in ids {
        service.store.revoke_token(&id).await.unwrap();
    }
    tokio::time::sleep(std::time::Duration::from_millis(1100)).await;
    assert_eq!(get_with(&service.app, &data, &[("authorization", &reader)]).await.status, 401, "revoked");
}
