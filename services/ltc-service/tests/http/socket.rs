//! Over real connections: what the router alone cannot show.

use std::net::SocketAddr;
use std::sync::Arc;
use std::time::{Duration, Instant};

use ltc_service::settings::Refits;
use ltc_service::{Limits, ServeError, Settings, Stop, serve_until};
use ltc_store::{Jobs, MemoryStore, NewJob};
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;
use tokio::sync::{oneshot, watch};
use tokio::task::JoinHandle;

use crate::support::*;

pub struct Server {
    address: SocketAddr,
    stop: watch::Sender<Stop>,
    task: JoinHandle<Result<(), ServeError>>,
}

impl Server {
    pub async fn start(config: Settings) -> Self {
        Self::over(config).await.0
    }

    /// The same, and its store.
    pub async fn over(config: Settings) -> (Self, Arc<MemoryStore>) {
        let (stop, stopped) = watch::channel(Stop::No);
        let (ready, address) = oneshot::channel();
        let config = Settings { listen: "127.0.0.1:0".to_owned(), ..config };
        let on_ready = move |address| ready.send(address).unwrap();
        let (state, store) = state_over(&catalogue(), config).await;
        let task = tokio::spawn(serve_until(state, on_ready, stopped));
        (Self { address: address.await.unwrap(), stop, task }, store)
    }

    pub async fn connect(&self) -> TcpStream {
        TcpStream::connect(self.address).await.unwrap()
    }

    /// What comes back for these bytes until the server closes.
    pub async fn exchange(&self, request: &[u8]) -> Vec<u8> {
        let mut stream = self.connect().await;
        stream.write_all(request).await.unwrap();
        rest(&mut stream).await
    }

    async fn ended(self) {
        tokio::time::timeout(Duration::from_secs(5), self.task).await.unwrap().unwrap().unwrap();
    }
}

async fn rest(stream: &mut TcpStream) -> Vec<u8> {
    let mut answer = Vec::new();
    let read = tokio::time::timeout(Duration::from_secs(5), stream.read_to_end(&mut answer)).await;
    // A reset after the answer is an end like another.
    let _ = read.expect("the server closes");
    answer
}

fn request(method: &str, path: &str, headers: &str) -> Vec<u8> {
    format!("{method} {path} HTTP/1.1\r\nhost: test\r\nconnection: close\r\n{headers}\r\n").into_bytes()
}

/// Head in lower case, and body.
fn parts(answer: &[u8]) -> (String, &[u8]) {
    let end = answer.windows(4).position(|w| w == b"\r\n\r\n").expect("a head") + 4;
    (String::from_utf8_lossy(&answer[..end]).to_lowercase(), &answer[end..])
}

#[tokio::test]
async fn a_body_that_would_be_too_large_is_not_waited_for() {
    let server = Server::start(Settings::default()).await;
    for path in [at(ANISO, "1", "/lookup"), "/v1/benchmarks".to_owned(), "/v1/tables/x/versions".to_owned()] {
        for expect in ["", "expect: 100-continue\r\n"] {
            let form = if path.ends_with("versions") {
                "multipart/form-data; boundary=x"
            } else {
                "application/json"
            };
            let headers = format!("content-length: 10000000000\r\ncontent-type: {form}\r\n{expect}");
            let answer = server.exchange(&request("POST", &path, &headers)).await;
            let (head, _) = parts(&answer);
            // Who may not write is told that before anything else.
            let status = if path.ends_with("lookup") { "413" } else { "401" };
            assert!(head.starts_with(&format!("http/1.1 {status}")), "{path} {expect}: {head}");
        }
    }
}

#[tokio::test]
async fn the_wire_has_what_the_router_said() {
    let server = Server::start(Settings::default()).await;
    let path = at(ISO, "1", "/data");
    let payload = catalogue().version(ISO, "1").unwrap().payload().to_vec();

    let answer = server.exchange(&request("GET", &path, "")).await;
    let (head, body) = parts(&answer);
    assert!(head.starts_with("http/1.1 200 ok\r\n"), "{head}");
    assert!(head.contains(&format!("content-length: {}\r\n", payload.len())), "{head}");
    assert_eq!(body, payload);

    let answer = server.exchange(&request("HEAD", &path, "")).await;
    let (head, body) = parts(&answer);
    assert!(head.contains(&format!("content-length: {}\r\n", payload.len())), "{head}");
    assert!(body.is_empty());

    let answer = server.exchange(&request("GET", &path, "if-none-match: *\r\n")).await;
    let (head, body) = parts(&answer);
    assert!(head.starts_with("http/1.1 304 not modified\r\n"), "{head}");
    assert!(!head.contains("content-length"), "{head}");
    assert!(!head.contains("content-length: 0"), "a length would be the table's: {head}");
    assert!(body.is_empty());

    let answer = server.exchange(&request("GET", &path, "range: bytes=-5\r\n")).await;
    let (head, body) = parts(&answer);
    assert!(head.starts_with("http/1.1 206 partial content\r\n"), "{head}");
    assert_eq!(body, &payload[payload.len() - 5..]);
}

