//! What a running fit tells, and how it is told to stop.

/// The stage of [`crate::entries`].
pub const ENTRIES: &str = "entries";
/// The stage of [`crate::joint`].
pub const JOINT: &str = "joint refinement";
/// The stage of [`crate::channels`].
pub const CHANNELS: &str = "magnitude and Fresnel";
/// The stage of [`crate::measure`].
pub const MEASUREMENT: &str = "measurement";

/// The stage of [`crate::report`].
pub const REPORT: &str = "report";

/// A report from a running fit.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// What is being done.
    pub stage: &'static str,
    /// Units of the stage done.
    pub done: usize,
    /// Units of the stage in all.
    pub total: usize,
    /// Mean total variation at present, where the stage knows it.
    pub tv: Option<f64>,
}

/// Receives reports; returns `false` to stop the fit.
pub type Observer<'a> = &'a (dyn Fn(Progress) -> bool + Sync);

/// The observer that listens to nothing.
pub fn silent(_: Progress) -> bool {
    true
}
