//! A GET over plain HTTP/1.1, which is all that a client of the service on this machine needs.

use std::io::{Read as _, Write as _};
use std::net::{SocketAddr, TcpStream};
use std::time::Duration;

use anyhow::{Context as _, Result, bail};
use serde_json::Value;

const CONNECT_TIMEOUT: Duration = Duration::from_secs(2);
/// Between two pieces of an answer.
const READ_TIMEOUT: Duration = Duration::from_secs(20);
/// More than any table; a server that sends without end is an error.
const MOST_BYTES: u64 = 256 << 20;

/// What came back.
#[derive(Debug, PartialEq, Eq)]
pub struct Response {
    /// The status code.
    pub status: u16,
    /// The body, complete.
    pub body: Vec<u8>,
}

/// The body of `GET path`; a status other than 200 is an error with the cause that the service gave.
pub fn get_ok(server: SocketAddr, path: &str) -> Result<Vec<u8>> {
    let response = get(server, path).with_context(|| format!("GET http://{server}{path}"))?;
    if response.status != 200 {
        bail!("GET http://{server}{path} answered {}{}", response.status, detail(&response.body));
    }
    Ok(response.body)
}

/// As [`get_ok`], read as JSON.
pub fn get_json(server: SocketAddr, path: &str) -> Result<Value> {
    let body = get_ok(server, path)?;
    serde_json::from_slice(&body).with_context(|| format!("GET http://{server}{path} answered no JSON"))
}

/// `GET path`, whatever the status.
pub fn get(server: SocketAddr, path: &str) -> Result<Response> {
    let mut stream = TcpStream::connect_timeout(&server, CONNECT_TIMEOUT)?;
    stream.set_read_timeout(Some(READ_TIMEOUT))?;
    stream.write_all(
        format!("GET {path} HTTP/1.1\r\nHost: {server}\r\nConnection: close\r\n\r\n").as_bytes(),
    )?;
    let mut answer = Vec::new();
    stream.take(MOST_BYTES).read_to_end(&mut answer)?;
    parse(&answer)
}

/// Takes an answer apart. The connection was closed after it, so it is all there or was cut short.
fn parse(answer: &[u8]) -> Result<Response> {
    let end = answer
        .windows(4)
        .position(|window| window == b"\r\n\r\n")
        .context("the answer has no end of header")?;
    let (head, body) = (std::str::from_utf8(&answer[..end])?, &answer[end + 4..]);
    let mut lines = head.split("\r\n");
    let status = lines.next().and_then(|line| line.split(' ').nth(1)).and_then(|code| code.parse().ok());
    let status = status.context("the answer has no status")?;
    let (mut length, mut chunked) = (None, false);
    for (name, value) in lines.filter_map(|line| line.split_once(':')) {
        match name.to_ascii_lowercase().as_str() {
            "content-length" => length = Some(value.trim().parse::<usize>().context("a bad Content-Length")?),
            "transfer-encoding" => chunked = value.trim().eq_ignore_ascii_case("chunked"),
            _ => {}
        }
    }
    let body = if chunked { join_chunks(body).context("the answer was cut short")? } else { body.to_vec() };
    if length.is_some_and(|length| length != body.len()) {
        bail!("the answer was cut short: {} bytes of {}", body.len(), length.unwrap_or_default());
    }
    Ok(Response { status, body })
}

/// Puts a chunked body together; nothing when the last chunk is missing.
fn join_chunks(mut rest: &[u8]) -> Option<Vec<u8>> {
    let mut body = Vec::new();
    loop {
        let line = rest.windows(2).position(|window| window == b"\r\n")?;
        let size = std::str::from_utf8(&rest[..line]).ok()?.split(';').next()?.trim();
        let size = usize::from_str_radix(size, 16).ok()?;
        if size == 0 {
            return Some(body);
        }
        let data = line + 2..(line + 2).checked_add(size)?;
        body.extend_from_slice(rest.get(data.clone())?);
        rest = rest.get(data.end..)?.strip_prefix(b"\r\n")?;
    }
}

/// The cause in a problem+json body, or its first words.
fn detail(body: &[u8]) -> String {
    let problem = serde_json::from_slice::<Value>(body).unwrap_or_default();
    match problem["detail"].as_str().or_else(|| problem["title"].as_str()) {
        Some(cause) => format!(": {cause}"),
        None if body.is_empty() => String::new(),
        None => format!(
            ": {}",
            String::from_utf8_lossy(body).chars().take(120).collect::<String>().escape_debug()
        ),
    }
}

#[cfg(test)]
pub mod tests {
    use super::*;
    use std::net::TcpListener;

    /// Answers each connection in turn with what `answer` makes of the path that was asked for.
    pub fn serve(answer: impl Fn(&str) -> Vec<u8> + Send + 'static) -> SocketAddr {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
        let address = listener.local_addr().expect("bound");
        std::thread::spawn(move || {
            for stream in listener.incoming() {
                let mut stream = stream.expect("a client");
                let mut request = Vec::new();
                while !request.ends_with(b"\r\n\r\n") {
                    let mut byte = [0];
                    stream.read_exact(&mut byte).expect("a whole request");
                    request.push(byte[0]);
                }
                let path = String::from_utf8(request).expect("text");
                let path = path.split(' ').nth(1).expect("a path").to_owned();
                stream.write_all(&answer(&path)).expect("the client reads");
            }
        });
        address
    }

    /// A 200 with its length.
    pub fn ok(body: &[u8]) -> Vec<u8> {
        [format!("HTTP/1.1 200 OK\r\ncontent-length: {}\r\n\r\n", body.len()).as_bytes(), body].concat()
    }

    #[test]
    fn reads_a_body_of_known_length() {
        let server = serve(|path| ok(format!("you asked for {path}").as_bytes()));
        assert_eq!(get_ok(server, "/a?b=c").expect("200"), b"you asked for /a?b=c");
    }

    #[test]
    fn reads_chunks_and_what_ends_with_the_connection() {
        let chunked = b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n3\r\nabc\r\nA;x=y\r\n0123456789\r\n0\r\n\r\n";
        assert_eq!(parse(chunked).expect("whole").body, b"abc0123456789");
        assert_eq!(parse(b"HTTP/1.1 404 Not Found\r\n\r\nrest").expect("whole").body, b"rest");
    }

    #[test]
    fn what_is_cut_short_is_an_error() {
        for answer in [
            &b"HTTP/1.1 200 OK\r\nContent-Length: 5\r\n\r\nabcd"[..],
            b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n3\r\nabc\r\n",
            b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n4\r\nabc",
            b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\nffffffffffffffff\r\nabc",
            b"HTTP/1.1 200 OK\r\nContent-Le",
            b"HTTP/1.1\r\n\r\n",
            b"",
        ] {
            parse(answer).expect_err(&String::from_utf8_lossy(answer));
        }
    }

    #[test]
    fn a_refusal_carries_the_cause() {
        let server = serve(|_| {
            b"HTTP/1.1 404 Not Found\r\n\r\n{\"title\":\"Not Found\",\"detail\":\"no table is called x\"}"
                .to_vec()
        });
        let cause = get_ok(server, "/x").expect_err("404").to_string();
        assert!(cause.ends_with("answered 404: no table is called x"), "{cause}");
        assert_eq!(get(server, "/x").expect("an answer").status, 404);
    }
}