#[tokio::test]
async fn what_is_no_http_is_told_so() {
    let server = Server::start(Settings::default()).await;
    let long = format!("GET / HTTP/1.1\r\nhost: a\r\na: {}\r\n\r\n", "b".repeat(100 << 10)).into_bytes();
    for (bytes, status) in [
        (&b"GET / HTTP/1.1\r\nho st: a\r\n\r\n"[..], "400"),
        (b"G\0T / HTTP/1.1\r\nhost: a\r\n\r\n", "400"),
        (b"GET /a b HTTP/1.1\r\nhost: a\r\n\r\n", "400"),
        // The beginning of TLS.
        (b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03\r\n", "400"),
        (b"POST /v1/benchmarks HTTP/1.1\r\nhost: a\r\ncontent-length: 5x\r\n\r\n{", "400"),
        (&long, "431"),
    ] {
        let answer = server.exchange(bytes).await;
        let answer = String::from_utf8_lossy(&answer);
        assert!(answer.starts_with(&format!("HTTP/1.1 {status} ")), "{answer:?}");
    }
}

#[tokio::test]
async fn a_connection_is_used_again_after_errors() {
    let server = Server::start(Settings::default()).await;
    let mut stream = server.connect().await;
    let lookup = at(ANISO, "1", "/lookup");
    for (head, status) in [
        ("GET /nowhere", "404"),
        (&*format!("GET {lookup}?theta=NaN&alpha_x=0&alpha_y=0"), "422"),
        ("PUT /v1/tables", "405"),
        ("GET /healthz", "200"),
    ] {
        stream.write_all(format!("{head} HTTP/1.1\r\nhost: test\r\n\r\n").as_bytes()).await.unwrap();
        let mut buffer = vec![0; 4096];
        let n = stream.read(&mut buffer).await.unwrap();
        assert!(String::from_utf8_lossy(&buffer[..n]).starts_with(&format!("HTTP/1.1 {status}")), "{head}");
    }
}

#[tokio::test]
async fn a_large_body_is_refused_over_the_wire() {
    let server = Server::start(Settings::default()).await;
    let headers = "content-type: application/json\r\ncontent-length: 2200000\r\n";
    let mut sent = request("POST", &at(ANISO, "1", "/lookup"), headers);
    sent.extend(std::iter::repeat_n(b' ', 2_200_000));
    let answer = server.exchange(&sent).await;
    let (head, body) = parts(&answer);
    assert!(head.starts_with("http/1.1 413"), "{head}");
    assert!(String::from_utf8_lossy(body).contains("urn:ltc:problem:body-too-large"));
}

#[tokio::test]
async fn what_is_no_http_ends_the_connection_and_nothing_else() {
    let server = Server::start(Settings::default()).await;
    let long = format!("GET /{} HTTP/1.1\r\n\r\n", "a".repeat(200_000));
    for junk in
        [&b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03"[..], b"GET / HTTP/9.9\r\n\r\n", long.as_bytes()]
    {
        let mut stream = server.connect().await;
        // The server may close before it has read everything.
        let _ = stream.write_all(junk).await;
        let answer = rest(&mut stream).await;
        assert!(
            answer.is_empty() || answer.starts_with(b"HTTP/1.1 4"),
            "{:?}",
            &answer[..40.min(answer.len())]
        );
    }
    let answer = server.exchange(&request("GET", "/healthz", "")).await;
    assert!(answer.starts_with(b"HTTP/1.1 200"));
}

#[tokio::test]
async fn headers_that_do_not_come_are_not_waited_for() {
    let limits = Limits { header_seconds: 0.1, ..Limits::default() };
    let server = Server::start(Settings { limits, ..Settings::default() }).await;
    let start = Instant::now();
    server.exchange(b"GET / HTTP/1.1\r\nhost: te").await;
    assert!(start.elapsed() < Duration::from_secs(3));
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn many_clients_at_once_get_what_they_asked_for() {
    let server = Server::start(Settings::default()).await;
    let expected: Vec<Vec<u8>> =
        ["1", "2", "10"].map(|v| catalogue().version(ISO, v).unwrap().payload().to_vec()).into();
    let clients = (0..50).map(|i| {
        let (address, expected) = (server.address, expected.clone());
        tokio::spawn(async move {
            for j in 0..20 {
                let which = (i + j) % 3;
                let path = at(ISO, ["1", "2", "10"][which], "/data");
                let mut stream = TcpStream::connect(address).await.unwrap();
                stream.write_all(&request("GET", &path, "")).await.unwrap();
                assert_eq!(parts(&rest(&mut stream).await).1, expected[which]);
            }
        })
    });
    for client in clients.collect::<Vec<_>>() {
        client.await.unwrap();
    }
}

/// Sends the head and half the body of a batch and waits until the server has taken it up.
async fn half_a_request(server: &Server) -> TcpStream {
    let mut stream = server.connect().await;
    let headers = "content-type: application/json\r\ncontent-length: 2\r\nexpect: 100-continue\r\n";
    stream.write_all(&request("POST", &at(ANISO, "1", "/lookup"), headers)).await.unwrap();
    let mut buffer = [0; 64];
    let n = stream.read(&mut buffer).await.unwrap();
    assert!(buffer[..n].starts_with(b"HTTP/1.1 100"), "the handler reads the body");
    stream.write_all(b"[").await.unwrap();
    stream
}

#[tokio::test]
async fn stopping_finishes_what_is_under_way() {
    let server = Server::start(Settings::default()).await;
    let idle = server.connect().await;
    let mut busy = half_a_request(&server).await;
    server.stop.send(Stop::Drain).unwrap();
    tokio::time::sleep(Duration::from_millis(100)).await;
    assert!(!server.task.is_finished(), "a request is under way");
    assert!(TcpStream::connect(server.address).await.is_err(), "no new connections");
    busy.write_all(b"]").await.unwrap();
    let answer = rest(&mut busy).await;
    assert!(answer.starts_with(b"HTTP/1.1 200") && answer.ends_with(b"\r\n\r\n[]"));
    server.ended().await;
    drop(idle);
}

#[tokio::test]
async fn stopping_does_not_wait_for_ever() {
    let config = Settings { drain_seconds: 0.1, ..Settings::default() };
    let server = Server::start(config).await;
    let mut busy = half_a_request(&server).await;
    server.stop.send(Stop::Drain).unwrap();
    server.ended().await;
    assert!(rest(&mut busy).await.is_empty(), "dropped");
}

#[tokio::test]
async fn stopping_ends_event_streams_in_good_order() {
    let refits = Refits { workers: 0, ..Refits::default() };
    let settings =
        Settings { listen: "127.0.0.1:0".to_owned(), drain_seconds: 600.0, refits, ..Settings::default() };
    let (state, store) = state_over(&catalogue(), settings).await;
    let job = NewJob {
        table: ISO.to_owned(),
        spec: serde_json::json!({}),
        spec_digest: "sha256:0".to_owned(),
        priority: 0,
        alias: None,
        idempotency: None,
    };
    let (job, _) = store.enqueue(job, 10).await.unwrap();
    let (stop, stopped) = watch::channel(Stop::No);
    let (ready, address) = oneshot::channel();
    let task = tokio::spawn(serve_until(state, move |address| ready.send(address).unwrap(), stopped));
    let server = Server { address: address.await.unwrap(), stop, task };
    let mut stream = server.connect().await;
    stream.write_all(&request("GET", &format!("/v1/refits/{}/events", job.id), "")).await.unwrap();
    let mut seen = Vec::new();
    while !seen.windows(6).any(|w| w == b"queued") {
        assert_ne!(stream.read_buf(&mut seen).await.unwrap(), 0, "{}", String::from_utf8_lossy(&seen));
    }
    server.stop.send(Stop::Drain).unwrap();
    // The last chunk says that the stream is whole.
    assert!(rest(&mut stream).await.ends_with(b"0\r\n\r\n"));
    server.ended().await;
}

#[tokio::test]
async fn a_second_signal_ends_the_waiting() {
    let config = Settings { drain_seconds: 600.0, ..Settings::default() };
    let server = Server::start(config).await;
    let _busy = half_a_request(&server).await;
    server.stop.send(Stop::Drain).unwrap();
    tokio::time::sleep(Duration::from_millis(50)).await;
    assert!(!server.task.is_finished());
    server.stop.send(Stop::Now).unwrap();
    server.ended().await;
}

#[tokio::test]
async fn a_dropped_sender_stops_gracefully() {
    let Server { stop, task, .. } = Server::start(Settings::default()).await;
    drop(stop);
    tokio::time::timeout(Duration::from_secs(5), task).await.unwrap().unwrap().unwrap();
}

#[tokio::test]
async fn an_address_that_cannot_be_had_is_one_clear_line() {
    let server = Server::start(Settings::default()).await;
    for (listen, needle) in [
        (server.address.to_string(), "the address is in use"),
        ("no port".to_owned(), "no port"),
        ("192.0.2.1:0".to_owned(), "does not have that address"),
        ("127.0.0.1:99999".to_owned(), "127.0.0.1:99999"),
    ] {
        let config = Settings { listen: listen.clone(), ..Settings::default() };
        let (_sender, stop) = watch::channel(Stop::No);
        let on_ready = |_| panic!("it is not ready");
        let error = serve_until(state_over(&catalogue(), config).await.0, on_ready, stop).await.unwrap_err();
        let line = error.to_string();
        assert!(line.starts_with(&format!("cannot listen on {listen}: ")), "{line}");
        assert!(line.contains(needle) && !line.contains('\n'), "{line}");
    }
}
