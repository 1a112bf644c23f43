//! An answer that is given again, from memory, is the one that would have been made anew.

use ltc_service::settings::Access;
use ltc_service::{Limits, Settings};
use ltc_store::Scope;
use tokio::io::{AsyncReadExt, AsyncWriteExt};

use crate::socket::Server;
use crate::support::*;

/// What comes back over a connection, as lines of the head in order of the alphabet, and the body. The time of day is left out: it may
/// change between two answers.
#[derive(Debug, PartialEq)]
struct Received {
    head: Vec<String>,
    body: Vec<u8>,
}

impl Received {
    fn of(answer: &[u8]) -> Self {
        let end = answer.windows(4).position(|w| w == b"\r\n\r\n").expect("a head");
        let head = String::from_utf8(answer[..end].to_vec()).unwrap();
        let (status, headers) = head.split_once("\r\n").unwrap();
        let mut head: Vec<_> =
            headers.split("\r\n").filter(|line| !line.starts_with("date: ")).map(str::to_owned).collect();
        head.sort();
        head.insert(0, status.to_owned());
        Self { head, body: answer[end + 4..].to_vec() }
    }

    fn status(&self) -> &str {
        self.head[0].split(' ').nth(1).unwrap()
    }
}

/// A server that keeps answers, and one that has no room for any.
struct Pair {
    keeps: Server,
    forgets: Server,
}

impl Pair {
    async fn start(read: Access, limits: Limits) -> (Self, String) {
        let settings = Settings { read, limits, ..Settings::default() };
        let nothing = Limits { cache_bytes: 0, ..settings.limits.clone() };
        let (keeps, store) = Server::over(settings.clone()).await;
        let (forgets, other) = Server::over(Settings { limits: nothing, ..settings }).await;
        let reader = token(&store, &[Scope::Read]).await;
        for known in ltc_store::Metadata::tokens(&*store).await.unwrap() {
            ltc_store::Metadata::add_token(&*other, known).await.unwrap();
        }
        (Self { keeps, forgets }, reader)
    }

    /// What both say, the first having been asked twice: the same, or this panics.
    async fn agree(&self, request: &str) -> Received {
        let bytes = request.as_bytes();
        let anew = Received::of(&self.forgets.exchange(bytes).await);
        for _ in 0..2 {
            assert_eq!(Received::of(&self.keeps.exchange(bytes).await), anew, "{request}");
        }
        anew
    }
}

async fn hits(server: &Server) -> u64 {
    let answer = server.exchange(&line("GET", "/metrics", "1.1", "")).await;
    let text = String::from_utf8(answer).unwrap();
    let line = text.lines().find(|line| line.starts_with("ltc_answer_cache_hits_total ")).unwrap();
    line.rsplit_once(' ').unwrap().1.parse().unwrap()
}

fn line(method: &str, path: &str, http: &str, headers: &str) -> Vec<u8> {
    format!(
        "{method} {path} HTTP/{http}\r\nhost: a\r\nconnection: close\r\nx-request-id: same\r\n{headers}\r\n"
    )
    .into_bytes()
}

fn question(method: &str, path: &str, http: &str, headers: &str) -> String {
    String::from_utf8(line(method, path, http, headers)).unwrap()
}

