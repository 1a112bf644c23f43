//! `ltc serve`

use std::io::{BufRead, BufReader, Read, Write};
use std::net::{TcpListener, TcpStream};
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
        let mut child = command(&["serve", "--listen", "127.0.0.1:0", "--log", "warn"]).spawn().unwrap();
        let mut stdout = BufReader::new(child.stdout.take().unwrap());
        let mut line = String::new();
        stdout.read_line(&mut line).unwrap();
        let address = line.trim().rsplit_once("http://").map(|(_, address)| address.to_owned());
        Self { child, stdout, address: address.unwrap_or_else(|| panic!("no URL in {line:?}")) }
    }

    /// Status and body.
    fn get(&self, path: &str) -> (u16, String) {
        let mut stream = TcpStream::connect(&self.address).unwrap();
        write!(stream, "GET {path} HTTP/1.1\r\nHost: {}\r\nConnection: close\r\n\r\n", self.address).unwrap();
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
    ltc(&["serve", "--listen", "127.0.0.1:0", "--log", "a=b=c"]).refused(&["--log a=b=c"]);
    ltc(&["serve", "--tables", "no/such/folder"]).refused(&["no/such/folder"]);
}
