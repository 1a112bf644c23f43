//! Tables to serve, and questions with the checks that every answer must pass.

use std::f64::consts::FRAC_PI_2;

use axum::Router;
use axum::body::{Body, Bytes};
use axum::http::{HeaderMap, Method, Request, StatusCode};
use glam::DMat3;
use http_body_util::BodyExt;
use std::sync::Arc;

use ltc_service::{AppState, Limits, Settings, Stores, app};
use ltc_store::{MemoryStore, Metadata, Scope, Secret};
use ltc_table::{
    Axis, BrdfInfo, Catalogue, CellStats, DrawErrors, Errors, Floors, Manifest, Mapping, Quantity, Table,
    TableVersion, digest::digest,
};
use serde_json::{Value, json};
use tower::ServiceExt;

/// A smooth table whose entries all differ; `scale` makes one table another.
pub fn table(axes: Vec<Axis>, scale: f64) -> Table {
    let n: usize = axes.iter().map(|a| a.len).product();
    let entry = |i: usize| {
        let t = i as f64 / n as f64;
        DMat3::from_cols_array(&[
            scale + t,
            0.1 * t,
            -0.3 * t,
            -0.1,
            0.4 + t * t,
            0.2 * t,
            0.25 - 0.5 * t,
            0.1,
            1.0,
        ])
    };
    let channel = |end: f64| (0..n).map(|i| scale * end * (1.0 - 0.5 * i as f64 / n as f64)).collect();
    let cells = CellStats { tv: channel(0.2), leak: channel(0.01), condition: channel(30.0) };
    Table::new(axes, (0..n).map(entry).collect(), channel(1.0), channel(0.1), cells).unwrap()
}

pub fn isotropic() -> Vec<Axis> {
    vec![
        Axis::full(Quantity::Theta, Mapping::SqrtOneMinusCos, 6),
        Axis::full(Quantity::Alpha, Mapping::Sqrt, 7),
    ]
}

pub fn anisotropic() -> Vec<Axis> {
    vec![
        Axis::full(Quantity::Theta, Mapping::Linear, 4),
        Axis { quantity: Quantity::Phi, mapping: Mapping::Linear, domain: [0.0, FRAC_PI_2], len: 3 },
        Axis::full(Quantity::Alpha, Mapping::Linear, 5),
        Axis::full(Quantity::Lambda, Mapping::Linear, 3),
    ]
}

/// A version of a table with a made-up manifest.
pub fn version(name: &str, number: u32, table: &Table) -> TableVersion {
    let payload = TableVersion::payload_of(table).unwrap();
    let manifest = Manifest {
        name: name.to_owned(),
        version: number,
        digest: digest(&payload),
        payload_bytes: payload.len() as u64,
        axes: table.axes().to_vec(),
        channels: Vec::new(),
        lobes: 1,
        normalisation: "m33 = 1".to_owned(),
        handedness: "right".to_owned(),
        floors: Floors { alpha: 1e-4, lambda: 0.01, theta_max: 1.5 },
        brdf: BrdfInfo { name: "made-up <b>&\"'".to_owned(), parameters: json!({}) },
        fit: json!({"seed": 1}),
        errors: errors(),
        created: "2026-01-01T00:00:00Z".to_owned(),
        tool: "test".to_owned(),
        licence: "CC0-1.0".to_owned(),
    };
    TableVersion::new(manifest, payload).unwrap()
}

fn errors() -> Errors {
    Errors {
        standard_draw: DrawErrors {
            draw: "isotropic".to_owned(),
            tv_mean: 0.125,
            tv_median: 0.1,
            tv_p95: 0.2,
            tv_max: 0.3,
            tv_mean_alpha_below_0_14: 0.1,
            tv_mean_alpha_from_0_14: 0.1,
            queries: 1,
            samples: 1,
            seed: 1,
        },
        leak_max: 0.0,
        leak_mean: 0.0,
        condition_max: 1.0,
        cell_tv_mean: 0.0,
        cell_tv_max: 0.0,
        magnitude_mean: 0.0,
        magnitude_max: 0.0,
        fresnel_mean: 0.0,
        fresnel_max: 0.0,
        grid: None,
    }
}

pub const ISO: &str = "ggx-isotropic";
pub const ANISO: &str = "ggx-anisotropic";

/// `ggx-isotropic` in versions 1, 2 and 10; `ggx-anisotropic` in version 1.
pub fn catalogue() -> Catalogue {
    let mut catalogue = Catalogue::default();
    for (number, scale) in [(1, 0.5), (2, 0.6), (10, 0.7)] {
        catalogue.insert(version(ISO, number, &table(isotropic(), scale)));
    }
    catalogue.insert(version(ANISO, 1, &table(anisotropic(), 0.5)));
    catalogue
}

pub async fn service() -> Router {
    service_with(Limits::default()).await
}

pub async fn service_with(limits: Limits) -> Router {
    service_over(&catalogue(), Settings { limits, ..Settings::default() }).await.0
}

/// A service over a store in memory with these tables, and the store.
pub async fn service_over(catalogue: &Catalogue, settings: Settings) -> (Router, Arc<MemoryStore>) {
    let (state, store) = state_over(catalogue, settings).await;
    (app(state), store)
}

