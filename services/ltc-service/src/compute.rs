//! Work that takes more than a moment, kept off the threads that answer.

use std::sync::Arc;

use tokio::sync::Semaphore;

use crate::ApiError;

/// Runs closures on the blocking pool, no more at a time than there are processors: a burst of costly requests waits
/// its turn and does not multiply memory.
#[derive(Clone, Debug)]
pub(crate) struct Compute(Arc<Semaphore>);

impl Compute {
    pub(crate) fn new() -> Self {
        Self(Arc::new(Semaphore::new(std::thread::available_parallelism().map_or(1, usize::from))))
    }

    /// The closure's result. A panic goes on in the caller, where it becomes a 500.
    pub(crate) async fn run<T: Send + 'static>(
        &self,
        work: impl FnOnce() -> T + Send + 'static,
    ) -> Result<T, ApiError> {
        let permit = Arc::clone(&self.0).acquire_owned().await.map_err(ApiError::internal)?;
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
