//! `ltc serve`

use std::io::{BufRead, BufReader, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::process::{Child, ChildStdout, Command};

use crate::support::{command, ltc};

/// A running service; killed if a test fails before it is stopped.
struct Served {
    child: Child,
    stdout: BufReader<ChildStdout>,
    address: String,
}

impl Served {
    fn start() -> Self {
        Self::start_with(&["serve", "--listen", "127.0.0.1:0", "--log", "warn"])
    }

    fn start_with(args: &[&str]) -> Self {
        let mut child = command(args).spawn().unwrap();
        let mut stdout = BufReader::new(child.stdout.take().unwrap());
        let mut line = String::new();
        stdout.read_line(&mut line).unwrap();
        let address = line.trim().rsplit_once("http://").map(|(_, address)| address.to_owned());
        Self { child, stdout, address: address.unwrap_or_else(|| panic!("no URL in {line:?}")) }
    }

    /// Status and body.
    fn get(&self, path: &str) -> (u16, String) {
        self.exchange(&format!("GET {path} HTTP/1.1\r\nHost: {}\r\nConnection: close\r\n\r\n", self.address))
    }

    /// Status and body of a request as it is written.
    fn exchange(&self, request: &str) -> (u16, String) {
        let mut stream = TcpStream::connect(&self.address).unwrap();
        stream.write_all(request.as_bytes()).unwrap();
        let mut answer = String::new();
        stream.read_to_string(&mut answer).unwrap();
        let (head, body) = answer.split_once("\r\n\r\n").unwrap();
        (head.split(' ').nth(1).unwrap().parse().unwrap(), body.to_owned())
    }

    fn signal(&self, name: &str) {
        assert!(Command::new("kill").args([name, &self.child.id().to_string()]).status().unwrap().success());
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        // It has ended already unless a test failed.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

#[test]
fn it_tells_its_url_answers_and_stops_in_good_order() {
    for signal in ["-INT", "-TERM"] {
        let mut served = Served::start();
        assert_eq!(served.get("/healthz").0, 200);
        assert_eq!(served.get("/readyz").0, 200);
        let (status, listing) = served.get("/v1/tables");
        assert_eq!(status, 200);
        let listing: serde_json::Value = serde_json::from_str(&listing).unwrap();
        let tables = listing["tables"].as_array().unwrap();
        assert!(tables.iter().any(|table| table["name"] == "ggx-anisotropic"), "{listing}");
        assert_eq!(served.get("/v1/tables/nonesuch").0, 404);
        let lookup = "/v1/tables/ggx-isotropic/versions/latest/lookup?theta=NaN&alpha_x=0.5&alpha_y=0.5";
        let (status, problem) = served.get(lookup);
        assert!((400..500).contains(&status), "{status}");
        let problem: serde_json::Value = serde_json::from_str(&problem).unwrap();
        assert!(problem["detail"].as_str().unwrap().contains("theta"), "{problem}");

        served.signal(signal);
        assert_eq!(served.child.wait().unwrap().code(), Some(0), "{signal}");
        let mut rest = String::new();
        served.stdout.read_to_string(&mut rest).unwrap();
        assert!(rest.ends_with("stopped\n"), "{rest}");
        assert!(TcpStream::connect(&served.address).is_err(), "it is gone");
    }
}

#[test]
fn a_port_in_use_and_a_wrong_address_are_told() {
    let taken = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = taken.local_addr().unwrap().to_string();
    ltc(&["serve", "--listen", &address]).refused(&[&address, "in use"]);
    ltc(&["serve", "--listen", "nonsense"]).refused(&["nonsense"]);
    ltc(&["serve", "--listen", "127.0.0.1:0", "--log", "a=b=c"]).refused(&["log a=b=c"]);
    ltc(&["serve", "--tables", "no/such/folder"]).refused(&["no/such/folder"]);
}

#[test]
fn settings_are_checked_and_printed_without_serving() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("ltc.toml");
    std::fs::write(&file, "log = \"warn\"\ndrain_seconds = 3\n[limits]\nbody_bytes = 10\n").unwrap();
    let file = file.to_str().unwrap();
    let args = ["serve", "--check", "--config", file, "--listen", "127.0.0.1:3", "--set", "refits.threads=2"];
    let mut child = command(&args);
    child.env("LTC_LOG", "error").env("LTC_LISTEN", "127.0.0.1:2");
    let printed = String::from_utf8(child.output().unwrap().stdout).unwrap();
    for line in [
        "listen = \"127.0.0.1:3\"",
        "log = \"error\"",
        "drain_seconds = 3.0",
        "body_bytes = 10",
        "threads = 2",
    ] {
        assert!(printed.lines().any(|found| found == line), "{line}\n{printed}");
    }
    // What is printed is a file that gives the same.
    let copy = folder.path().join("copy.toml");
    std::fs::write(&copy, &printed).unwrap();
    assert_eq!(ltc(&["serve", "--check", "--config", copy.to_str().unwrap()]).good().out, printed);
    for (args, said) in [
        (&["--set", "limits.body=1"][..], "limits.body"),
        (&["--read", "maybe"], "maybe"),
        (&["--config", "no/such/file.toml"], "no/such/file.toml"),
        (&["--listen", "nowhere"], "nowhere"),
    ] {
        ltc(&[&["serve", "--check"], args].concat()).refused(&[said]);
    }
}

/// Everything that a service of this folder wrote to its log.
fn log_of(folder: &Path, format: &str, ask: impl FnOnce(&Served)) -> String {
    let data = folder.to_str().unwrap();
    let args = ["serve", "--listen", "127.0.0.1:0", "--data", data, "--log", "trace", "--log-format", format];
    let mut served = Served::start_with(&args);
    let mut stderr = served.child.stderr.take().unwrap();
    let reader = std::thread::spawn(move || {
        let mut text = String::new();
        stderr.read_to_string(&mut text).map(|_| text)
    });
    ask(&served);
    served.signal("-TERM");
    served.child.wait().unwrap();
    reader.join().unwrap().unwrap()
}

#[test]
fn logs_tell_what_happened_and_no_secret() {
    let folder = tempfile::tempdir().unwrap();
    let data = folder.path().to_str().unwrap();
    let made = ltc(&["token", "create", "--data", data, "--scope", "benchmark", "--json"]).json();
    let token = made["token"].as_str().unwrap().to_owned();
    for format in ["text", "json"] {
        let log = log_of(folder.path(), format, |served| {
            let body = "{\"name\": \"a\", \"run\": {}}";
            let head = format!(
                "POST /v1/benchmarks HTTP/1.1\r\nHost: a\r\nConnection: close\r\nAuthorization: Bearer {token}\r\n\
                 X-Request-Id: build-42\r\nContent-Type: application/json\r\nContent-Length: {}\r\n\r\n{body}",
                body.len()
            );
            assert_eq!(served.exchange(&head).0, 201);
            assert_eq!(served.exchange(&head.replace("ltc_", "ltc_0")).0, 401);
        });
        let secret = token.rsplit('_').next().unwrap();
        assert!(!log.contains(secret), "a secret is in the log");
        assert!(log.contains("build-42") && log.contains("/v1/benchmarks"), "{log}");
        if format == "json" {
            for line in log.lines() {
                let line: serde_json::Value =
                    serde_json::from_str(line).unwrap_or_else(|e| panic!("{e}: {line}"));
                assert!(line["level"].is_string() && line["timestamp"].is_string());
            }
        }
    }
    let log = log_of(&folder.path().join("other"), "text", |_| {});
    assert!(log.contains("there is no token, so that nobody can write"), "{log}");
}

/// A short result of `ltc bench`.
fn result(time: f64) -> serde_json::Value {
    serde_json::json!({
        "schema": 1, "tool": "0.1.0", "quick": true, "date": "2026-01-01T00:00:00Z", "commit": "abc",
        "machine": {"cpu": "a", "threads": 2, "system": "linux", "build": "optimised"},
        "records": [{
            "id": "integral/quad/exact/f32", "per": "light",
            "time": {"median": time, "low": 0.98 * time, "high": 1.02 * time}, "errors": {"max": 6e-7},
        }],
    })
}

#[test]
fn benchmark_runs_are_posted_and_their_history_shown() {
    let folder = tempfile::tempdir().unwrap();
    let data = folder.path().join("data");
    let data = data.to_str().unwrap();
    let made = ltc(&["token", "create", "--data", data, "--scope", "benchmark", "--json"]).json();
    let token = made["token"].as_str().unwrap();
    let served = Served::start_with(&["serve", "--listen", "127.0.0.1:0", "--data", data, "--log", "error"]);
    let url = format!("http://{}", served.address);
    for (name, time) in [("before", 40.0), ("after", 50.0)] {
        let run = folder.path().join(name);
        std::fs::create_dir(&run).unwrap();
        std::fs::write(run.join("bench.json"), result(time).to_string()).unwrap();
        let run = run.to_str().unwrap();
        let posted = command(&["bench", "post", run, "--to", &url]).env("LTC_TOKEN", token).output().unwrap();
        let said = String::from_utf8(posted.stdout).unwrap();
        assert!(said.contains(&format!("the history is at {url}/benchmarks")), "{said}");
    }
    let (status, page) = served.get("/benchmarks");
    assert_eq!(status, 200);
    assert!(page.contains("2 runs, 2 measures.") && page.contains("integral/quad/exact/f32 time"), "{page}");
    assert_eq!(page.matches("class=\"worse\" d=").count(), 1, "{page}");
    let (_, list) = served.get("/v1/benchmarks?name=ltc%20bench");
    let list: serde_json::Value = serde_json::from_str(&list).unwrap();
    assert_eq!(list["benchmarks"][1]["run"], result(50.0), "as it was");
    // A token from a file; one that is not good; none.
    let (after, file) = (folder.path().join("after"), folder.path().join("token"));
    let (after, file_name) = (after.to_str().unwrap(), file.to_str().unwrap());
    std::fs::write(&file, format!("{token}\n")).unwrap();
    let post = ["bench", "post", after, "--to", &url, "--series", "other", "--token-file", file_name];
    ltc(&post).good();
    std::fs::write(&file, "ltc_wrong").unwrap();
    ltc(&post).refused(&["was not taken", "401"]);
    ltc(&["bench", "post", after, "--to", &url]).refused(&["no token", "LTC_TOKEN"]);
    // Said before anything is measured.
    ltc(&["bench", "--post", &url, "-o", after]).refused(&["no token"]);
    ltc(&["bench", "post", "/nowhere", "--to", &url, "--token-file", file_name]).refused(&["/nowhere"]);
}
