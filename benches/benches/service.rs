//! What a request costs the service, without a connection: the handlers, and what is before and after them.
//!
//! Each answer is checked before it is timed, against the tables themselves, and its status again every time. What is asked for
//! twice is given again from memory, as it is in production; "made" asks for something else each time.

use std::hint::black_box;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use axum::Router;
use axum::body::{Body, Bytes, to_bytes};
use axum::http::{Request, StatusCode, header};
use criterion::{
    BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main, measurement::WallTime,
};
use ltc_fit::draw;
use ltc_service::{AppState, Settings, Stores, app};
use ltc_store::MemoryStore;
use ltc_table::digest::digest;
use ltc_table::{Catalogue, Lookup, Query};
use tokio::runtime::Runtime;
use tower::ServiceExt;

const ISOTROPIC: &str = "ggx-isotropic";
const ANISOTROPIC: &str = "ggx-anisotropic";
const BATCH: usize = 1000;

struct Service {
    runtime: Runtime,
    app: Router,
}

impl Service {
    fn over(catalogue: &Catalogue) -> Self {
        // The threads of `ltc serve` would measure how threads wake each other.
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().expect("a runtime");
        let app = runtime.block_on(async {
            let store = Arc::new(MemoryStore::default());
            ltc_store::seed(&*store, &*store, catalogue, &|_| None).await.expect("a store in memory");
            let state = AppState::new(Stores::of(store), Settings::default()).await.expect("a state");
            app(state)
        });
        Self { runtime, app }
    }

    fn ask(&self, request: Request<Body>, expected: StatusCode) -> Bytes {
        self.runtime.block_on(async {
            let answer = self.app.clone().oneshot(request).await.unwrap_or_else(|never| match never {});
            assert_eq!(answer.status(), expected);
            to_bytes(answer.into_body(), usize::MAX).await.expect("a body")
        })
    }

    fn get(&self, path: &str) -> Bytes {
        self.ask(Request::get(path).body(Body::empty()).expect("a request"), StatusCode::OK)
    }
}

/// Times requests to one path.
fn time(group: &mut BenchmarkGroup<'_, WallTime>, service: &Service, name: &str, path: &str) {
    group.bench_function(name, |b| b.iter(|| black_box(service.get(black_box(path)))));
}

fn reads(c: &mut Criterion) {
    let catalogue = ltc_tables::shipped().expect("shipped tables are sound");
    let service = Service::over(&catalogue);
    let version = catalogue.find(ISOTROPIC).expect("it is shipped");
    let of = version.manifest().digest.clone();
    let data = format!("/v1/tables/{ISOTROPIC}/versions/{of}/data");
    let mut group = c.benchmark_group("service");

    assert_eq!(digest(&service.get(&data)), of, "the payload, byte for byte");
    time(&mut group, &service, "data by digest", &data);

    let known = format!("\"{of}\"");
    let news =
        || Request::get(&data).header(header::IF_NONE_MATCH, &known).body(Body::empty()).expect("a request");
    assert!(service.ask(news(), StatusCode::NOT_MODIFIED).is_empty());
    group.bench_function("304", |b| b.iter(|| black_box(service.ask(news(), StatusCode::NOT_MODIFIED))));

    let part = || {
        Request::get(&data).header(header::RANGE, "bytes=1000-1999").body(Body::empty()).expect("a request")
    };
    assert_eq!(service.ask(part(), StatusCode::PARTIAL_CONTENT), version.payload()[1000..2000]);
    group.bench_function("range", |b| b.iter(|| black_box(service.ask(part(), StatusCode::PARTIAL_CONTENT))));

    let list: serde_json::Value = serde_json::from_slice(&service.get("/v1/tables")).expect("JSON");
    let listed: Vec<_> =
        list["tables"].as_array().expect("a list").iter().filter_map(|t| t["name"].as_str()).collect();
    assert_eq!(listed, catalogue.names().collect::<Vec<_>>());
    time(&mut group, &service, "list", "/v1/tables");

    let manifest = format!("/v1/tables/{ISOTROPIC}/versions/{of}");
    let sent: serde_json::Value = serde_json::from_slice(&service.get(&manifest)).expect("JSON");
    assert_eq!(sent["digest"], of);
    time(&mut group, &service, "manifest", &manifest);

    // A crop that nobody has asked for yet: cut, encoded, hashed and kept.
    let count = AtomicU32::new(0);
    let fresh = || {
        let low = 0.1 + 1e-9 * f64::from(count.fetch_add(1, Ordering::Relaxed));
        format!("{data}?format=npz&precision=f16&alpha={low}..0.5")
    };
    assert!(service.get(&fresh()).starts_with(b"PK"), "a ZIP, as NPZ is");
    group.sample_size(20);
    group.bench_function("crop made", |b| b.iter(|| black_box(service.get(&fresh()))));
}

