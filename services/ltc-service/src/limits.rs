//! What one request may cost.

use std::time::Duration;

/// Bounds on time and memory.
#[derive(Clone, Debug)]
pub struct Limits {
    /// Bytes of a request's body; more is 413.
    pub body_bytes: usize,
    /// Queries in one batch of lookups; more is 413. Bounds the answer, which is several times the request's size.
    pub batch_queries: usize,
    /// Bytes of the encoded tables that are kept in memory.
    pub cache_bytes: usize,
    /// Time for a request's headers to arrive; then the connection is closed.
    pub header_time: Duration,
    /// Time for a request's body to arrive; then 408.
    pub body_time: Duration,
    /// Time for the answer to begin; then 503.
    pub request_time: Duration,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            body_bytes: 1 << 20,
            batch_queries: 10_000,
            cache_bytes: 64 << 20,
            header_time: Duration::from_secs(15),
            body_time: Duration::from_secs(15),
            request_time: Duration::from_secs(30),
        }
    }
}
