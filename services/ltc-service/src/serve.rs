//! An address, connections, and an end.

use std::io;
use std::net::SocketAddr;
use std::time::Duration;

use axum::Router;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::server::graceful::GracefulShutdown;
use hyper_util::service::TowerToHyperService;
use ltc_table::Catalogue;
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::watch;
use tokio::task::JoinSet;

use crate::stop::{Stop, on_signals, wait};
use crate::{AppState, Limits, app};

/// Where and how to serve.
#[derive(Clone, Debug)]
pub struct ServeConfig {
    /// Host and port; port 0 takes a free one.
    pub listen: String,
    /// How long requests at hand may take to finish after the service was told to stop.
    pub drain_time: Duration,
    /// What one request may cost.
    pub limits: Limits,
}

impl Default for ServeConfig {
    fn default() -> Self {
        Self {
            listen: "127.0.0.1:8787".to_owned(),
            drain_time: Duration::from_secs(10),
            limits: Limits::default(),
        }
    }
}

/// Why the service did not start.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ServeError {
    /// The address is in use, not this machine's, or no address.
    #[error("cannot listen on {address}: {}", reason(.cause))]
    Listen {
        /// The address.
        address: String,
        /// Why.
        cause: io::Error,
    },
    /// Signals cannot be listened to, so the service could not be stopped gracefully.
    #[error("cannot listen to signals: {0}")]
    Signals(io::Error),
}

fn reason(error: &io::Error) -> String {
    match error.kind() {
        io::ErrorKind::AddrInUse => "the address is in use by another program".to_owned(),
        io::ErrorKind::PermissionDenied => {
            "permission denied; ports below 1024 may need privileges".to_owned()
        }
        io::ErrorKind::AddrNotAvailable => "this machine does not have that address".to_owned(),
        _ => error.to_string(),
    }
}

/// Serves these tables until SIGINT or SIGTERM, then finishes the requests at hand within the drain time. A second
/// signal ends the waiting.
///
/// `on_ready` gets the address, with the real port, once connections are accepted. The process's handlers of the two
/// signals stay in place afterwards: call this from a program that ends when it returns.
///
/// # Errors
/// [`ServeError`], before `on_ready` is called.
pub async fn serve(
    config: ServeConfig,
    catalogue: Catalogue,
    on_ready: impl FnOnce(SocketAddr),
) -> Result<(), ServeError> {
    let stop = on_signals().map_err(ServeError::Signals)?;
    serve_until(config, catalogue, on_ready, stop).await
}

/// As [`serve`], until `stop` says so or its sender is dropped; leaves signals alone.
///
/// # Errors
/// As [`serve`].
pub async fn serve_until(
    config: ServeConfig,
    catalogue: Catalogue,
    on_ready: impl FnOnce(SocketAddr),
    mut stop: watch::Receiver<Stop>,
) -> Result<(), ServeError> {
    let failed = |cause| ServeError::Listen { address: config.listen.clone(), cause };
    let listener = TcpListener::bind(&config.listen).await.map_err(failed)?;
    let address = listener.local_addr().map_err(failed)?;
    let mut connections = Connections::new(&config.limits);
    let app = app(AppState::new(catalogue, config.limits.clone()));
    tracing::info!(%address, "listening");
    on_ready(address);
    loop {
        tokio::select! {
            stream = accept(&listener) => connections.serve(stream, app.clone()),
            () = wait(&mut stop, Stop::Drain) => break,
        }
    }
    drop(listener);
    connections.drain(config.drain_time, stop).await;
    Ok(())
}

/// The next connection. Failures to accept, such as too many open files, pass when connections end: they are logged,
/// and after a moment it tries again.
async fn accept(listener: &TcpListener) -> TcpStream {
    loop {
        match listener.accept().await {
            Ok((stream, _)) => return stream,
            Err(error) => {
                tracing::warn!(%error, "cannot accept a connection");
                tokio::time::sleep(Duration::from_millis(100)).await;
            }
        }
    }
}

/// The open connections.
struct Connections {
    protocol: http1::Builder,
    graceful: GracefulShutdown,
    tasks: JoinSet<()>,
}

impl Connections {
    /// Larger request heads are answered with 431 by the protocol.
    const HEAD_BYTES: usize = 64 << 10;

    fn new(limits: &Limits) -> Self {
        let mut protocol = http1::Builder::new();
        protocol
            .timer(TokioTimer::new())
            .header_read_timeout(limits.header_time)
            .max_buf_size(Self::HEAD_BYTES);
        Self { protocol, graceful: GracefulShutdown::new(), tasks: JoinSet::new() }
    }

    fn serve(&mut self, stream: TcpStream, app: Router) {
        while self.tasks.try_join_next().is_some() {}
        // Answers are written whole: waiting to fill packets only delays them. Not all systems can, none must.
        let _ = stream.set_nodelay(true);
        let connection = self.protocol.serve_connection(TokioIo::new(stream), TowerToHyperService::new(app));
        let connection = self.graceful.watch(connection);
        self.tasks.spawn(async move {
            if let Err(error) = connection.await {
                tracing::debug!(%error, "connection ended");
            }
        });
    }

    /// Closes idle connections, waits for the others, and drops those that take too long.
    async fn drain(self, time: Duration, mut stop: watch::Receiver<Stop>) {
        let Self { graceful, mut tasks, .. } = self;
        tracing::info!(connections = graceful.count(), "stopping");
        let done = tokio::select! {
            () = graceful.shutdown() => true,
            () = tokio::time::sleep(time) => false,
            () = wait(&mut stop, Stop::Now) => false,
        };
        if done {
            tracing::info!("stopped");
        } else {
            tracing::warn!(connections = tasks.len(), "stopped with requests unfinished");
        }
        tasks.shutdown().await;
    }
}
