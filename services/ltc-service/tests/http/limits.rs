//! What one client may ask for, and what all together may.

use ltc_service::{Limits, Settings};
use serde_json::json;

use crate::support::*;

#[tokio::test]
async fn a_client_that_asks_too_often_waits() {
    let app = service_with(Limits { reads_per_second: 5, ..Limits::default() }).await;
    let mut statuses = Vec::new();
    for _ in 0..8 {
        let answer = get(&app, "/v1/tables").await;
        statuses.push(answer.status.as_u16());
        if answer.status == 429 {
            assert_eq!(answer.json()["type"], "urn:ltc:problem:rate-limited");
            assert!(answer.header("retry-after").parse::<u64>().unwrap() >= 1);
        }
    }
    assert_eq!(statuses[..5], [200; 5]);
    assert!(statuses[5..].contains(&429), "{statuses:?}");
}

#[tokio::test]
async fn guesses_of_tokens_are_counted() {
    let service = Service::new().await;
    let mut last = 0;
    for _ in 0..60 {
        let answer =
            send(&service.app, "POST", "/v1/benchmarks", &[JSON, ("authorization", "Bearer x")], "{}").await;
        last = answer.status.as_u16();
        assert!([401, 429].contains(&last));
    }
    assert_eq!(last, 429);
    let body = json!({ "name": "a", "run": {} });
    assert_eq!(
        service.write("POST", "/v1/benchmarks", &[], &body).await.status,
        201,
        "a good token is another client"
    );
}

#[tokio::test]
async fn writes_of_one_token_are_counted() {
    let limits = Limits { writes_per_second: 1, ..Limits::default() };
    let service = Service::with(Settings { limits, ..Settings::default() }).await;
    let body = json!({ "name": "a", "run": {} });
    let mut statuses = Vec::new();
    for _ in 0..8 {
        statuses.push(service.write("POST", "/v1/benchmarks", &[], &body).await.status.as_u16());
    }
    assert_eq!(statuses[..5], [201; 5]);
    assert_eq!(statuses[7], 429, "{statuses:?}");
}
