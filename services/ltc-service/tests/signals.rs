//! Real signals. A file of its own: a signal reaches every server of the process.
#![cfg(unix)]

use std::process::Command;
use std::sync::Arc;
use std::time::Duration;

use ltc_service::{AppState, Settings, Stores, serve};
use ltc_store::MemoryStore;

#[tokio::test]
async fn sigterm_and_sigint_stop_the_service() {
    for signal in ["-TERM", "-INT"] {
        let (ready, address) = tokio::sync::oneshot::channel();
        let settings = Settings { listen: "127.0.0.1:0".to_owned(), ..Settings::default() };
        let stores = Stores::of(Arc::new(MemoryStore::default()));
        let state = AppState::new(stores, settings).await.unwrap();
        let on_ready = move |address| ready.send(address).unwrap();
        let server = tokio::spawn(serve(state, on_ready));
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
