//! Aliases: compare and swap.

use ltc_store::Metadata;
use serde_json::json;

use crate::support::*;

const STABLE: &str = "/v1/tables/ggx-isotropic/aliases/stable";
const NEW: &str = "/v1/tables/ggx-isotropic/aliases/studio-b";

#[tokio::test]
async fn an_alias_moves_by_compare_and_swap() {
    let service = Service::new().await;
    let before = get(&service.app, STABLE).await;
    assert_eq!(before.json()["version"], 10, "seeded");
    let etag = before.header("etag").to_owned();
    assert_eq!(get(&service.app, &at(ISO, "stable", "")).await.json()["version"], 10);

    let moved = service.write("PUT", STABLE, &[("if-match", &etag)], &json!({ "version": 2 })).await;
    assert_eq!(moved.status, 200, "{:?}", moved.body);
    assert_eq!(moved.json()["version"], 2);
    let after = get(&service.app, STABLE).await;
    assert_eq!((after.header("etag"), after.json()), (moved.header("etag"), moved.json()));
    assert_eq!(get(&service.app, &at(ISO, "stable", "")).await.json()["version"], 2, "no old answer is kept");

    let late = service.write("PUT", STABLE, &[("if-match", &etag)], &json!({ "version": 1 })).await;
    assert_eq!(
        (late.status.as_u16(), &late.json()["type"]),
        (412, &json!("urn:ltc:problem:precondition-failed"))
    );
    assert_eq!(get(&service.app, STABLE).await.json()["version"], 2);
}

#[tokio::test]
async fn an_alias_is_made_once() {
    let service = Service::new().await;
    assert_eq!(get(&service.app, NEW).await.status, 404);
    let digest = digest_of(ISO, "1");
    let none = [("if-none-match", "*")];
    let made = service.write("PUT", NEW, &none, &json!({ "version": digest })).await;
    assert_eq!((made.status.as_u16(), &made.json()["version"]), (201, &json!(1)));
    assert_eq!(service.write("PUT", NEW, &none, &json!({ "version": 2 })).await.status, 412);
    assert_eq!(get(&service.app, &at(ISO, "studio-b", "")).await.json()["digest"], digest);
    let list = get(&service.app, "/v1/tables/ggx-isotropic/aliases").await.json();
    let names: Vec<_> = list["aliases"].as_array().unwrap().iter().map(|a| a["alias"].clone()).collect();
    assert_eq!(names, ["latest", "stable", "studio-b"]);
    // Whatever it is, but there must be one.
    assert_eq!(
        service.write("PUT", NEW, &[("if-match", "*")], &json!({ "version": "latest" })).await.status,
        200
    );
    let absent = "/v1/tables/ggx-isotropic/aliases/none";
    assert_eq!(
        service.write("PUT", absent, &[("if-match", "*")], &json!({ "version": 2 })).await.status,
        412
    );
}

#[tokio::test]
async fn an_alias_moves_for_nobody_who_has_not_seen_it() {
    let service = Service::new().await;
    for headers in [&[][..], &[("if-none-match", "\"x\"")], &[("if-none-match", "W/\"x\"")]] {
        for path in [STABLE, NEW] {
            let answer = service.write("PUT", path, headers, &json!({ "version": 1 })).await;
            assert_eq!(answer.status, 428, "{path} {headers:?}");
        }
    }
    assert_eq!(get(&service.app, STABLE).await.json()["version"], 10);
}

