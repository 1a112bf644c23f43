//! Work that takes more than a moment, kept off the threads that answer.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use tokio::sync::Semaphore;

use crate::ApiError;

/// Runs closures on the blocking pool, no more at a time than there are processors, and lets no more than so many wait: a
/// burst of costly requests neither multiplies memory nor keeps everybody waiting.
#[derive(Clone, Debug)]
pub(crate) struct Compute {
    permits: Arc<Semaphore>,
    waiting: Arc<AtomicUsize>,
    most_waiting: usize,
}

/// One that waits.
struct Waiting<'a>(&'a AtomicUsize);

impl Drop for Waiting<'_> {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::Relaxed);
    }
}

impl Compute {
    pub(crate) fn new(permits: usize, most_waiting: usize) -> Self {
        let permits = Arc::new(Semaphore::new(permits));
        Self { permits, waiting: Arc::default(), most_waiting }
    }

    /// As many at a time as there are processors.
    pub(crate) fn on_every_processor(most_waiting: usize) -> Self {
        Self::new(std::thread::available_parallelism().map_or(1, usize::from), most_waiting)
    }

    /// The closure's result. A panic goes on in the caller, where it becomes a 500.
    ///
    /// # Errors
    /// [`ApiError::Overloaded`] when too many wait.
    pub(crate) async fn run<T: Send + 'static>(
        &self,
        work: impl FnOnce() -> T + Send + 'static,
    ) -> Result<T, ApiError> {
        let permit = match Arc::clone(&self.permits).try_acquire_owned() {
            Ok(permit) => permit,
            Err(_) => {
                let before = self.waiting.fetch_add(1, Ordering::Relaxed);
                let _waiting = Waiting(&self.waiting);
                if before >= self.most_waiting {
                    return Err(ApiError::Overloaded);
                }
                Arc::clone(&self.permits).acquire_owned().await.map_err(ApiError::internal)?
            }
        };
        let task = tokio::task::spawn_blocking(move || {
            // Held by the work and not by the request: one that is given up still uses its processor.
            let _permit = permit;
            work()
        });
        match task.await {
            Ok(result) => Ok(result),
            Err(error) => match error.try_into_panic() {
                Ok(panic) => std::panic::resume_unwind(panic),
                Err(cancelled) => Err(ApiError::internal(cancelled)),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn more_than_may_wait_are_refused_at_once() {
        let compute = Compute::new(1, 1);
        let (go, wait) = std::sync::mpsc::channel::<()>();
        let busy = tokio::spawn({
            let compute = compute.clone();
            async move { compute.run(move || wait.recv()).await }
        });
        while compute.permits.available_permits() > 0 {
            tokio::task::yield_now().await;
        }
        let waiting = tokio::spawn({
            let compute = compute.clone();
            async move { compute.run(|| 7).await }
        });
        while compute.waiting.load(Ordering::Relaxed) == 0 {
            tokio::task::yield_now().await;
        }
        assert!(matches!(compute.run(|| ()).await, Err(ApiError::Overloaded)));
        go.send(()).unwrap();
        busy.await.unwrap().unwrap().unwrap();
        assert_eq!(waiting.await.unwrap().unwrap(), 7);
        compute.run(|| ()).await.unwrap();
    }
}
