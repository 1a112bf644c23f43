//! Metrics, problem types, readiness.

use crate::support::*;

#[tokio::test]
async fn metrics_count_every_answer_once() {
    let service = Service::new().await;
    let data = at(ISO, "1", "/data");
    for path in [data.as_str(), &data, &data, "/nowhere", "/v1/tables/none"] {
        get(&service.app, path).await;
    }
    let text = get(&service.app, "/metrics").await;
    assert_eq!(text.header("content-type"), "text/plain; version=0.0.4; charset=utf-8");
    let text = String::from_utf8(text.body.to_vec()).unwrap();
    for line in [
        "ltc_http_requests_total{route=\"/v1/tables/{name}/versions/{version}/data\",status=\"200\"} 3",
        "ltc_http_requests_total{route=\"none\",status=\"404\"} 1",
        "ltc_http_requests_total{route=\"/v1/tables/{name}\",status=\"404\"} 1",
        "ltc_answer_cache_hits_total 2",
        "ltc_refits{state=\"queued\"} 0",
        "ltc_tables 2",
    ] {
        assert!(text.lines().any(|found| found == line), "{line}\n{text}");
    }
    assert!(text.contains("ltc_store_bytes{kind=\"payload\"} "));
    assert!(text.contains("ltc_http_request_duration_seconds_bucket{"));
    for line in text.lines().filter(|line| !line.starts_with('#')) {
        let value = line.rsplit(' ').next().unwrap();
        assert!(value.parse::<f64>().is_ok(), "{line}");
    }
}

#[tokio::test]
async fn types_of_problems_are_explained_where_help_leads() {
    let app = service().await;
    let problem = get(&app, "/nowhere").await.json();
    let explained = get(&app, problem["help"].as_str().unwrap()).await;
    assert_eq!((explained.status.as_u16(), &explained.json()["type"]), (200, &problem["type"]));
    let all = get(&app, "/problems").await.json();
    for kind in all["problems"].as_array().unwrap() {
        let slug = kind["type"].as_str().unwrap().rsplit(':').next().unwrap();
        assert_eq!(get(&app, &format!("/problems/{slug}")).await.json(), *kind);
    }
    assert_eq!(get(&app, "/problems/none").await.status, 404);
}