fn lookups(c: &mut Criterion) {
    let catalogue = ltc_tables::shipped().expect("shipped tables are sound");
    let service = Service::over(&catalogue);
    let table = catalogue.find(ANISOTROPIC).expect("it is shipped").table();
    let queries = draw::standard(BATCH, 5, false);
    let path = format!("/v1/tables/{ANISOTROPIC}/versions/latest/lookup");
    let mut group = c.benchmark_group("service");

    let [Query { theta, phi, alpha_x, alpha_y }, ..] = queries[..] else { unreachable!("there are queries") };
    let one = format!("{path}?theta={theta}&phi={phi}&alpha_x={alpha_x}&alpha_y={alpha_y}");
    let sent: Lookup = serde_json::from_slice(&service.get(&one)).expect("a lookup");
    let error = difference(&sent, &table.lookup(&queries[0]).expect("it answers"));
    println!("service/lookup: off by {error:.1e} at most");
    time(&mut group, &service, "lookup", &one);

    let body = Bytes::from(serde_json::to_vec(&queries).expect("JSON"));
    let json = || post(&path, "application/json", body.clone());
    let sent: Vec<Lookup> = serde_json::from_slice(&service.ask(json(), StatusCode::OK)).expect("lookups");
    let exact = queries.iter().map(|query| table.lookup(query).expect("it answers"));
    let error = sent.iter().zip(exact).map(|(sent, exact)| difference(sent, &exact)).fold(0.0, f64::max);
    assert_eq!(sent.len(), BATCH);
    println!("service/lookups in JSON: off by {error:.1e} at most");
    group.throughput(Throughput::Elements(BATCH as u64));
    group.bench_function("lookups in JSON", |b| b.iter(|| black_box(service.ask(json(), StatusCode::OK))));

    let numbers =
        queries.iter().flat_map(|q| [q.theta, q.phi, q.alpha_x, q.alpha_y]).flat_map(f64::to_le_bytes);
    let numbers = Bytes::from(numbers.collect::<Vec<u8>>());
    let binary = || post(&path, "application/vnd.ltc.queries.f64", numbers.clone());
    let answer = service.ask(binary(), StatusCode::OK);
    let magnitudes = answer
        .chunks_exact(8 * 12)
        .map(|lobe| f64::from_le_bytes(lobe[..8].try_into().expect("eight bytes")));
    let exact = queries.iter().map(|query| table.lookup(query).expect("it answers").magnitude);
    assert!(answer.len() == BATCH * 8 * 12 && magnitudes.eq(exact), "bit for bit");
    group.bench_function("lookups in numbers", |b| {
        b.iter(|| black_box(service.ask(binary(), StatusCode::OK)));
    });
}

fn post(path: &str, kind: &str, body: Bytes) -> Request<Body> {
    Request::post(path).header(header::CONTENT_TYPE, kind).body(Body::from(body)).expect("a request")
}

/// The largest difference of two answers; a fault where it is more than the last digits.
fn difference(a: &Lookup, b: &Lookup) -> f64 {
    let numbers = |lookup: &Lookup| {
        let lobes = lookup.lobes.iter().flat_map(|lobe| lobe.m.iter().copied().chain([lobe.weight]));
        lobes.chain([lookup.magnitude, lookup.fresnel]).collect::<Vec<f64>>()
    };
    let (a, b) = (numbers(a), numbers(b));
    assert_eq!(a.len(), b.len());
    let most = a.iter().zip(&b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(most < 1e-12, "{most}");
    most
}

criterion_group!(all, reads, lookups);
criterion_main!(all);
