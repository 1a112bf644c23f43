//! Threads for long work, which give way to those that answer.

use crate::ApiError;

/// Runs work and its parallel parts on threads of the lowest priority, one for each processor.
pub(crate) fn run<T: Send>(work: impl FnOnce() -> T + Send) -> Result<T, ApiError> {
    let pool = rayon::ThreadPoolBuilder::new().start_handler(|_| give_way()).build();
    Ok(pool.map_err(ApiError::internal)?.install(work))
}

/// Lowers the priority of this thread, where that can be done; nothing depends on it but the time that answers take.
#[cfg(target_os = "linux")]
fn give_way() {
    // Linux keeps priorities by thread, and takes a thread's id where a process's is asked for.
    let _ = rustix::process::setpriority_process(Some(rustix::thread::gettid()), 19);
}

#[cfg(not(target_os = "linux"))]
fn give_way() {}
