//! Tables made elsewhere.

use ltc_store::{BlobKind, Blobs, Metadata};
use serde_json::{Value, json};

use crate::support::*;

const BOUNDARY: &str = "x-x-boundary-x-x";
const NAME: &str = "disney-diffuse";

fn form(parts: &[(&str, &[u8])]) -> Vec<u8> {
    let mut body = Vec::new();
    for (name, content) in parts {
        let head = format!(
            "--{BOUNDARY}\r\ncontent-disposition: form-data; name=\"{name}\"; filename=\"f\"\r\n\r\n"
        );
        body.extend(head.bytes());
        body.extend(*content);
        body.extend(b"\r\n");
    }
    body.extend(format!("--{BOUNDARY}--\r\n").bytes());
    body
}

async fn upload(service: &Service, table: &str, parts: &[(&str, &[u8])]) -> Answer {
    let media_type = format!("multipart/form-data; boundary={BOUNDARY}");
    let headers = [("content-type", media_type.as_str()), ("authorization", &service.token)];
    send(&service.app, "POST", &format!("/v1/tables/{table}/versions"), &headers, form(parts)).await
}

/// Manifest and payload of a table that is not in the service yet.
fn shipped() -> (Value, Vec<u8>) {
    let catalogue = ltc_tables::shipped().unwrap();
    let version = catalogue.version(NAME, "latest").unwrap();
    (serde_json::to_value(version.manifest()).unwrap(), version.payload().to_vec())
}

#[tokio::test]
async fn a_good_table_is_published_and_served() {
    let service = Service::new().await;
    let (manifest, payload) = shipped();
    let text = manifest.to_string();
    let parts: [(&str, &[u8]); 2] = [("manifest", text.as_bytes()), ("payload", &payload)];
    assert_eq!(get(&service.app, &format!("/v1/tables/{NAME}")).await.status, 404);
    let answer = upload(&service, NAME, &parts).await;
    assert_eq!(answer.status, 201, "{:?}", answer.body);
    assert_eq!(answer.header("location"), format!("/v1/tables/{NAME}/versions/1"));
    assert_eq!(answer.json()["digest"], manifest["digest"]);
    let digest = manifest["digest"].as_str().unwrap();
    assert_eq!(get(&service.app, &at(NAME, digest, "/data")).await.body, payload);
    assert_eq!(get(&service.app, &at(NAME, "latest", "")).await.json()["version"], 1);
    let again = upload(&service, NAME, &parts).await;
    assert_eq!((again.status.as_u16(), &again.json()["version"]), (200, &json!(1)));
}

#[tokio::test]
async fn a_bad_table_is_kept_and_neither_listed_nor_served() {
    let service = Service::new().await;
    let (mut manifest, payload) = shipped();
    manifest["errors"]["standard_draw"]["tv_mean"] = json!(1e-6);
    let text = manifest.to_string();
    let answer = upload(&service, NAME, &[("manifest", text.as_bytes()), ("payload", &payload)]).await;
    let problem = answer.json();
    assert_eq!((answer.status.as_u16(), &problem["type"]), (422, &json!("urn:ltc:problem:quarantined")));
    assert!(problem["faults"][0].as_str().unwrap().contains("tv_mean"), "{problem}");
    assert_eq!(problem["version"], 1);
    for path in [format!("/v1/tables/{NAME}"), at(NAME, "1", ""), at(NAME, "1", "/data")] {
        assert_eq!(get(&service.app, &path).await.status, 404, "{path}");
    }
    assert!(!get(&service.app, "/v1/tables").await.json().to_string().contains(NAME));
    let kept = service.store.version(NAME, 1).await.unwrap();
    assert!(kept.reason.unwrap().contains("tv_mean"));
    let blob = service.store.get(BlobKind::Payload, problem["digest"].as_str().unwrap()).await.unwrap();
    assert!(
        blob.starts_with(b"{") && blob.ends_with(&payload),
        "manifest and payload are there for inspection"
    );
    // The same payload with the right manifest is welcome.
    let text = shipped().0.to_string();
    let mended = upload(&service, NAME, &[("manifest", text.as_bytes()), ("payload", &payload)]).await;
    assert_eq!((mended.status.as_u16(), &mended.json()["version"]), (201, &json!(2)), "{:?}", mended.body);
}

#[tokio::test]
async fn what_is_no_upload_is_refused() {
    let service = Service::new().await;
    for (parts, status, field) in [
        (&[][..], 422, "manifest"),
        (&[("manifest", &b"{}"[..])], 422, "payload"),
        (&[("manifest", &b"{"[..]), ("payload", b"")], 400, "manifest"),
        (&[("manifest", &b"3"[..]), ("payload", b"")], 422, "manifest"),
        (&[("manifest", &b"{}"[..]), ("manifest", b"{}")], 422, "manifest"),
        (&[("other", &b"{}"[..])], 422, "body"),
    ] {
        let answer = upload(&service, NAME, parts).await;
        assert_eq!((answer.status.as_u16(), answer.field()), (status, field.to_owned()), "{parts:?}");
    }
    let parts: [(&str, &[u8]); 2] = [("manifest", b"{}"), ("payload", b"")];
    assert_eq!(upload(&service, "BAD..NAME", &parts).await.status, 422);
    let path = format!("/v1/tables/{NAME}/versions");
    let authorization = ("authorization", service.token.as_str());
    for (media_type, status) in [("application/json", 415), ("multipart/form-data", 400), ("text/plain", 415)]
    {
        let headers = [("content-type", media_type), authorization];
        assert_eq!(
            send(&service.app, "POST", &path, &headers, "x").await.status.as_u16(),
            status,
            "{media_type}"
        );
    }
    let limits = ltc_service::Limits { upload_bytes: 1000, ..ltc_service::Limits::default() };
    let small = Service::with(ltc_service::Settings { limits, ..ltc_service::Settings::default() }).await;
    let large = vec![b' '; 2000];
    let answer = upload(&small, NAME, &[("manifest", &b"{}"[..]), ("payload", &large)]).await;
    assert_eq!(answer.json()["type"], "urn:ltc:problem:body-too-large");
}
