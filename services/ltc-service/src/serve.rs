//! An address, connections, and an end.

use std::future::{Ready, ready};
use std::io;
use std::net::{IpAddr, SocketAddr};
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll};
use std::time::{Duration, Instant};

use axum::body::Body;
use axum::http::Request;
use axum::response::Response;
use futures_util::future::{Either, FutureExt, TryFutureExt};
use hyper::body::{Body as _, Incoming};
use hyper::server::conn::http1;
use hyper::service::Service;
use hyper_util::rt::TokioIo;
use hyper_util::server::graceful::GracefulShutdown;
use tokio::net::{TcpListener, TcpStream};
use tokio::runtime::Handle;
use tokio::sync::{OwnedSemaphorePermit, Semaphore, watch};
use tokio::task::{JoinError, JoinHandle, JoinSet};

use crate::AppState;
use crate::gate::Gate;
use crate::loops::Loops;
use crate::patience::Patience;
use crate::router::gate;
use crate::settings::Limits;
use crate::stop::{Stop, on_signals, wait};

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
    /// The system has no more threads or descriptors for the connections.
    #[error("cannot start the threads of the connections: {0}")]
    Threads(io::Error),
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

/// How often to look for what other processes changed in the store.
const LOOK: Duration = Duration::from_secs(2);

/// Serves until SIGINT or SIGTERM, then finishes the requests at hand within the drain time. A second signal ends the waiting.
///
/// `on_ready` gets the address, with the real port, once connections are accepted. The process's handlers of the two
/// signals stay in place afterwards: call this from a program that ends when it returns.
///
/// # Errors
/// [`ServeError`], before `on_ready` is called.
pub async fn serve(state: AppState, on_ready: impl FnOnce(SocketAddr)) -> Result<(), ServeError> {
    let stop = on_signals().map_err(ServeError::Signals)?;
    serve_until(state, on_ready, stop).await
}

/// As [`serve`], until `stop` says so or its sender is dropped; leaves signals alone.
///
/// # Errors
/// As [`serve`].
pub async fn serve_until(
    state: AppState,
    on_ready: impl FnOnce(SocketAddr),
    mut stop: watch::Receiver<Stop>,
) -> Result<(), ServeError> {
    let listen = &state.settings().listen;
    let failed = |cause| ServeError::Listen { address: listen.clone(), cause };
    let listener = TcpListener::bind(listen).await.map_err(failed)?;
    let address = listener.local_addr().map_err(failed)?;
    let loops = Loops::beside(&Handle::current()).map_err(ServeError::Threads)?;
    let mut connections = Connections::new(state.limits(), gate(state.clone()), loops);
    warn_without_tokens(&state).await;
    tracing::info!(%address, "listening");
    on_ready(address);
    let chores = tokio::spawn(chores(state.clone()));
    state.refresh_when_published();
    let workers = state.refits().start();
    loop {
        tokio::select! {
            (stream, peer, permit) = connections.next(&listener) => connections.serve(stream, peer, permit),
            () = wait(&mut stop, Stop::Drain) => break,
        }
    }
    drop(listener);
    chores.abort();
    state.stop();
    let drain_time = Duration::from_secs_f64(state.settings().drain_seconds);
    // A refit is put back into the queue, and goes on from there at the next start.
    tokio::join!(connections.drain(drain_time, stop), workers.stop());
    Ok(())
}

/// Nobody can write until somebody makes a token: the log says so.
async fn warn_without_tokens(state: &AppState) {
    match state.tokens().count(&*state.stores().metadata).await {
        Ok(0) => {
            tracing::warn!("there is no token, so that nobody can write; make one with: ltc token create");
        }
        Ok(count) => tracing::info!(count, "tokens"),
        Err(error) => tracing::warn!(%error, "tokens cannot be read"),
    }
}

/// What has to be done now and then.
async fn chores(state: AppState) {
    let mut failing = false;
    for round in 1_u64.. {
        tokio::time::sleep(LOOK).await;
        match state.refresh().await {
            Ok(()) => failing = false,
            Err(error) if !failing => {
                failing = true;
                tracing::error!(%error, "the store cannot be read; what is in memory is served on");
            }
            Err(_) => {}
        }
        if round % 30 == 0 {
            state.rates().forget();
            crate::memory::give_back();
        }
    }
}

