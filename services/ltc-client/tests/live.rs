//! The client against a service in the same process.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use std::io::{Read, Write};
use std::net::{SocketAddr, TcpListener};
use std::sync::Arc;

use ltc_client::{Client, ClientError, Data, Query, RefitRequest};
use ltc_service::settings::Refits;
use ltc_service::{AppState, Settings, Stop, Stores, serve_until};
use ltc_store::{MemoryStore, Metadata, Scope, Secret};
use tokio::runtime::Runtime;
use tokio::sync::{oneshot, watch};

const TABLE: &str = "ggx-isotropic";

struct Service {
    runtime: Option<Runtime>,
    address: SocketAddr,
    token: String,
    stop: watch::Sender<Stop>,
}

impl Service {
    fn start() -> Self {
        let runtime = Runtime::new().unwrap();
        let (stop, stopped) = watch::channel(Stop::No);
        let (ready, address) = oneshot::channel();
        let token = runtime.block_on(async {
            let store = Arc::new(MemoryStore::default());
            let (token, secret) = Secret::generate("test", Scope::ALL.into_iter().collect(), None).unwrap();
            store.add_token(token).await.unwrap();
            ltc_store::seed(&*store, &*store, &ltc_tables::shipped().unwrap(), &|_| None).await.unwrap();
            let refits = Refits { workers: 0, ..Refits::default() };
            let settings = Settings { listen: "127.0.0.1:0".to_owned(), refits, ..Settings::default() };
            let state = AppState::new(Stores::of(store), settings).await.unwrap();
            tokio::spawn(serve_until(state, move |address| ready.send(address).unwrap(), stopped));
            secret.reveal().to_owned()
        });
        let address = runtime.block_on(address).unwrap();
        Self { runtime: Some(runtime), address, token, stop }
    }

    fn client(&self) -> Client {
        Client::new(&format!("http://{}/", self.address))
    }

    fn end(mut self) {
        self.stop.send_replace(Stop::Now);
        self.runtime.take().unwrap().shutdown_background();
    }
}

#[test]
fn tables_come_verified() {
    let service = Service::start();
    let client = service.client();
    let shipped = ltc_tables::shipped().unwrap();
    let listed = client.tables().unwrap();
    let summary = listed.iter().find(|t| t.name == TABLE).unwrap();
    let expected = shipped.version(TABLE, "latest").unwrap();
    assert_eq!((summary.latest, &summary.digest), (expected.manifest().version, &expected.manifest().digest));
    let digest = expected.manifest().digest.clone();
    for version in ["latest", "stable", &summary.latest.to_string(), &digest] {
        let table = client.table(TABLE, version).unwrap();
        assert_eq!(table.payload(), expected.payload(), "{version}");
        assert_eq!(table.manifest(), expected.manifest());
    }
    let data = Data { format: "npz", precision: "f32", channels: "m", crop: &[("alpha", [0.2, 0.5])] };
    let part = client.data(TABLE, "latest", &data).unwrap();
    assert!(part.len() < expected.payload().len() / 2);
    let queries = [
        Query { theta: 0.5, phi: 0.0, alpha_x: 0.3, alpha_y: 0.3 },
        Query { theta: 0.5, phi: 0.0, alpha_x: 0.3, alpha_y: 0.2 },
    ];
    let answers = client.lookup(TABLE, "latest", &queries).unwrap();
    assert_eq!(answers[0].as_ref().unwrap(), &expected.table().lookup(&queries[0]).unwrap());
    assert!(answers[1].as_ref().unwrap_err().contains("isotropic"));
    service.end();
}

