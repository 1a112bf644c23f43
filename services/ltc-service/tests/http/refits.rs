//! Refits over HTTP. What fitting itself does is tested where it is done.

use std::time::Duration;

use axum::body::Body;
use axum::http::Request;
use http_body_util::BodyExt;
use ltc_service::settings::Refits;
use ltc_service::{Limits, Settings};
use ltc_store::{Jobs, Outcome, ShardReport};
use serde_json::{Value, json};
use tower::ServiceExt;

use crate::support::*;

const LEASE: Duration = Duration::from_secs(60);

fn preset() -> Value {
    json!({ "preset": "ggx-isotropic" })
}

async fn asked(service: &Service, body: &Value) -> String {
    let answer = service.write("POST", "/v1/refits", &[], body).await;
    assert_eq!(answer.status, 202, "{:?}", answer.body);
    let id = answer.json()["id"].as_str().unwrap().to_owned();
    assert_eq!(answer.header("location"), format!("/v1/refits/{id}"));
    id
}

#[tokio::test]
async fn a_refit_is_asked_for_seen_and_cancelled() {
    let service = Service::new().await;
    let body = json!({ "preset": "ggx-isotropic", "spec": { "name": "mine", "joint": { "steps": 7 } }, "priority": 3, "alias": "studio" });
    let id = asked(&service, &body).await;
    let path = format!("/v1/refits/{id}");
    let refit = get(&service.app, &path).await.json();
    assert_eq!(
        (&refit["state"], &refit["table"], &refit["progress"]),
        (&json!("queued"), &json!("mine"), &json!(0.0))
    );
    assert_eq!((&refit["spec"]["joint"]["steps"], &refit["alias"]), (&json!(7), &json!("studio")));
    assert!(refit["version"].is_null() && refit["error"].is_null());
    let list = get(&service.app, "/v1/refits").await.json();
    assert_eq!(list["refits"][0]["id"], id.as_str());
    assert!(list["refits"][0].get("spec").is_none());
    assert_eq!(service.write("DELETE", &path, &[], &Value::Null).await.status, 200);
    assert_eq!(get(&service.app, &path).await.json()["state"], "cancelled");
    assert_eq!(get(&service.app, "/v1/refits/nothing").await.status, 404);
}

#[tokio::test]
async fn the_same_key_is_the_same_refit() {
    let service = Service::new().await;
    let key = [("idempotency-key", "build-42")];
    let first = service.write("POST", "/v1/refits", &key, &preset()).await.json();
    let again = service.write("POST", "/v1/refits", &key, &preset()).await;
    assert_eq!((again.status.as_u16(), &again.json()["id"]), (202, &first["id"]));
    let other = service.write("POST", "/v1/refits", &key, &json!({ "preset": "ggx-anisotropic" })).await;
    assert_eq!(other.status, 409);
    let elsewhere = token(&service.store, &[ltc_store::Scope::Refit]).await;
    let headers = [JSON, key[0], ("authorization", &*elsewhere)];
    let theirs = send(&service.app, "POST", "/v1/refits", &headers, preset().to_string()).await;
    assert_ne!(theirs.json()["id"], first["id"], "keys are each token's own");
    for bad in ["", "a b", &"x".repeat(129)] {
        let answer = service.write("POST", "/v1/refits", &[("idempotency-key", bad)], &preset()).await;
        assert_eq!(answer.status, 400, "{bad:?}");
    }
}

#[tokio::test]
async fn what_cannot_be_fitted_is_refused() {
    let service = Service::with(Settings {
        limits: Limits { writes_per_second: 0, ..Limits::default() },
        ..Settings::default()
    })
    .await;
    for body in [
        json!({}),
        json!({ "preset": "none" }),
        json!({ "spec": 3 }),
        json!({ "spec": {} }),
        json!({ "preset": "ggx-isotropic", "spec": { "preset": "ggx-isotropic" } }),
        json!({ "preset": "ggx-isotropic", "spec": { "joint": { "steps": null } } }),
        json!({ "preset": "ggx-isotropic", "spec": { "name": "../../x" } }),
        json!({ "preset": "ggx-isotropic", "priority": 101 }),
        json!({ "preset": "ggx-isotropic", "alias": "7" }),
        json!({ "preset": "ggx-isotropic", "more": 1 }),
        json!([]),
    ] {
        let answer = service.write("POST", "/v1/refits", &[], &body).await;
        assert_eq!(answer.status, 422, "{body} {:?}", answer.body);
    }
    let axis = |quantity: &str| json!({ "quantity": quantity, "mapping": "linear", "len": 3000 });
    let large = json!({ "preset": "ggx-isotropic", "spec": { "axes": [axis("theta"), axis("alpha")] } });
    let refused = service.write("POST", "/v1/refits", &[], &large).await.json();
    assert_eq!(refused["type"], "urn:ltc:problem:too-costly");
    assert_eq!(refused["estimate"]["entries"], 9_000_000);
    assert!(get(&service.app, "/v1/refits").await.json()["refits"].as_array().unwrap().is_empty());
}