pub async fn state_over(catalogue: &Catalogue, settings: Settings) -> (AppState, Arc<MemoryStore>) {
    let store = Arc::new(MemoryStore::default());
    ltc_store::seed(&*store, &*store, catalogue, &|_| None).await.unwrap();
    let stores = Stores::of(Arc::clone(&store));
    (AppState::new(stores, settings).await.unwrap(), store)
}

pub fn digest_of(name: &str, version: &str) -> String {
    catalogue().version(name, version).unwrap().manifest().digest.clone()
}

/// The path of something of a version.
pub fn at(name: &str, version: &str, rest: &str) -> String {
    format!("/v1/tables/{name}/versions/{version}{rest}")
}

#[derive(Debug)]
pub struct Answer {
    pub status: StatusCode,
    pub headers: HeaderMap,
    pub body: Bytes,
}

impl Answer {
    pub fn header(&self, name: &str) -> &str {
        self.headers.get(name).unwrap_or_else(|| panic!("no {name}: {:?}", self.headers)).to_str().unwrap()
    }

    pub fn json(&self) -> Value {
        serde_json::from_slice(&self.body).unwrap_or_else(|e| panic!("{e}: {:?}", self.body))
    }

    pub fn field(&self) -> String {
        self.json()["field"].as_str().unwrap_or_default().to_owned()
    }
}

/// Asks the router, and checks what holds for every answer.
pub async fn ask(app: &Router, request: Request<Body>) -> Answer {
    let (method, path) = (request.method().clone(), request.uri().path().to_owned());
    let (parts, body) = app.clone().oneshot(request).await.unwrap().into_parts();
    let body = body.collect().await.unwrap().to_bytes();
    let answer = Answer { status: parts.status, headers: parts.headers, body };
    // A 304 has only what is asked of it; the answer that the client has says the rest.
    if answer.status != StatusCode::NOT_MODIFIED {
        assert_eq!(answer.header("x-content-type-options"), "nosniff");
        assert!(answer.header("access-control-expose-headers").contains("x-table-digest"));
    }
    assert_eq!(answer.header("access-control-allow-origin"), "*");
    assert!(!answer.header("x-request-id").is_empty());
    if method == Method::HEAD {
        assert!(answer.body.is_empty());
    }
    if answer.status.as_u16() >= 400 {
        assert_eq!(answer.header("content-type"), "application/problem+json");
        assert_eq!(answer.header("cache-control"), "no-store");
        if method != Method::HEAD {
            check_problem(&answer, &path);
        }
    }
    answer
}

fn check_problem(answer: &Answer, path: &str) {
    let problem = answer.json();
    assert!(problem["type"].as_str().unwrap().starts_with("urn:ltc:problem:"), "{problem}");
    for text in ["title", "detail"] {
        let text = problem[text].as_str().unwrap();
        assert!(!text.is_empty() && !text.contains('\n'), "one line: {text:?}");
    }
    assert_eq!(problem["status"], answer.status.as_u16());
    assert_eq!(problem["instance"], path);
    assert_eq!(problem["request_id"], answer.header("x-request-id"));
}

pub async fn ask_with(app: &Router, method: Method, path: &str, headers: &[(&str, &str)]) -> Answer {
    let mut request = Request::builder().method(method).uri(path);
    for (name, value) in headers {
        request = request.header(*name, *value);
    }
    ask(app, request.body(Body::empty()).unwrap()).await
}

pub async fn get_with(app: &Router, path: &str, headers: &[(&str, &str)]) -> Answer {
    ask_with(app, Method::GET, path, headers).await
}

pub async fn get(app: &Router, path: &str) -> Answer {
    get_with(app, path, &[]).await
}

pub async fn post(app: &Router, path: &str, body: impl Into<Body>) -> Answer {
    let request = Request::post(path).header("content-type", "application/json").body(body.into());
    ask(app, request.unwrap()).await
}

/// A new token with these scopes, as an `Authorization` header.
pub async fn token(store: &MemoryStore, scopes: &[Scope]) -> String {
    let (token, secret) = Secret::generate("test", scopes.iter().copied().collect(), None).unwrap();
    store.add_token(token).await.unwrap();
    format!("Bearer {}", secret.reveal())
}

/// A request with headers and a body.
pub async fn send(
    app: &Router,
    method: &str,
    path: &str,
    headers: &[(&str, &str)],
    body: impl Into<Body>,
) -> Answer {
    let mut request = Request::builder().method(method).uri(path);
    for (name, value) in headers {
        request = request.header(*name, *value);
    }
    ask(app, request.body(body.into()).unwrap()).await
}

pub const JSON: (&str, &str) = ("content-type", "application/json");

/// A service with its store and a token for everything.
pub struct Service {
    pub app: Router,
    pub store: Arc<MemoryStore>,
    pub token: String,
}

impl Service {
    pub async fn new() -> Self {
        Self::with(Settings::default()).await
    }

    pub async fn with(settings: Settings) -> Self {
        let (state, store) = state_over(&catalogue(), settings).await;
        let token = token(&store, &Scope::ALL).await;
        Self { app: app(state), store, token }
    }

    /// A request in JSON with the token.
    pub async fn write(&self, method: &str, path: &str, headers: &[(&str, &str)], body: &Value) -> Answer {
        let mut all = vec![JSON, ("authorization", &self.token)];
        all.extend(headers);
        send(&self.app, method, path, &all, body.to_string()).await
    }
}