#[tokio::test]
async fn latest_is_there_before_anybody_sets_it() {
    let service = Service::new().await;
    let uploaded = service.store.version(ISO, 1).await.unwrap();
    for number in [1, 2] {
        let new = ltc_store::NewVersion {
            table: "mine".to_owned(),
            digest: format!("sha256:{number}"),
            manifest: uploaded.manifest.clone(),
            state: ltc_store::VersionState::Published,
            spec_digest: None,
            reason: None,
        };
        service.store.add_version(new, None).await.unwrap();
    }
    let path = "/v1/tables/mine/aliases/latest";
    let named = async |path: &str| get(&service.app, path).await;
    // What another process changed is read with the next write.
    let none = service
        .write("PUT", "/v1/tables/mine/aliases/x", &[("if-match", "*")], &json!({ "version": 1 }))
        .await;
    assert_eq!(none.status, 412);
    let before = named(path).await;
    assert_eq!(
        (before.status.as_u16(), &before.json()["version"], &before.json()["revision"]),
        (200, &json!(2), &json!(0))
    );
    let list = named("/v1/tables/mine/aliases").await.json();
    assert_eq!(list["aliases"], json!([before.json()]));
    assert_eq!(named("/v1/tables/mine").await.json()["aliases"], json!({ "latest": 2 }));
    let etag = before.header("etag").to_owned();
    let moved = service.write("PUT", path, &[("if-match", &etag)], &json!({ "version": 1 })).await;
    assert_eq!((moved.status.as_u16(), &moved.json()["revision"]), (201, &json!(1)));
    assert_eq!(
        service.write("PUT", path, &[("if-match", &etag)], &json!({ "version": 2 })).await.status,
        412
    );
    assert_eq!(
        service.write("PUT", path, &[("if-none-match", "*")], &json!({ "version": 2 })).await.status,
        412
    );
    assert_eq!(named("/v1/tables/mine").await.json()["latest"], 1);
}

#[tokio::test]
async fn of_many_at_once_one_wins() {
    let service = std::sync::Arc::new(Service::new().await);
    let before = get(&service.app, STABLE).await;
    let etag = before.header("etag").to_owned();
    let tries = (0..20).map(|i| {
        let (service, etag) = (std::sync::Arc::clone(&service), etag.clone());
        tokio::spawn(async move {
            let body = json!({ "version": 1 + i % 2 });
            service.write("PUT", STABLE, &[("if-match", &etag)], &body).await.status.as_u16()
        })
    });
    let mut statuses = Vec::new();
    for one in tries.collect::<Vec<_>>() {
        statuses.push(one.await.unwrap());
    }
    statuses.sort_unstable();
    assert_eq!(statuses[0], 200);
    assert!(statuses[1..].iter().all(|status| *status == 412), "{statuses:?}");
    let revision = before.json()["revision"].as_u64().unwrap();
    assert_eq!(get(&service.app, STABLE).await.json()["revision"], revision + 1);
}

#[tokio::test]
async fn what_is_wrong_moves_nothing() {
    let service = Service::new().await;
    let before = get(&service.app, STABLE).await.body;
    let any = [("if-match", "*")];
    for (path, headers, body, status) in [
        (STABLE, &[][..], json!({ "version": 2 }), 428),
        (STABLE, &any, json!({ "version": 3 }), 422),
        (STABLE, &any, json!({ "version": "sha256:0" }), 422),
        (STABLE, &any, json!({ "version": -1 }), 422),
        (STABLE, &any, json!({ "versoin": 1 }), 422),
        (STABLE, &any, json!({}), 422),
        (STABLE, &any, json!([]), 422),
        ("/v1/tables/none/aliases/stable", &any, json!({ "version": 1 }), 404),
        ("/v1/tables/ggx-isotropic/aliases/7", &any, json!({ "version": 1 }), 422),
        ("/v1/tables/ggx-isotropic/aliases/sha256:0", &any, json!({ "version": 1 }), 422),
        ("/v1/tables/ggx-isotropic/aliases/a%2Fb", &any, json!({ "version": 1 }), 422),
        ("/v1/tables/ggx-isotropic/aliases/%0d%0a", &any, json!({ "version": 1 }), 422),
    ] {
        let answer = service.write("PUT", path, headers, &body).await;
        assert_eq!(answer.status.as_u16(), status, "{path} {body} {:?}", answer.body);
    }
    let broken =
        send(&service.app, "PUT", STABLE, &[JSON, any[0], ("authorization", &service.token)], "{").await;
    assert_eq!(broken.status, 400);
    assert_eq!(get(&service.app, STABLE).await.body, before);
}
