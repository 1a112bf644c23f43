//! Where a study ran.

use serde::{Deserialize, Serialize};

/// A machine, as far as times depend on it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Machine {
    /// The processor's own name for itself.
    pub cpu: String,
    /// Threads that may run at once.
    pub threads: usize,
    /// Operating system and architecture.
    pub system: String,
    /// What the program was compiled for and how.
    pub build: String,
    /// Runnable processes a minute before the run, where the system tells: above 1, somebody else was at work.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub load: Option<f64>,
    /// The graphics device that frames were shaded on, where there was one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gpu: Option<String>,
}
