//! What can be configured, and from where.
//!
//! Every setting has a name, such as `listen` or `limits.body_bytes`, and four places that it can come from; the first that has
//! it counts:
//! 1. a flag: `--listen 0.0.0.0:80`, or for any setting `--set limits.body_bytes=65536`
//! 2. the environment: `LTC_LISTEN`, `LTC_LIMITS_BODY_BYTES`
//! 3. a TOML file: `listen = "0.0.0.0:80"`, `body_bytes = 65536` below `[limits]`
//! 4. the default
//!
//! What is misspelt is an error that names it, wherever it stands. No setting is a secret: tokens live in the store, hashed.

mod layers;

use std::net::ToSocketAddrs;
use std::path::PathBuf;
use std::time::Duration;

use ltc_refit::RefitConfig;
use serde::{Deserialize, Serialize};

pub use layers::{Layers, SettingsError};

/// Everything that can be configured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Settings {
    /// Address and port to listen on; port 0 takes a free one.
    pub listen: String,
    /// Folder of the embedded store; empty: everything is kept in memory and lost at the end.
    pub data: PathBuf,
    /// What to log: `error`, `warn`, `info`, `debug`, or a filter such as `ltc_service=debug`.
    pub log: String,
    /// How to log.
    pub log_format: LogFormat,
    /// Who may read.
    pub read: Access,
    /// Seconds that requests under way may take to finish after the service was told to stop.
    pub drain_seconds: f64,
    /// Bounds on what clients may ask for.
    pub limits: Limits,
    /// How refits are done.
    pub refits: Refits,
}

/// The form of log lines.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LogFormat {
    /// For people.
    Text,
    /// One JSON object a line.
    Json,
}

/// Who may do something that changes nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Access {
    /// Everybody.
    Open,
    /// Whoever has a token with the scope `read`.
    Token,
}

/// Bounds on what clients may ask for.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Limits {
    /// Bytes of a request's body; more is 413.
    pub body_bytes: usize,
    /// Bytes of an uploaded table; more is 413.
    pub upload_bytes: usize,
    /// Queries in one batch of lookups; more is 413. Bounds the answer, which is several times the request's size.
    pub batch_queries: usize,
    /// Bytes of tables, and as many again of encoded tables, that are kept in memory.
    pub cache_bytes: usize,
    /// Bytes of encoded tables that are kept in the store.
    pub derived_bytes: u64,
    /// Seconds for a request's head to arrive; then the connection is closed.
    pub header_seconds: f64,
    /// Seconds for a request's body to arrive; then 408.
    pub body_seconds: f64,
    /// Seconds for the answer to begin; then 503. An upload may take ten times as long: its errors are measured anew.
    pub request_seconds: f64,
    /// Requests under way at once; more are 503.
    pub concurrent_requests: usize,
    /// Costly requests that wait for a processor; more are 503.
    pub waiting_computations: usize,
    /// Open event streams; more are 503.
    pub event_streams: usize,
    /// Open connections; more wait to be accepted.
    pub connections: usize,
    /// Reads a second of one client (token, or else address), in bursts of as many; 0: no limit.
    pub reads_per_second: u32,
    /// Writes a second of one client, and tokens tried in vain, in bursts of five times as many; 0: no limit.
    pub writes_per_second: u32,
}

/// How refits are done.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Refits {
    /// Jobs that may wait; more are 429.
    pub queue: u64,
    /// Jobs that run at once in this process; 0 leaves them to `ltc worker`.
    pub workers: usize,
    /// Threads of a fit; 0: one for each processor.
    pub threads: usize,
    /// Bytes that a fit may take by its estimate; more is 422.
    pub memory_bytes: u64,
    /// Seconds of one core that a fit may take by its estimate; more is 422.
    pub core_seconds: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            listen: "127.0.0.1:8787".to_owned(),
            data: PathBuf::new(),
            log: "info".to_owned(),
            log_format: LogFormat::Text,
            read: Access::Open,
            drain_seconds: 10.0,
            limits: Limits::default(),
            refits: Refits::default(),
        }
    }
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            body_bytes: 2 << 20,
            upload_bytes: 64 << 20,
            batch_queries: 10_000,
            cache_bytes: 64 << 20,
            derived_bytes: 1 << 30,
            header_seconds: 15.0,
            body_seconds: 15.0,
            request_seconds: 30.0,
            concurrent_requests: 512,
            waiting_computations: 64,
            event_streams: 64,
            connections: 1024,
            reads_per_second: 0,
            writes_per_second: 10,
        }
    }
}