#[tokio::test]
async fn a_full_queue_says_so() {
    let refits = Refits { queue: 1, ..Refits::default() };
    let service = Service::with(Settings { refits, ..Settings::default() }).await;
    asked(&service, &preset()).await;
    let full = service.write("POST", "/v1/refits", &[], &preset()).await;
    assert_eq!((full.status.as_u16(), &full.json()["type"]), (429, &json!("urn:ltc:problem:queue-full")));
    assert_eq!(full.header("retry-after"), "60");
}

/// Events as `(id, name, data)`, read until the stream ends.
async fn events(service: &Service, id: &str, after: Option<&str>) -> Vec<(u64, String, Value)> {
    let mut request = Request::get(format!("/v1/refits/{id}/events"));
    if let Some(after) = after {
        request = request.header("last-event-id", after);
    }
    let answer = service.app.clone().oneshot(request.body(Body::empty()).unwrap()).await.unwrap();
    assert_eq!(answer.status(), 200);
    assert_eq!(answer.headers()["content-type"], "text/event-stream");
    let body = tokio::time::timeout(Duration::from_secs(10), answer.into_body().collect()).await;
    let text = String::from_utf8(body.expect("the stream ends").unwrap().to_bytes().to_vec()).unwrap();
    let field = |block: &str, name: &str| {
        let line = block.lines().find_map(|line| line.strip_prefix(name).map(str::trim));
        line.unwrap_or_else(|| panic!("no {name} in {block}")).to_owned()
    };
    let blocks = text.split("\n\n").filter(|block| block.contains("data:"));
    blocks
        .map(|block| {
            let data = serde_json::from_str(&field(block, "data:")).unwrap();
            (field(block, "id:").parse().unwrap(), field(block, "event:"), data)
        })
        .collect()
}

#[tokio::test]
async fn events_come_as_they_happen_and_go_on_after_a_break() {
    let service = Service::new().await;
    let id = asked(&service, &preset()).await;
    let follow = events(&service, &id, None);
    let work = async {
        tokio::time::sleep(Duration::from_millis(50)).await;
        let claim = service.store.claim("w", LEASE).await.unwrap().unwrap();
        let shard = ShardReport { progress: 0.5, log: Some("half".to_owned()), ..ShardReport::default() };
        service.store.report(&claim, LEASE, shard).await.unwrap();
        tokio::time::sleep(Duration::from_millis(50)).await;
        let outcome = Outcome::Succeeded { version: 11, note: "done".to_owned() };
        service.store.finish(&claim, outcome).await.unwrap();
    };
    let (seen, ()) = tokio::join!(follow, work);
    let names: Vec<&str> = seen.iter().map(|(_, name, _)| name.as_str()).collect();
    for name in ["state", "progress", "log"] {
        assert!(names.contains(&name), "{names:?}");
    }
    assert!(seen.windows(2).all(|pair| pair[0].0 < pair[1].0), "ids grow");
    assert!(seen.iter().any(|(_, name, data)| name == "state" && data["data"]["state"] == "succeeded"));
    // What was seen does not come again.
    let after = seen[1].0.to_string();
    assert_eq!(events(&service, &id, Some(&after)).await, seen[2..]);
    let last = seen.last().unwrap().0.to_string();
    assert!(events(&service, &id, Some(&last)).await.is_empty());
    for bad in ["x", "-1", "99999999999999999999999"] {
        let answer =
            get_with(&service.app, &format!("/v1/refits/{id}/events"), &[("last-event-id", bad)]).await;
        assert_eq!(answer.status, 400, "{bad}");
    }
    assert_eq!(get(&service.app, "/v1/refits/none/events").await.status, 404);
}

#[tokio::test]
async fn streams_are_limited_and_given_back() {
    let limits = Limits { event_streams: 1, ..Limits::default() };
    let service = Service::with(Settings { limits, ..Settings::default() }).await;
    let id = asked(&service, &preset()).await;
    let path = format!("/v1/refits/{id}/events");
    let request = Request::get(&path).body(Body::empty()).unwrap();
    let first = service.app.clone().oneshot(request).await.unwrap();
    assert_eq!(first.status(), 200);
    assert_eq!(get(&service.app, &path).await.status, 503);
    drop(first);
    service.store.cancel(&id).await.unwrap();
    assert_eq!(get(&service.app, &path).await.status, 200);
}
