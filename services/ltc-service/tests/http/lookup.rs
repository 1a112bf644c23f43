//! Lookups, one and many.

use axum::body::Body;
use axum::http::{Request, StatusCode};
use ltc_service::Limits;
use ltc_table::{Lookup, Query};
use serde_json::{Value, json};

use crate::support::*;

fn expected(name: &str, query: Query) -> Lookup {
    catalogue().version(name, "latest").unwrap().table().lookup(&query).unwrap()
}

/// Queries over all quadrants, both orders of widths, and the ends of every axis.
fn queries() -> Vec<Query> {
    let mut queries = Vec::new();
    for theta in [0.0, 0.7, std::f64::consts::FRAC_PI_2] {
        for phi in [-9.0, 0.0, 0.3, 2.0, 4.0, 5.5, 1e6] {
            for (alpha_x, alpha_y) in [(0.4, 0.1), (0.1, 0.4), (0.3, 0.3), (0.0, 0.0), (1.0, 1.0)] {
                queries.push(Query { theta, phi, alpha_x, alpha_y });
            }
        }
    }
    queries
}

#[tokio::test]
async fn a_lookup_is_what_the_table_says() {
    let app = service().await;
    for query in queries() {
        let Query { theta, phi, alpha_x, alpha_y } = query;
        let rest = format!("/lookup?theta={theta}&phi={phi}&alpha_x={alpha_x}&alpha_y={alpha_y}");
        let answer = get(&app, &at(ANISO, "latest", &rest)).await;
        assert_eq!(answer.status, StatusCode::OK, "{rest}: {:?}", answer.body);
        let lookup: Lookup = serde_json::from_slice(&answer.body).unwrap();
        assert_eq!(lookup, expected(ANISO, query), "{rest}");
        assert_eq!(answer.json()["lobes"][0]["m"].as_array().unwrap().len(), 9);
    }
    // The comparison sees a difference where there is one.
    let [a, b] = [0.7, 0.7 + 1e-12].map(|theta| Query { theta, phi: 0.3, alpha_x: 0.4, alpha_y: 0.1 });
    assert_ne!(expected(ANISO, a), expected(ANISO, b));
}

#[tokio::test]
async fn phi_is_0_where_it_is_not_given() {
    let app = service().await;
    let rest = "/lookup?theta=0.7&alpha_x=0.4&alpha_y=0.1";
    let without = get(&app, &at(ANISO, "1", rest)).await;
    assert_eq!(without.body, get(&app, &at(ANISO, "1", &format!("{rest}&phi=0"))).await.body);
    assert_ne!(without.body, get(&app, &at(ANISO, "1", &format!("{rest}&phi=1"))).await.body);
}

#[tokio::test]
async fn numbers_that_are_none_are_refused_by_name() {
    let app = service().await;
    for (query, status, field) in [
        ("theta=NaN&alpha_x=0.1&alpha_y=0.1", 422, "theta"),
        ("theta=nan&alpha_x=0.1&alpha_y=0.1", 422, "theta"),
        ("theta=-NaN&alpha_x=0.1&alpha_y=0.1", 422, "theta"),
        ("theta=inf&alpha_x=0.1&alpha_y=0.1", 422, "theta"),
        ("theta=1.6&alpha_x=0.1&alpha_y=0.1", 422, "theta"),
        ("theta=-0.1&alpha_x=0.1&alpha_y=0.1", 422, "theta"),
        ("theta=0.1&phi=NaN&alpha_x=0.1&alpha_y=0.1", 422, "phi"),
        ("theta=0.1&phi=1e999&alpha_x=0.1&alpha_y=0.1", 422, "phi"),
        ("theta=0.1&alpha_x=NaN&alpha_y=0.1", 422, "alpha_x"),
        ("theta=0.1&alpha_x=0.1&alpha_y=infinity", 422, "alpha_y"),
        ("theta=0.1&alpha_x=-0.1&alpha_y=0.1", 422, "alpha_x"),
        ("theta=0.1&alpha_x=0.1&alpha_y=1.1", 422, "alpha_y"),
        ("alpha_x=0.1&alpha_y=0.1", 422, "theta"),
        ("theta=0.1&alpha_x=0.1", 422, "alpha_y"),
        ("theta=0.1&alpha_x=0.1&alpha_y=0.1&fi=1", 422, "fi"),
        ("theta=0.1&alpha_x=0.1&alpha_y=0.1&theta=0.1", 422, "theta"),
        ("theta=&alpha_x=0.1&alpha_y=0.1", 400, "theta"),
        ("theta=abc&alpha_x=0.1&alpha_y=0.1", 400, "theta"),
        ("theta=0x1&alpha_x=0.1&alpha_y=0.1", 400, "theta"),
        ("theta=0,1&alpha_x=0.1&alpha_y=0.1", 400, "theta"),
        ("theta=%00&alpha_x=0.1&alpha_y=0.1", 400, "theta"),
        ("theta=%E2&alpha_x=0.1&alpha_y=0.1", 400, "theta"),
    ] {
        let answer = get(&app, &at(ANISO, "1", &format!("/lookup?{query}"))).await;
        assert_eq!(answer.status.as_u16(), status, "{query}: {:?}", answer.body);
        assert_eq!(answer.field(), field, "{query}");
        assert!(answer.json()["detail"].as_str().unwrap().contains(field), "{query}");
    }
}