/// Headers that matter to whether and how something is sent, with the statuses of GET for it as it is and compressed.
fn conditions(tag: &str) -> Vec<(String, &'static str)> {
    let of = |text: &str, status| (text.replace("TAG", tag).replace('|', "\r\n"), status);
    vec![
        of("", "200"),
        of("if-none-match: \"TAG\"|", "304"),
        of("If-None-Match:\"TAG\"  |", "304"),
        of("if-none-match: W/\"TAG\"|", "304"),
        of("if-none-match: *|", "304"),
        of("if-none-match: \"a\", \"TAG\"|", "304"),
        of("if-none-match: \"a\"|if-none-match: \"TAG\"|", "304"),
        of("if-none-match: \"TAG\"|if-none-match: \"a\"|", "304"),
        of("if-none-match: TAG|", "200"),
        of("if-none-match: \"a\"|", "200"),
        of("if-none-match: \"tag\"|", "200"),
        of("if-none-match:|", "200"),
        of("if-modified-since: Fri, 01 Jan 2100 00:00:00 GMT|", "200"),
        of("if-none-match: \"a\"|if-modified-since: Fri, 01 Jan 2100 00:00:00 GMT|", "200"),
        of("if-none-match: \"TAG\"|if-modified-since: Thu, 01 Jan 1970 00:00:00 GMT|", "304"),
        of("if-match: \"TAG\"|", "200"),
        of("if-match: \"a\"|", "412"),
        of("if-match: \"TAG\"|if-none-match: \"TAG\"|", "304"),
        of("if-match: \"a\"|if-none-match: \"TAG\"|", "412"),
        of("range: bytes=0-9|", "206"),
        of("range: bytes=9999999-|", "416"),
        of("range: bytes=0-9|if-none-match: \"TAG\"|", "304"),
        of("range: bytes=0-9|if-none-match: \"a\"|", "206"),
        of("range: bytes=0-9|if-range: \"TAG\"|", "206"),
        of("range: bytes=0-9|if-range: \"a\"|", "200"),
        of("if-range: \"TAG\"|", "200"),
        of("authorization: Bearer none|if-none-match: \"TAG\"|", "401"),
        of("content-length: 2|if-none-match: \"TAG\"||{}", "304"),
        of("content-length: x|if-none-match: \"TAG\"|", "400"),
    ]
}

/// The same with a token that may read, if there is none.
fn with_token(headers: &str, token: &str) -> String {
    if headers.contains("authorization") {
        headers.to_owned()
    } else {
        format!("authorization: {token}\r\n{headers}")
    }
}

async fn all_agree(pair: &Pair, token: Option<&str>) -> usize {
    let paths = [
        at(ISO, &digest_of(ISO, "2"), "/data"),
        at(ISO, "1", "/data?format=json"),
        at(ISO, "latest", "/data?precision=f32"),
        "/v1/tables".to_owned(),
    ];
    let mut asked = 0;
    for path in &paths {
        for encoding in ["", "accept-encoding: gzip\r\n", "accept-encoding: gzip;q=0, *\r\n"] {
            let authorized = |headers: &str| token.map_or(headers.to_owned(), |t| with_token(headers, t));
            let first = pair.agree(&question("GET", path, "1.1", &authorized(encoding))).await;
            let tag = first.head.iter().find_map(|line| line.strip_prefix("etag: ")).unwrap();
            for (headers, status) in conditions(tag.trim_matches('"')) {
                let headers = authorized(&format!("{encoding}{headers}"));
                for (method, http) in [("GET", "1.1"), ("HEAD", "1.1"), ("GET", "1.0"), ("OPTIONS", "1.1")] {
                    let answer = pair.agree(&question(method, path, http, &headers)).await;
                    let ranged = headers.contains("range: ");
                    if method == "GET" && !(ranged && encoding.contains("gzip\r")) {
                        assert_eq!(answer.status(), status, "{path} {headers}");
                    }
                    asked += 1;
                }
            }
        }
    }
    asked
}

#[tokio::test]
async fn what_is_kept_is_what_would_be_made() {
    let (pair, _) = Pair::start(Access::Open, Limits { writes_per_second: 0, ..Limits::default() }).await;
    let asked = all_agree(&pair, None).await;
    let (kept, made) = (hits(&pair.keeps).await, hits(&pair.forgets).await);
    assert!(kept > asked as u64 / 4, "{kept} of {asked} were answered from memory");
    assert_eq!(made, 0);
}

