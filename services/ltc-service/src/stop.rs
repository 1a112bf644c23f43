//! When to stop.

use std::io;

use tokio::sync::watch;

/// How urgently the service should stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stop {
    /// Go on.
    No,
    /// Take no new connections, finish the requests at hand.
    Drain,
    /// Drop what is still running.
    Now,
}

/// Becomes [`Stop::Drain`] at the first SIGINT or SIGTERM (on Windows: Ctrl-C), [`Stop::Now`] at the second.
///
/// # Errors
/// When the signals cannot be listened to.
pub(crate) fn on_signals() -> io::Result<watch::Receiver<Stop>> {
    let mut signals = Signals::new()?;
    let (sender, receiver) = watch::channel(Stop::No);
    tokio::spawn(async move {
        for stop in [Stop::Drain, Stop::Now] {
            tokio::select! {
                () = signals.next() => {}
                // Nobody waits any more: the service has ended.
                () = sender.closed() => return,
            }
            sender.send_replace(stop);
        }
    });
    Ok(receiver)
}

/// Waits until at least that is asked for. With the sender gone, draining is asked for and nothing more ever will be.
pub(crate) async fn wait(receiver: &mut watch::Receiver<Stop>, for_what: Stop) {
    let gone = receiver.wait_for(|stop| *stop >= for_what).await.is_err();
    if gone && for_what > Stop::Drain {
        std::future::pending::<()>().await;
    }
}

#[cfg(unix)]
struct Signals {
    interrupt: tokio::signal::unix::Signal,
    terminate: tokio::signal::unix::Signal,
}

#[cfg(unix)]
impl Signals {
    fn new() -> io::Result<Self> {
        use tokio::signal::unix::{SignalKind, signal};
        Ok(Self { interrupt: signal(SignalKind::interrupt())?, terminate: signal(SignalKind::terminate())? })
    }

    async fn next(&mut self) {
        tokio::select! {
            _ = self.interrupt.recv() => {}
            _ = self.terminate.recv() => {}
        }
    }
}

#[cfg(windows)]
struct Signals(tokio::signal::windows::CtrlC);

#[cfg(windows)]
impl Signals {
    fn new() -> io::Result<Self> {
        Ok(Self(tokio::signal::windows::ctrl_c()?))
    }

    async fn next(&mut self) {
        self.0.recv().await;
    }
}
