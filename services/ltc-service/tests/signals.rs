//! Real signals. A file of its own: a signal reaches every server of the process.
#![cfg(unix)]

use std::process::Command;
use std::time::Duration;

use ltc_service::{ServeConfig, serve};
use ltc_table::Catalogue;

#[tokio::test]
async fn sigterm_and_sigint_stop_the_service() {
    for signal in ["-TERM", "-INT"] {
        let (ready, address) = tokio::sync::oneshot::channel();
        let config = ServeConfig { listen: "127.0.0.1:0".to_owned(), ..ServeConfig::default() };
        let on_ready = move |address| ready.send(address).unwrap();
        let server = tokio::spawn(serve(config, Catalogue::default(), on_ready));
        let address = address.await.unwrap();
        assert_ne!(address.port(), 0);
        tokio::net::TcpStream::connect(address).await.unwrap();
        assert!(!server.is_finished());
        // Were there no handler, this would end the test as a failure.
        let sent = Command::new("kill").args([signal, &std::process::id().to_string()]).status().unwrap();
        assert!(sent.success());
        tokio::time::timeout(Duration::from_secs(5), server).await.unwrap().unwrap().unwrap();
    }
}
