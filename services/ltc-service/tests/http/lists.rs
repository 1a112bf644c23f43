//! Lists, manifests, health, the page.

use axum::http::StatusCode;
use ltc_service::Settings;
use ltc_store::{BlobKind, Blobs};
use ltc_table::{Catalogue, Manifest};
use serde_json::json;

use crate::support::*;

#[tokio::test]
async fn the_list_names_tables_and_versions() {
    let answer = get(&service().await, "/v1/tables").await;
    assert_eq!(answer.status, StatusCode::OK);
    assert_eq!(answer.header("content-type"), "application/json");
    let list = answer.json();
    let tables = list["tables"].as_array().unwrap();
    assert_eq!(tables.len(), 2);
    assert_eq!(tables[0]["name"], ANISO);
    assert_eq!(tables[1]["name"], ISO);
    assert_eq!(tables[1]["latest"], 10, "10 is later than 2");
    assert_eq!(tables[1]["versions"], json!([1, 2, 10]));
    assert_eq!(tables[1]["digest"], digest_of(ISO, "10"));
}

#[tokio::test]
async fn a_table_is_its_latest_manifest_and_its_versions() {
    let answer = get(&service().await, "/v1/tables/ggx-isotropic").await;
    let table = answer.json();
    assert_eq!(table["versions"], json!([1, 2, 10]));
    assert_eq!(table["latest"], 10);
    let manifest: Manifest = serde_json::from_value(table).unwrap();
    assert_eq!(&manifest, catalogue().version(ISO, "10").unwrap().manifest());
}

#[tokio::test]
async fn versions_are_listed_with_digests() {
    let answer = get(&service().await, "/v1/tables/ggx-isotropic/versions").await;
    let list = answer.json();
    assert_eq!((&list["name"], &list["latest"]), (&json!(ISO), &json!(10)));
    let versions = list["versions"].as_array().unwrap();
    assert_eq!(versions.len(), 3);
    for (version, number) in versions.iter().zip([1, 2, 10]) {
        assert_eq!(version["version"], number);
        assert_eq!(version["digest"], digest_of(ISO, &number.to_string()));
        assert_eq!(version["created"], "2026-01-01T00:00:00Z");
        assert_eq!(version["tv_mean"], 0.125);
    }
}

#[tokio::test]
async fn a_manifest_is_found_by_number_digest_and_alias() {
    let app = service().await;
    let manifest_json = catalogue().version(ISO, "2").unwrap().manifest_json().unwrap();
    let digest = digest_of(ISO, "2");
    for version in ["2", &digest, &digest.replace(':', "%3A")] {
        let answer = get(&app, &at(ISO, version, "")).await;
        assert_eq!(answer.status, StatusCode::OK, "{version}");
        assert_eq!(answer.body, manifest_json, "the bytes of manifest.json");
        assert_eq!(answer.header("x-table-version"), "ggx-isotropic@2");
        assert_eq!(answer.header("x-table-digest"), digest);
    }
    let latest = get(&app, &at(ISO, "latest", "")).await;
    assert_eq!(latest.json()["version"], 10);
    assert_eq!(latest.header("x-table-version"), "ggx-isotropic@10");
}

#[tokio::test]
async fn what_is_not_there_is_answered_with_what_is() {
    let app = service().await;
    let answer = get(&app, "/v1/tables/ggx-isotropc").await;
    assert_eq!(answer.status, StatusCode::NOT_FOUND);
    let problem = answer.json();
    assert_eq!(problem["type"], "urn:ltc:problem:no-such-table");
    assert!(problem["detail"].as_str().unwrap().contains("ggx-anisotropic, ggx-isotropic"), "{problem}");
    let unknown = format!("sha256:{}", "0".repeat(64));
    for version in ["3", "0", "-1", "4294967296", "Latest", "stabl", "sha256:12", &unknown] {
        for rest in ["", "/data", "/fresnel", "/lookup?theta=0&alpha_x=0.1&alpha_y=0.1"] {
            let answer = get(&app, &at(ISO, version, rest)).await;
            assert_eq!(answer.status, StatusCode::NOT_FOUND, "{version}{rest}");
            let problem = answer.json();
            assert_eq!(problem["type"], "urn:ltc:problem:no-such-version");
            assert!(problem["detail"].as_str().unwrap().contains("10, 2, 1, stable, latest"), "{problem}");
        }
    }
    let other = digest_of(ANISO, "1");
    let answer = get(&app, &at(ISO, &other, "")).await;
    assert_eq!(answer.status, StatusCode::NOT_FOUND, "a digest of another table");
}

#[tokio::test]
async fn alive_always_and_ready_with_a_table() {
    let full = service().await;
    let empty = service_over(&Catalogue::default(), Settings::default()).await.0;
    for service in [&full, &empty] {
        let alive = get(service, "/healthz").await;
        assert_eq!(alive.status, StatusCode::OK);
        assert_eq!(alive.json()["status"], "ok");
        assert_eq!(alive.header("cache-control"), "no-store");
    }
    let ready = get(&full, "/readyz").await;
    assert_eq!(ready.status, StatusCode::OK);
    assert_eq!(ready.json(), json!({"status": "ready", "tables": 2}));
    let not_ready = get(&empty, "/readyz").await;
    assert_eq!(not_ready.status, StatusCode::SERVICE_UNAVAILABLE);
    assert_eq!(not_ready.json()["type"], "urn:ltc:problem:not-ready");
    assert_eq!(get(&empty, "/v1/tables").await.json(), json!({"tables": []}));
    // Without payloads there is nothing to serve, whatever the metadata says.
    let lost = Service::new().await;
    for (key, _) in lost.store.list(BlobKind::Payload).await.unwrap() {
        lost.store.delete(BlobKind::Payload, &key).await.unwrap();
    }
    let not_ready = get(&lost.app, "/readyz").await;
    assert_eq!(not_ready.status, StatusCode::SERVICE_UNAVAILABLE);
    assert!(not_ready.json()["detail"].as_str().unwrap().contains("payloads"), "{:?}", not_ready.json());
}

#[tokio::test]
async fn the_page_lists_tables_and_loads_nothing() {
    let app_with_tables = service().await;
    let answer = get(&app_with_tables, "/").await;
    assert_eq!(answer.status, StatusCode::OK);
    assert_eq!(answer.header("content-type"), "text/html; charset=utf-8");
    assert!(answer.header("content-security-policy").starts_with("default-src 'none'"));
    let page = String::from_utf8(answer.body.to_vec()).unwrap();
    for needle in [ISO, ANISO, &digest_of(ISO, "10"), "0.1250", "made-up &lt;b&gt;&amp;&quot;&#39;"] {
        assert!(page.contains(needle), "{needle}");
    }
    for foreign in ["made-up <b>", "http:", "https:", "<script", "{{"] {
        assert!(!page.contains(foreign), "{foreign}");
    }
    // Every link leads somewhere.
    let links: Vec<_> = page.split("href=\"").skip(1).map(|rest| rest.split('"').next().unwrap()).collect();
    assert!(links.len() > 20, "{links:?}");
    for link in links {
        assert_eq!(get(&app_with_tables, &format!("/{link}")).await.status, StatusCode::OK, "{link}");
    }
    let empty = service_over(&Catalogue::default(), Settings::default()).await.0;
    let page = get(&empty, "/").await;
    assert!(String::from_utf8_lossy(&page.body).contains("There is no table yet."));
}
