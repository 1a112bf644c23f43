//! Threads that do nothing but drive connections.

use std::io;
use std::sync::Arc;
use std::thread;

use tokio::runtime::{Builder, Handle};
use tokio::sync::oneshot;

/// Threads with an event loop each.
///
/// A runtime of many threads shares what has become ready out among them, and wakes one that sleeps to do it. An answer from memory takes
/// less time than that. Here a connection stays with one thread from its beginning to its end; whatever may take longer is left to
/// the runtime that the service runs on.
#[derive(Debug)]
pub(crate) struct Loops(Vec<Loop>);

/// One of them; it ends when this is dropped.
#[derive(Debug)]
struct Loop {
    handle: Handle,
    /// Cloned for each of its connections.
    open: Arc<()>,
    _end: oneshot::Sender<()>,
}

/// A place on one of the loops, until it is dropped.
#[derive(Debug)]
pub(crate) struct Place {
    pub(crate) handle: Handle,
    _open: Arc<()>,
}

impl Loops {
    /// One for every thread of the runtime that does the rest.
    pub(crate) fn beside(runtime: &Handle) -> io::Result<Self> {
        Self::start(runtime.metrics().num_workers())
    }

    /// As many as that, and at least one.
    fn start(count: usize) -> io::Result<Self> {
        (0..count.max(1)).map(Loop::start).collect::<io::Result<_>>().map(Self)
    }

    /// A place where there are fewest. There always is one.
    pub(crate) fn place(&self) -> Option<Place> {
        let free = self.0.iter().min_by_key(|one| Arc::strong_count(&one.open))?;
        Some(Place { handle: free.handle.clone(), _open: Arc::clone(&free.open) })
    }
}

impl Loop {
    fn start(number: usize) -> io::Result<Self> {
        let runtime = Builder::new_current_thread().enable_all().on_thread_park(give_way).build()?;
        let handle = runtime.handle().clone();
        let (end, ended) = oneshot::channel();
        let run = move || {
            // The sender is dropped, never used.
            let _ = runtime.block_on(ended);
        };
        thread::Builder::new().name(format!("connections-{number}")).spawn(run)?;
        Ok(Self { handle, open: Arc::default(), _end: end })
    }
}

/// Lets whoever waits for this processor run before a loop goes to sleep. If that is a client, its next requests are there when the loop comes
/// back, and it spends no time on waking anybody; if nobody waits, this takes about a microsecond.
fn give_way() {
    // How often: `tests/load/README.md`.
    for _ in 0..4 {
        thread::yield_now();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn connections_are_shared_out_evenly() {
        let loops = Loops::start(3).unwrap();
        let counts = || loops.0.iter().map(|one| Arc::strong_count(&one.open) - 1).collect::<Vec<_>>();
        let mut places: Vec<_> = (0..7).map(|_| loops.place().unwrap()).collect();
        assert_eq!(counts(), [3, 2, 2]);
        // Whoever leaves is followed by the next one.
        places.swap_remove(1);
        assert_eq!(counts(), [3, 1, 2]);
        places.push(loops.place().unwrap());
        assert_eq!(counts(), [3, 2, 2]);
    }

    #[tokio::test]
    async fn a_loop_drives_what_is_put_on_it_and_ends_with_its_owner() {
        let loops = Loops::start(0).unwrap();
        let place = loops.place().unwrap();
        let name = place.handle.spawn(async { thread::current().name().map(str::to_owned) });
        assert_eq!(name.await.unwrap().as_deref(), Some("connections-0"));
        let forever = place.handle.spawn(std::future::pending::<()>());
        drop(loops);
        assert!(forever.await.unwrap_err().is_cancelled(), "dropped with its loop");
    }
}
