//! Ctrl-C and its relatives: the first asks for an end, the second makes it.

use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use anyhow::{Context, Result};
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

/// Signals that ask for an end.
#[cfg(unix)]
const SIGNALS: [i32; 3] = [SIGINT, SIGTERM, signal_hook::consts::SIGHUP];
/// Signals that ask for an end.
#[cfg(not(unix))]
const SIGNALS: [i32; 2] = [SIGINT, SIGTERM];

/// Whether somebody asked for an end.
pub struct Watch {
    signal: Arc<AtomicUsize>,
}

impl Watch {
    /// From now on the first signal is only noted; the second ends the process on the spot, as the first did before.
    pub fn new() -> Result<Self> {
        let (asked, signal) = (Arc::new(AtomicBool::new(false)), Arc::new(AtomicUsize::new(0)));
        for number in SIGNALS {
            // In this order: the second signal finds the flag of the first.
            flag::register_conditional_shutdown(number, 128 + number, Arc::clone(&asked))
                .and_then(|_| flag::register(number, Arc::clone(&asked)))
                .and_then(|_| flag::register_usize(number, Arc::clone(&signal), number as usize))
                .context("cannot listen for Ctrl-C")?;
        }
        Ok(Self { signal })
    }

    /// Whether a signal came.
    pub fn asked(&self) -> bool {
        self.signal.load(Ordering::Relaxed) != 0
    }

    /// The error that ends the program, in these words.
    pub fn interrupted(&self, what_now: String) -> Interrupted {
        Interrupted { signal: self.signal.load(Ordering::Relaxed), what_now }
    }
}

/// Ended because somebody asked for it.
#[derive(Debug)]
pub struct Interrupted {
    signal: usize,
    what_now: String,
}

impl Interrupted {
    /// 128 and the signal's number, as a shell has it: 130 for Ctrl-C.
    pub fn exit_code(&self) -> ExitCode {
        ExitCode::from(u8::try_from(128 + self.signal).unwrap_or(130))
    }
}

impl std::fmt::Display for Interrupted {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(out, "interrupted; {}", self.what_now)
    }
}

impl std::error::Error for Interrupted {}
