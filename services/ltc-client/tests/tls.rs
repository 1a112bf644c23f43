//! `https`: a certificate is believed where its authority is, and nowhere else.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use std::io::{Read, Write};
use std::net::{SocketAddr, TcpListener};
use std::sync::Arc;

use ltc_client::{Client, ClientError};
use rcgen::CertifiedKey;
use rustls::pki_types::{PrivateKeyDer, PrivatePkcs8KeyDer};
use rustls::{ServerConfig, ServerConnection, StreamOwned};

/// Answers everything by TLS, with a certificate for `localhost` that is its own authority; gives that.
fn answer_with(body: &'static str) -> (SocketAddr, String) {
    let CertifiedKey { cert, signing_key } =
        rcgen::generate_simple_self_signed(["localhost".to_owned()]).unwrap();
    let key = PrivateKeyDer::Pkcs8(PrivatePkcs8KeyDer::from(signing_key.serialize_der()));
    let provider = Arc::new(rustls::crypto::ring::default_provider());
    let config = ServerConfig::builder_with_provider(provider).with_safe_default_protocol_versions().unwrap();
    let config = config.with_no_client_auth().with_single_cert(vec![cert.der().clone()], key).unwrap();
    let config = Arc::new(config);
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    std::thread::spawn(move || {
        for stream in listener.incoming() {
            let connection = ServerConnection::new(Arc::clone(&config)).unwrap();
            let mut stream = StreamOwned::new(connection, stream.unwrap());
            let mut head = Vec::new();
            let mut byte = [0];
            // A client that refuses the certificate ends here.
            while !head.ends_with(b"\r\n\r\n") && stream.read_exact(&mut byte).is_ok() {
                head.extend(byte);
            }
            let length = body.len();
            let _ = write!(
                stream,
                "HTTP/1.1 200 OK\r\ncontent-type: application/json\r\ncontent-length: {length}\r\nconnection: close\r\n\r\n{body}"
            );
            stream.conn.send_close_notify();
            let _ = stream.flush();
        }
    });
    (address, cert.pem())
}

const TABLES: &str = r#"{"tables":[{"name":"a","latest":2,"versions":[1,2],"digest":"sha256:x"}]}"#;

fn refusal(client: &Client) -> String {
    match client.tables() {
        Err(ClientError::Network { cause, .. }) => cause.to_string(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_certificate_is_believed_where_its_authority_is() {
    let (address, authority) = answer_with(TABLES);
    let url = format!("https://localhost:{}", address.port());
    let client = Client::new(&url).with_authorities(authority.as_bytes()).unwrap();
    let tables = client.tables().unwrap();
    assert_eq!((tables[0].name.as_str(), tables[0].latest), ("a", 2));
    // The world's authorities have never heard of it, and another of its kind has not signed it.
    let unknown = refusal(&Client::new(&url));
    assert!(unknown.contains("UnknownIssuer"), "{unknown}");
    let (_, other) = answer_with(TABLES);
    let unknown = refusal(&Client::new(&url).with_authorities(other.as_bytes()).unwrap());
    assert!(unknown.contains("invalid peer certificate"), "{unknown}");
    // A name that the certificate is not for.
    let by_number =
        Client::new(&format!("https://{address}")).with_authorities(authority.as_bytes()).unwrap();
    let not_for = refusal(&by_number);
    assert!(not_for.contains("not valid for name"), "{not_for}");
}

#[test]
fn what_is_no_authority_is_refused() {
    let key = rcgen::KeyPair::generate().unwrap().serialize_pem();
    for pem in ["", "nothing", key.as_str(), "-----BEGIN CERTIFICATE-----\n!\n-----END CERTIFICATE-----\n"] {
        let error = Client::new("https://localhost").with_authorities(pem.as_bytes()).unwrap_err();
        assert!(matches!(error, ClientError::NoAuthority { .. }), "{error}");
    }
}