#[tokio::test]
async fn nor_does_it_get_round_tokens() {
    let (pair, reader) =
        Pair::start(Access::Token, Limits { writes_per_second: 0, ..Limits::default() }).await;
    all_agree(&pair, Some(&reader)).await;
    assert!(hits(&pair.keeps).await > 0);
    let path = at(ISO, &digest_of(ISO, "2"), "/data");
    for headers in ["", "if-none-match: *\r\n", "authorization: Bearer none\r\n"] {
        assert_eq!(pair.agree(&question("GET", &path, "1.1", headers)).await.status(), "401");
    }
}

#[tokio::test]
async fn nor_round_rates() {
    let (pair, _) = Pair::start(Access::Open, Limits { reads_per_second: 3, ..Limits::default() }).await;
    let request = line("GET", &at(ISO, "1", "/data"), "1.1", "if-none-match: *\r\n");
    let exact = format!("if-none-match: \"{}\"\r\n", digest_of(ISO, "1"));
    let exact = line("GET", &at(ISO, "1", "/data"), "1.1", &exact);
    pair.keeps.exchange(&request).await;
    let mut statuses = Vec::new();
    for _ in 0..6 {
        statuses.push(Received::of(&pair.keeps.exchange(&exact).await).status().to_owned());
    }
    assert_eq!(statuses[..2], ["304", "304"]);
    assert!(statuses.contains(&"429".to_owned()), "{statuses:?}");
}

/// The comparison sees what it is there to see.
#[tokio::test]
async fn answers_that_differ_are_told_apart() {
    let server = Server::start(Settings::default()).await;
    let path = at(ISO, "1", "/data");
    let received =
        async |headers: &str| Received::of(&server.exchange(&line("GET", &path, "1.1", headers)).await);
    let known = received("if-none-match: *\r\n").await;
    assert_eq!(received("if-none-match: *\r\n").await, known);
    assert_ne!(received("").await, known, "200 and 304");
    let head = |text: &str| Received::of(format!("HTTP/1.1 200 OK\r\ndate: 1\r\n{text}\r\n\r\n").as_bytes());
    assert_eq!(head("a: 1\r\nb: 2"), head("b: 2\r\na: 1"));
    assert_ne!(head("a: 1\r\nb: 2"), head("a: 1"));
    assert_ne!(head("a: 1"), head("a: 2"));
    assert_ne!(head("etag: \"a\"\r\netag: \"a\""), head("etag: \"a\""));
}

#[tokio::test]
async fn one_connection_takes_short_and_long_ways_in_turn() {
    let server = Server::start(Settings::default()).await;
    let (path, known) = (at(ISO, "1", "/data"), format!("if-none-match: \"{}\"\r\n", digest_of(ISO, "1")));
    let ask = |rest: &str, headers: &str, id: usize| {
        format!("GET {path}{rest} HTTP/1.1\r\nhost: a\r\nx-request-id: n{id}\r\n{headers}\r\n")
    };
    // All sent before any answer is read.
    let mut sent = String::new();
    for id in 0..30 {
        sent += &match id % 3 {
            0 => ask("", &known, id),
            1 => ask("", "range: bytes=0-0\r\n", id),
            _ => ask("?format=none", &known, id),
        };
    }
    sent += "GET /healthz HTTP/1.1\r\nhost: a\r\nconnection: close\r\n\r\n";
    let mut stream = server.connect().await;
    stream.write_all(sent.as_bytes()).await.unwrap();
    let mut answers = Vec::new();
    stream.read_to_end(&mut answers).await.unwrap();
    let text = String::from_utf8_lossy(&answers);
    let of = |start: &str| {
        text.split("\r\n").filter_map(|line| line.strip_prefix(start)).map(str::to_owned).collect::<Vec<_>>()
    };
    let ids: Vec<_> = (0..30).map(|id| format!("n{id}")).collect();
    assert_eq!(of("x-request-id: ")[..30], ids, "in the order in which they were asked for");
    assert_eq!(text.matches("HTTP/1.1 304 ").count(), 10);
    assert_eq!(text.matches("HTTP/1.1 206 ").count(), 10);
    assert_eq!(text.matches("HTTP/1.1 422 ").count() + text.matches("HTTP/1.1 400 ").count(), 10, "{text}");
}
