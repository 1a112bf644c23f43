//! Ctrl-C and its relatives, as a question that can be asked at any time.
//!
//! Children run in process groups of their own (see [`crate::process`]), so a signal reaches only this process. Whoever
//! waits for a child asks [`pending`] while waiting, stops the child's whole group, and reports [`Interrupted`].

use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};

use anyhow::{Context as _, Result};

/// The person, or the machine, asked for an end.
#[derive(Debug)]
pub struct Interrupted;

impl fmt::Display for Interrupted {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "interrupted")
    }
}

impl std::error::Error for Interrupted {}

static ASKED: OnceLock<Arc<AtomicBool>> = OnceLock::new();

/// From now on a signal that asks for an end sets a flag in place of ending this process on the spot.
pub fn watch() -> Result<()> {
    use signal_hook::consts::{SIGINT, SIGTERM};
    let asked = ASKED.get_or_init(Arc::default);
    #[cfg(unix)]
    let signals = [SIGINT, SIGTERM, signal_hook::consts::SIGHUP];
    #[cfg(not(unix))]
    let signals = [SIGINT, SIGTERM];
    for signal in signals {
        signal_hook::flag::register(signal, Arc::clone(asked)).context("cannot listen for Ctrl-C")?;
    }
    Ok(())
}

/// Whether an end was asked for.
pub fn pending() -> bool {
    ASKED.get().is_some_and(|asked| asked.load(Ordering::Relaxed))
}

/// As [`pending`], and forgets it: asked again, it tells whether there was one more signal since.
pub fn take() -> bool {
    ASKED.get().is_some_and(|asked| asked.swap(false, Ordering::Relaxed))
}

/// An error when an end was asked for: for the gaps between two children.
pub fn check() -> Result<()> {
    if pending() { Err(Interrupted.into()) } else { Ok(()) }
}
