//! Differences of versions.

use crate::support::*;

#[tokio::test]
async fn versions_are_compared() {
    let app = service().await;
    let diff = get(&app, &at(ISO, "1", "/diff/2")).await;
    assert_eq!(diff.status, 200, "{:?}", diff.body);
    let found = diff.json();
    assert_eq!(found["same_payload"], false);
    assert!(found["entries"]["all"]["tv_max"].as_f64().unwrap() > 0.0);
    assert!(found["manifest"]["digest"].is_array());
    let digest = digest_of(ISO, "2");
    assert_eq!(get(&app, &at(ISO, "1", &format!("/diff/{digest}"))).await.body, diff.body);
    let same = get(&app, &at(ISO, "latest", "/diff/10")).await.json();
    assert_eq!((&same["same_payload"], &same["entries"]["all"]["tv_max"]), (&true.into(), &0.0.into()));
}

#[tokio::test]
async fn tables_of_different_shapes_are_compared_by_their_lookups() {
    let app = service().await;
    let found = get(&app, &at(ISO, "1", "/diff/ggx-anisotropic@1")).await;
    assert_eq!(found.status, 200, "{:?}", found.body);
    let found = found.json();
    assert!(found["entries"].is_null());
    assert!(found["lookups"]["compared"].as_u64().unwrap() > 0);
    for other in ["7", "none@1", "ggx-anisotropic@7", "none"] {
        assert_eq!(get(&app, &at(ISO, "1", &format!("/diff/{other}"))).await.status, 404, "{other}");
    }
}