#[tokio::test]
async fn an_isotropic_table_refuses_two_widths() {
    let app = service().await;
    let answer = get(&app, &at(ISO, "1", "/lookup?theta=0.5&alpha_x=0.2&alpha_y=0.3")).await;
    assert_eq!(answer.status, StatusCode::UNPROCESSABLE_ENTITY);
    assert!(answer.json()["detail"].as_str().unwrap().contains("isotropic"));
    let turned = get(&app, &at(ISO, "1", "/lookup?theta=0.5&phi=1&alpha_x=0.2&alpha_y=0.2")).await;
    assert_eq!(turned.status, StatusCode::OK);
}

#[tokio::test]
async fn a_batch_answers_in_order() {
    let app = service().await;
    let queries = queries();
    let answer = post(&app, &at(ANISO, "latest", "/lookup"), serde_json::to_vec(&queries).unwrap()).await;
    assert_eq!(answer.status, StatusCode::OK);
    assert_eq!(answer.header("content-type"), "application/json");
    assert_eq!(answer.header("x-table-digest"), digest_of(ANISO, "1"));
    let lookups: Vec<Lookup> = serde_json::from_slice(&answer.body).unwrap();
    let expected: Vec<Lookup> = queries.into_iter().map(|query| expected(ANISO, query)).collect();
    assert_eq!(lookups, expected);
    assert_eq!(post(&app, &at(ANISO, "latest", "/lookup"), "[]").await.json(), json!([]));
}

