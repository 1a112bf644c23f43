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

/// A run as `ltc bench` writes it.
fn run(time: f64) -> serde_json::Value {
    json!({
        "schema": 1, "tool": "0.1.0", "quick": true, "date": "2026-01-01T00:00:00Z", "commit": "abc",
        "machine": { "cpu": "<b>\"cpu\"</b>", "threads": 2, "system": "linux", "build": "optimised" },
        "records": [{
            "id": "integral/quad/exact/f32", "per": "light", "errors": { "max": 6e-7 },
            "time": { "median": time, "low": 0.98 * time, "high": 1.02 * time },
        }],
    })
}

#[tokio::test]
async fn the_history_is_a_page_that_marks_what_became_worse() {
    let service = Service::new().await;
    let page = async |query: &str| {
        let answer = get(&service.app, &format!("/benchmarks{query}")).await;
        assert_eq!(answer.status, 200, "{query}");
        assert_eq!(answer.header("content-type"), "text/html; charset=utf-8");
        assert!(answer.header("content-security-policy").starts_with("default-src 'none'"));
        assert_eq!(answer.header("cache-control"), "no-cache");
        String::from_utf8(answer.body.to_vec()).unwrap()
    };
    assert!(page("").await.contains("There is no run that fits."));
    for (day, time) in [(1, 40.0), (2, 41.0), (3, 49.0)] {
        let body = json!({ "name": "<i>", "at": format!("2026-01-0{day}T00:00:00Z"), "run": run(time) });
        assert_eq!(service.write("POST", "/v1/benchmarks", &[], &body).await.status, 201);
    }
    let other = json!({ "name": "other", "run": { "ns": 1 } });
    assert_eq!(service.write("POST", "/v1/benchmarks", &[], &other).await.status, 201);
    let all = page("").await;
    for needle in ["3 runs, 2 measures.", "1 more are no results", "&lt;b&gt;&quot;cpu&quot;", "&lt;i&gt;"] {
        assert!(all.contains(needle), "{needle}: {all}");
    }
    assert_eq!(all.matches("<figure").count(), 2);
    assert_eq!(all.matches("class=\"worse\" d=").count(), 1, "the third run's time");
    for markup in ["<b>", "<i>", "<script", "http://", "https://", "{{"] {
        assert!(!all.contains(markup), "{markup}");
    }
    assert_eq!(page("?measure=quad&worse=true").await.matches("<figure").count(), 1);
    // As a browser sends the form, with every field.
    let form = "?measure=quad%2Fexact%2Ff32+time&name=&since=&machine=&limit=60";
    assert_eq!(page(form).await.matches("<figure").count(), 1);
    assert_eq!(page("?since=2026-01-03T00:00:00Z").await.matches("class=\"worse\" d=").count(), 0);
    for query in ["limit=201", "limit=0", "page=0", "worse=maybe", "since=now", "measures=a"] {
        assert_eq!(get(&service.app, &format!("/benchmarks?{query}")).await.status, 422, "{query}");
    }
}