#[test]
fn what_is_refused_says_why() {
    let service = Service::start();
    let client = service.client();
    let refused = client.table(TABLE, "none").unwrap_err();
    assert!(
        matches!(&refused, ClientError::Refused { status: 404, kind, .. } if kind == "urn:ltc:problem:no-such-version"),
        "{refused}"
    );
    for (name, version) in
        [("../tables", "1"), ("a/b", "1"), (TABLE, "1/data"), (TABLE, ""), (TABLE, "1?x=1")]
    {
        assert!(matches!(client.table(name, version), Err(ClientError::BadName(_))), "{name} {version}");
    }
    let request = RefitRequest { preset: Some("ggx-isotropic".to_owned()), ..RefitRequest::default() };
    assert!(matches!(client.refit(&request, None), Err(ClientError::Refused { status: 401, .. })));
    let writer = service.client().with_token(&service.token);
    let refit = writer.refit(&request, Some("one")).unwrap();
    assert_eq!(writer.refit(&request, Some("one")).unwrap().id, refit.id);
    assert_eq!(client.refit_state(&refit.id).unwrap().table, TABLE);
    assert!(!format!("{writer:?}").contains(&service.token), "a secret is not for logs");
    service.end();
}

#[test]
fn a_cached_digest_needs_no_network() {
    let folder = tempfile::tempdir().unwrap();
    let service = Service::start();
    let client = service.client().with_cache(folder.path());
    let version = client.table(TABLE, "latest").unwrap();
    let digest = version.manifest().digest.clone();
    service.end();
    let offline = Client::new("http://127.0.0.1:9").with_cache(folder.path());
    assert_eq!(offline.table(TABLE, &digest).unwrap().payload(), version.payload());
    assert!(
        matches!(offline.table(TABLE, "latest"), Err(ClientError::Network { .. })),
        "an alias may have moved"
    );
    assert!(
        matches!(offline.table("ggx-anisotropic", &digest), Err(ClientError::Network { .. })),
        "of another table"
    );
    // A damaged file is not used.
    let file = folder.path().join(format!("{}.npz", digest.trim_start_matches("sha256:")));
    let mut bytes = std::fs::read(&file).unwrap();
    bytes[1000] ^= 1;
    std::fs::write(&file, bytes).unwrap();
    assert!(matches!(offline.table(TABLE, &digest), Err(ClientError::Network { .. })));
    // It is fetched again and mended.
    let service = Service::start();
    service.client().with_cache(folder.path()).table(TABLE, &digest).unwrap();
    service.end();
    assert!(offline.table(TABLE, &digest).is_ok());
    let names: Vec<_> = std::fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
    assert_eq!(names.len(), 2, "nothing half written lies about: {names:?}");
}

/// A server that gives the right manifest and a payload of its own.
fn liar(manifest: String, payload: Vec<u8>) -> SocketAddr {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    std::thread::spawn(move || {
        for stream in listener.incoming() {
            let mut stream = stream.unwrap();
            let mut request = [0; 4096];
            let n = stream.read(&mut request).unwrap();
            let data = String::from_utf8_lossy(&request[..n]).contains("/data");
            let body = if data { &payload[..] } else { manifest.as_bytes() };
            let head =
                format!("HTTP/1.1 200 OK\r\nconnection: close\r\ncontent-length: {}\r\n\r\n", body.len());
            stream.write_all(head.as_bytes()).and_then(|()| stream.write_all(body)).unwrap();
        }
    });
    address
}

#[test]
fn a_payload_of_another_digest_is_refused() {
    let shipped = ltc_tables::shipped().unwrap();
    let version = shipped.version(TABLE, "latest").unwrap();
    let mut payload = version.payload().to_vec();
    payload[5000] ^= 1;
    let folder = tempfile::tempdir().unwrap();
    let address = liar(version.manifest_json().unwrap(), payload);
    let client = Client::new(&format!("http://{address}")).with_cache(folder.path());
    assert!(matches!(client.table(TABLE, "latest"), Err(ClientError::NotGenuine { .. })));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0, "and not kept");
    let other = format!("sha256:{}", "0".repeat(64));
    assert!(matches!(client.manifest(TABLE, &other), Err(ClientError::NotGenuine { .. })));
    // The control: the right bytes pass.
    let honest = liar(version.manifest_json().unwrap(), version.payload().to_vec());
    Client::new(&format!("http://{honest}")).table(TABLE, "latest").unwrap();
}