/// The next connection. Failures to accept, such as too many open files, pass when connections end: they are logged,
/// and after a moment it tries again.
async fn accept(listener: &TcpListener) -> (TcpStream, SocketAddr) {
    loop {
        match listener.accept().await {
            Ok(accepted) => return accepted,
            Err(error) => {
                tracing::warn!(%error, "cannot accept a connection");
                tokio::time::sleep(Duration::from_millis(100)).await;
            }
        }
    }
}

/// The open connections.
struct Connections {
    gate: Gate,
    loops: Loops,
    protocol: http1::Builder,
    graceful: GracefulShutdown,
    tasks: JoinSet<()>,
    permits: Arc<Semaphore>,
}

impl Connections {
    /// Larger request heads are answered with 431 by the protocol.
    const HEAD_BYTES: usize = 64 << 10;

    fn new(limits: &Limits, gate: Gate, loops: Loops) -> Self {
        let mut protocol = http1::Builder::new();
        // No `pipeline_flush`: it holds back the answer to what is no HTTP for as long as bytes of that are unread, which is for ever.
        protocol
            .header_read_timeout(limits.header_time())
            .max_header_size(Self::HEAD_BYTES)
            .max_buf_size(Self::HEAD_BYTES);
        let permits = Arc::new(Semaphore::new(limits.connections));
        Self { gate, loops, protocol, graceful: GracefulShutdown::new(), tasks: JoinSet::new(), permits }
    }

    /// The next connection, once there is room for one.
    async fn next(&self, listener: &TcpListener) -> (TcpStream, SocketAddr, Option<OwnedSemaphorePermit>) {
        // It is never closed, so that there is always a permit in the end.
        let permit = Arc::clone(&self.permits).acquire_owned().await.ok();
        let (stream, peer) = accept(listener).await;
        (stream, peer, permit)
    }

    fn serve(&mut self, stream: TcpStream, peer: SocketAddr, permit: Option<OwnedSemaphorePermit>) {
        while self.tasks.try_join_next().is_some() {}
        // Answers are written whole: waiting to fill packets only delays them. Not all systems can, none must.
        let _ = stream.set_nodelay(true);
        let Some(place) = self.loops.place() else { return };
        // The loop that it is put on watches it from now on.
        let stream = stream.into_std();
        let clerk = Clerk { gate: self.gate.clone(), peer: peer.ip(), runtime: Handle::current() };
        let (mut protocol, watcher) = (self.protocol.clone(), self.graceful.watcher());
        let handle = place.handle.clone();
        let connection = async move {
            let _held = (permit, place);
            let stream = TcpStream::from_std(stream?)?;
            let connection = protocol.timer(Patience::new()).serve_connection(TokioIo::new(stream), clerk);
            watcher.watch(connection).await.map_err(io::Error::other)
        };
        let connection = connection.inspect_err(|error| tracing::debug!(%error, "connection ended"));
        self.tasks.spawn_on(connection.map(drop), &handle);
    }

    /// Closes idle connections, waits for the others, and drops those that take too long.
    async fn drain(self, time: Duration, mut stop: watch::Receiver<Stop>) {
        let Self { graceful, mut tasks, loops: _loops, .. } = self;
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

/// Answers the requests of one connection.
struct Clerk {
    gate: Gate,
    peer: IpAddr,
    /// Where what cannot be answered at once is worked on.
    runtime: Handle,
}

impl Service<Request<Incoming>> for Clerk {
    type Response = Response;
    type Error = JoinError;
    type Future = Either<Ready<Result<Response, JoinError>>, Coming>;

    fn call(&self, request: Request<Incoming>) -> Self::Future {
        let (start, peer) = (Instant::now(), Some(self.peer));
        if let Some(response) = self.gate.answer_again(&request, peer, start) {
            return Either::Left(ready(Ok(response)));
        }
        let gate = self.gate.clone();
        let answer = async move { gate.answer_anew(with_body(request), peer, start).await };
        Either::Right(Coming(self.runtime.spawn(answer)))
    }
}

/// An answer that is worked on, for as long as somebody waits for it.
struct Coming(JoinHandle<Response>);

impl Future for Coming {
    type Output = Result<Response, JoinError>;

    fn poll(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<Self::Output> {
        Pin::new(&mut self.0).poll(context)
    }
}

impl Drop for Coming {
    fn drop(&mut self) {
        self.0.abort();
    }
}

/// A request as handlers take it. Most have no body, and then need no box for one.
fn with_body(request: Request<Incoming>) -> Request<Body> {
    request.map(|body| if body.is_end_stream() { Body::empty() } else { Body::new(body) })
}
