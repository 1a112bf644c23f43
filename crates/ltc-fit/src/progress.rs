//! What a running fit tells, and how it is told to stop.

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
