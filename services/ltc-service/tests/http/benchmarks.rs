//! Benchmark runs in and out.

use serde_json::json;

use crate::support::*;

#[tokio::test]
async fn runs_come_back_by_series_and_time() {
    let service = Service::new().await;
    for (name, at) in
        [("quad", "2026-01-01T00:00:00Z"), ("quad", "2026-02-01T00:00:00Z"), ("line", "2026-03-01T00:00:00Z")]
    {
        let body = json!({ "name": name, "at": at, "run": { "ns": 12.5 } });
        let answer = service.write("POST", "/v1/benchmarks", &[], &body).await;
        assert_eq!(answer.status, 201, "{:?}", answer.body);
    }
    let now = service.write("POST", "/v1/benchmarks", &[], &json!({ "name": "quad", "run": {} })).await;
    assert!(now.json()["at"].as_str().unwrap().ends_with('Z'));
    let count = async |query: &str| {
        let list = get(&service.app, &format!("/v1/benchmarks{query}")).await;
        list.json()["benchmarks"].as_array().unwrap().len()
    };
    assert_eq!(count("").await, 4);
    assert_eq!(count("?name=quad").await, 3);
    assert_eq!(count("?name=quad&since=2026-02-01T00:00:00Z").await, 2);
    assert_eq!(count("?limit=1").await, 1);
    let first = &get(&service.app, "/v1/benchmarks?name=quad").await.json()["benchmarks"][0];
    assert_eq!((&first["at"].as_str().unwrap()[..10], &first["run"]["ns"]), ("2026-01-01", &json!(12.5)));
}

#[tokio::test]
async fn nonsense_is_refused() {
    let service = Service::new().await;
    for body in [
        json!({ "name": "", "run": {} }),
        json!({ "name": "a\nb", "run": {} }),
        json!({ "name": "a", "run": 3 }),
        json!({ "name": "a", "run": {}, "at": "yesterday" }),
        json!({ "name": "a", "run": {}, "at": "2026-13-01T00:00:00Z" }),
        json!({ "name": "a", "run": {}, "more": 1 }),
        json!({ "name": "a" }),
    ] {
        assert_eq!(service.write("POST", "/v1/benchmarks", &[], &body).await.status, 422, "{body}");
    }
    for query in ["since=now", "limit=0", "limit=10001", "limit=x", "nane=a"] {
        assert_eq!(get(&service.app, &format!("/v1/benchmarks?{query}")).await.status, 422, "{query}");
    }
}
