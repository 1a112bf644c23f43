//! The time limit of a connection's next request, made cheap.

use std::pin::Pin;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::task::{Context, Poll, ready};
use std::time::{Duration, Instant};

use hyper::rt::{Sleep, Timer};

/// The timer of one connection.
///
/// hyper sets a limit when it begins to wait for a request's head and lets go of it when the head is there: thousands of times a
/// second, of which none passes. A timer of the runtime is woven into its wheel and out of it each time. This one goes off at the
/// limit that was set first, and only then looks which one counts by now.
#[derive(Clone, Debug)]
pub(crate) struct Patience(Arc<Mutex<Pin<Box<tokio::time::Sleep>>>>);

/// A limit.
struct Limit {
    until: Instant,
    timer: Patience,
}

impl Patience {
    /// Of a connection that has just been accepted.
    pub(crate) fn new() -> Self {
        Self(Arc::new(Mutex::new(Box::pin(tokio::time::sleep(Duration::ZERO)))))
    }

    /// One task polls a connection, so that nobody ever waits here.
    fn alarm(&self) -> MutexGuard<'_, Pin<Box<tokio::time::Sleep>>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Timer for Patience {
    fn sleep(&self, duration: Duration) -> Pin<Box<dyn Sleep>> {
        self.sleep_until(Instant::now() + duration)
    }

    fn sleep_until(&self, until: Instant) -> Pin<Box<dyn Sleep>> {
        Box::pin(Limit { until, timer: self.clone() })
    }
}

impl Sleep for Limit {}

impl Future for Limit {
    type Output = ();

    fn poll(self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<()> {
        let until = tokio::time::Instant::from_std(self.until);
        let mut alarm = self.timer.alarm();
        if alarm.deadline() > until {
            alarm.as_mut().reset(until);
        }
        loop {
            ready!(alarm.as_mut().poll(context));
            if tokio::time::Instant::now() >= until {
                return Poll::Ready(());
            }
            // It went off for a limit that was let go of since.
            alarm.as_mut().reset(until);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether a limit passes within this time, by the clock of the runtime.
    async fn passes_within(sleep: &mut Pin<Box<dyn Sleep>>, time: Duration) -> bool {
        tokio::time::timeout(time, sleep).await.is_ok()
    }

    #[tokio::test]
    async fn the_limit_that_counts_is_the_one_that_was_set_last() {
        let (timer, start) = (Patience::new(), Instant::now());
        let after = |milliseconds| start + Duration::from_millis(milliseconds);
        // Set, waited for, and let go of: the alarm stands at 60 ms.
        let mut first = timer.sleep_until(after(60));
        assert!(!passes_within(&mut first, Duration::from_millis(20)).await);
        drop(first);
        let mut second = timer.sleep_until(after(200));
        assert!(!passes_within(&mut second, Duration::from_millis(100)).await, "that was the first's");
        assert!(passes_within(&mut second, Duration::from_secs(20)).await);
        assert!(start.elapsed() >= Duration::from_millis(200));
        // An earlier one than the alarm stands at.
        let mut late = timer.sleep(Duration::from_secs(1000));
        assert!(!passes_within(&mut late, Duration::from_millis(1)).await);
        let mut early = timer.sleep(Duration::from_millis(10));
        assert!(passes_within(&mut early, Duration::from_secs(20)).await);
        // One that has passed before it is waited for.
        assert!(passes_within(&mut timer.sleep_until(start), Duration::from_secs(20)).await);
    }
}