impl Default for Refits {
    fn default() -> Self {
        let RefitConfig { workers, threads, queue, limits, .. } = RefitConfig::default();
        Self { queue, workers, threads, memory_bytes: limits.memory, core_seconds: limits.seconds }
    }
}

impl Refits {
    pub(crate) fn config(&self) -> RefitConfig {
        let Self { queue, workers, threads, memory_bytes: memory, core_seconds: seconds } = *self;
        let limits = ltc_fit::Limits { memory, seconds };
        RefitConfig { workers, threads, queue, limits, ..RefitConfig::default() }
    }
}

/// Longest time that a setting may ask for: 10 years.
const MAX_SECONDS: f64 = 3.2e8;

impl Settings {
    /// # Errors
    /// [`SettingsError::Invalid`], naming the setting.
    pub fn validate(&self) -> Result<(), SettingsError> {
        let invalid = |name: &str, reason: &str| {
            Err(SettingsError::Invalid { name: name.to_owned(), reason: reason.to_owned() })
        };
        if let Err(cause) = self.listen.to_socket_addrs() {
            return invalid("listen", &format!("is no address to listen on: {:?}: {cause}", self.listen));
        }
        let limits = &self.limits;
        for (name, seconds, least) in [
            ("drain_seconds", self.drain_seconds, 0.0),
            ("limits.header_seconds", limits.header_seconds, 1e-3),
            ("limits.body_seconds", limits.body_seconds, 1e-3),
            ("limits.request_seconds", limits.request_seconds, 1e-3),
            ("refits.core_seconds", self.refits.core_seconds, 0.0),
        ] {
            if !(least..=MAX_SECONDS).contains(&seconds) {
                return invalid(name, &format!("must be {least} to {MAX_SECONDS} seconds, not {seconds}"));
            }
        }
        for (name, value) in [
            ("limits.body_bytes", limits.body_bytes),
            ("limits.upload_bytes", limits.upload_bytes),
            ("limits.batch_queries", limits.batch_queries),
            ("limits.concurrent_requests", limits.concurrent_requests),
            ("limits.connections", limits.connections),
        ] {
            if value == 0 {
                return invalid(name, "must be more than 0");
            }
        }
        for (name, value, most) in [
            ("limits.concurrent_requests", limits.concurrent_requests, 1 << 20),
            ("limits.connections", limits.connections, 1 << 20),
            ("limits.event_streams", limits.event_streams, 1 << 20),
            ("limits.waiting_computations", limits.waiting_computations, 1 << 20),
            ("refits.workers", self.refits.workers, 64),
            ("refits.threads", self.refits.threads, 1024),
        ] {
            if value > most {
                return invalid(name, &format!("must be at most {most}, not {value}"));
            }
        }
        Ok(())
    }

    /// As a TOML file that gives these settings.
    ///
    /// # Errors
    /// [`SettingsError::Invalid`] for a number that TOML cannot hold.
    pub fn to_toml(&self) -> Result<String, SettingsError> {
        toml::to_string(self)
            .map_err(|e| SettingsError::Invalid { name: "settings".to_owned(), reason: e.to_string() })
    }
}

impl Limits {
    pub(crate) fn header_time(&self) -> Duration {
        Duration::from_secs_f64(self.header_seconds)
    }

    pub(crate) fn body_time(&self) -> Duration {
        Duration::from_secs_f64(self.body_seconds)
    }

    pub(crate) fn request_time(&self) -> Duration {
        Duration::from_secs_f64(self.request_seconds)
    }
}