#[tokio::test]
async fn a_bad_item_spoils_only_itself() {
    let app = service().await;
    let good = r#"{"theta":0.7,"alpha_x":0.4,"alpha_y":0.1}"#;
    let bad = [
        (r#"{"theta":1.6,"alpha_x":0.4,"alpha_y":0.1}"#, "theta"),
        (r#"{"theta":1e999,"alpha_x":0.4,"alpha_y":0.1}"#, "number out of range"),
        (r#"{"theta":null,"alpha_x":0.4,"alpha_y":0.1}"#, "null"),
        (r#"{"theta":"0.7","alpha_x":0.4,"alpha_y":0.1}"#, "string"),
        (r#"{"alpha_x":0.4,"alpha_y":0.1}"#, "theta"),
        (r#"{"theta":0.7,"theta":0.7,"alpha_x":0.4,"alpha_y":0.1}"#, "duplicate"),
        (r#"{"theta":0.7,"fi":1,"alpha_x":0.4,"alpha_y":0.1}"#, "fi"),
        ("[0.7,0.3,0.4,0.1]", "object"),
        ("null", "object"),
        ("7", "object"),
        ("\"x\"", "object"),
    ];
    let items: Vec<&str> = bad.iter().flat_map(|(item, _)| [good, item]).collect();
    let answer = post(&app, &at(ANISO, "1", "/lookup"), format!("[{}]", items.join(", "))).await;
    assert_eq!(answer.status, StatusCode::OK);
    let answers = answer.json();
    let answers = answers.as_array().unwrap();
    assert_eq!(answers.len(), items.len());
    let query = Query { theta: 0.7, phi: 0.0, alpha_x: 0.4, alpha_y: 0.1 };
    for (pair, (item, needle)) in answers.chunks(2).zip(bad) {
        assert_eq!(pair[0], serde_json::to_value(expected(ANISO, query)).unwrap());
        assert_eq!(pair[1].as_object().unwrap().len(), 1, "an error and nothing else");
        assert!(pair[1]["error"].as_str().unwrap().contains(needle), "{item}: {}", pair[1]);
    }
}

#[tokio::test]
async fn a_body_that_is_no_array_is_refused_whole() {
    let app = service().await;
    let path = at(ANISO, "1", "/lookup");
    for (body, status) in [
        ("", 400),
        ("[", 400),
        ("[{]", 400),
        ("[NaN]", 400),
        (r#"[{"theta":NaN,"alpha_x":0.1,"alpha_y":0.1}]"#, 400),
        ("[] []", 400),
        ("theta=1", 400),
        ("{}", 422),
        ("null", 422),
        ("7", 422),
        (r#"{"theta":0.7,"alpha_x":0.4,"alpha_y":0.1}"#, 422),
    ] {
        let answer = post(&app, &path, body).await;
        assert_eq!(answer.status.as_u16(), status, "{body}: {:?}", answer.body);
    }
    let answer = post(&app, &path, &b"[\"\xff\"]"[..]).await;
    assert_eq!(answer.status, StatusCode::BAD_REQUEST);
    // Deep nesting is an item like another, not a deep stack.
    let deep = format!("[{}{}]", "[".repeat(200_000), "]".repeat(200_000));
    let answer = post(&app, &path, deep).await;
    assert!(answer.json()[0]["error"].is_string() || answer.status == StatusCode::BAD_REQUEST);
}

#[tokio::test]
async fn bodies_have_a_type_a_size_and_a_number_of_queries() {
    let limits = Limits { body_bytes: 1000, batch_queries: 3, ..Limits::default() };
    let app = service_with(limits).await;
    let path = at(ANISO, "1", "/lookup");
    for (content_type, status) in [
        ("application/json", 200),
        ("application/json; charset=utf-8", 200),
        ("Application/JSON", 200),
        ("application/vnd.ltc+json", 200),
        ("text/plain", 415),
        ("application/x-www-form-urlencoded", 415),
        ("", 415),
    ] {
        let request = Request::post(&path).header("content-type", content_type).body(Body::from("[]"));
        assert_eq!(ask(&app, request.unwrap()).await.status.as_u16(), status, "{content_type}");
    }
    let untyped = ask(&app, Request::post(&path).body(Body::from("[]")).unwrap()).await;
    assert_eq!(untyped.status, StatusCode::OK);

    assert_eq!(post(&app, &path, "[1,2,3]").await.status, StatusCode::OK);
    let many = post(&app, &path, "[1,2,3,4]").await;
    assert_eq!(many.status, StatusCode::PAYLOAD_TOO_LARGE);
    assert_eq!(many.json()["type"], "urn:ltc:problem:too-many-queries");
    let at_limit = format!("[{}]", " ".repeat(998));
    assert_eq!(post(&app, &path, at_limit.clone()).await.status, StatusCode::OK);
    let above = post(&app, &path, at_limit + " ").await;
    assert_eq!(above.status, StatusCode::PAYLOAD_TOO_LARGE);
    assert_eq!(above.json()["type"], "urn:ltc:problem:body-too-large");
    assert!(above.json()["detail"].as_str().unwrap().contains("1000"));
}

#[tokio::test]
async fn the_default_limits_hold() {
    let app = service().await;
    let path = at(ANISO, "1", "/lookup");
    let most = format!("[{}]", " ".repeat((2 << 20) - 2));
    assert_eq!(post(&app, &path, most.clone()).await.status, StatusCode::OK);
    assert_eq!(post(&app, &path, most + " ").await.status, StatusCode::PAYLOAD_TOO_LARGE);
    // As long as such an item is with every digit: as many as may be asked fit into a body.
    let item = r#"{"theta": 0.7000000000000001, "phi": -3.1415926535897931, "alpha_x": 0.12345678901234567, "alpha_y": 0.10000000000000001}"#;
    let batch = |n: usize| format!("[{}]", vec![item; n].join(","));
    let answers: Vec<Value> = serde_json::from_slice(&post(&app, &path, batch(10_000)).await.body).unwrap();
    assert_eq!(answers.len(), 10_000);
    assert!(answers.iter().all(|a| *a == answers[0]));
    assert_eq!(post(&app, &path, batch(10_001)).await.status, StatusCode::PAYLOAD_TOO_LARGE);
}

#[tokio::test]
async fn numbers_in_give_numbers_out() {
    let app = service().await;
    let queries = [[0.5, 0.3, 0.4, 0.1], [0.0, 7.0, 0.1, 0.9]];
    let path = at(ANISO, "1", "/lookup");
    let table = catalogue().version(ANISO, "1").unwrap().table().clone();
    let expected: Vec<f64> = queries
        .iter()
        .flat_map(|&[theta, phi, alpha_x, alpha_y]| {
            let found = table.lookup(&Query { theta, phi, alpha_x, alpha_y }).unwrap();
            let lobes = found.lobes.iter().flat_map(|l| [l.weight].into_iter().chain(l.m));
            [found.magnitude, found.fresnel].into_iter().chain(lobes).collect::<Vec<_>>()
        })
        .collect();
    let body: Vec<u8> = queries.iter().flatten().flat_map(|v: &f64| v.to_le_bytes()).collect();
    let answer =
        send(&app, "POST", &path, &[("content-type", "application/vnd.ltc.queries.f64")], body).await;
    assert_eq!(answer.header("content-type"), "application/vnd.ltc.lookups.f64");
    let found: Vec<f64> = answer.body.chunks(8).map(|b| f64::from_le_bytes(b.try_into().unwrap())).collect();
    assert_eq!(found, expected);
    // Queries that single precision holds, so that only the answer is rounded.
    let body: Vec<u8> = [0.5_f32, 0.25, 0.5, 0.125].iter().flat_map(|v| v.to_le_bytes()).collect();
    let answer =
        send(&app, "POST", &path, &[("content-type", "application/vnd.ltc.queries.f32")], body).await;
    let found: Vec<f32> = answer.body.chunks(4).map(|b| f32::from_le_bytes(b.try_into().unwrap())).collect();
    let exact = table.lookup(&Query { theta: 0.5, phi: 0.25, alpha_x: 0.5, alpha_y: 0.125 }).unwrap();
    assert_eq!((found.len(), found[0], found[3]), (12, exact.magnitude as f32, exact.lobes[0].m[0] as f32));
    // The f32 nearest to a right angle is more than one; what is farther off is no view.
    let right_angle = core::f32::consts::FRAC_PI_2;
    for (theta, status) in [(right_angle, 200), (right_angle.next_up(), 422)] {
        let body: Vec<u8> = [theta, 0.25, 0.5, 0.125].iter().flat_map(|v| v.to_le_bytes()).collect();
        let answer =
            send(&app, "POST", &path, &[("content-type", "application/vnd.ltc.queries.f32")], body).await;
        assert_eq!(answer.status.as_u16(), status, "{theta}");
    }
}

#[tokio::test]
async fn numbers_that_are_no_queries_are_refused() {
    let app = service_with(Limits { batch_queries: 3, ..Limits::default() }).await;
    let path = at(ANISO, "1", "/lookup");
    let bytes = |numbers: &[f64]| numbers.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>();
    let good = [0.5, 0.3, 0.4, 0.1];
    for (body, status) in [
        (bytes(&good), 200),
        (Vec::new(), 200),
        (bytes(&good[..3]), 400),
        (vec![0; 31], 400),
        (bytes(&[good, [f64::NAN, 0.0, 0.5, 0.5]].concat()), 422),
        (bytes(&[0.5, 0.3, -0.4, 0.1]), 422),
        (bytes(&good.repeat(4)), 413),
    ] {
        let headers = [("content-type", "application/vnd.ltc.queries.f64")];
        let answer = send(&app, "POST", &path, &headers, body.clone()).await;
        assert_eq!(answer.status.as_u16(), status, "{} bytes {:?}", body.len(), answer.body);
        if status == 422 && body.len() > 32 {
            assert_eq!(answer.field(), "query 1");
        }
    }
}
