//! Why a study could not be made.

/// What went wrong.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StudyError {
    /// Something is so wrong that its time says nothing.
    #[error("{what} is off by {error:.1e}, above {bound:.1e}: not worth timing")]
    Wrong {
        /// What.
        what: String,
        /// Its largest error.
        error: f64,
        /// What it may be.
        bound: f64,
    },
    /// The oracle gave up.
    #[error("the oracle failed: {0}")]
    Oracle(String),
    /// Something took no time that a clock could tell.
    #[error("{0} could not be timed")]
    Untimed(String),
    /// A lobe or light is not valid.
    #[error(transparent)]
    Input(#[from] ltc_core::InputError),
    /// A table failed.
    #[error(transparent)]
    Table(#[from] ltc_table::TableError),
    /// A fit failed.
    #[error(transparent)]
    Fit(#[from] ltc_fit::FitError),
    /// There is no graphics device.
    #[error("{0}")]
    NoDevice(String),
    /// A device failed.
    #[error(transparent)]
    Gpu(#[from] ltc_shade_gpu::GpuError),
    /// A picture failed.
    #[error(transparent)]
    Render(#[from] ltc_render::RenderError),
    /// A process that was to measure failed.
    #[error("a process that was to measure failed: {0}")]
    Session(String),
    /// A document is none of ours.
    #[error("not a result of `ltc bench`: {0}")]
    Document(#[from] serde_json::Error),
}

impl StudyError {
    pub(super) fn oracle(error: impl std::fmt::Display) -> Self {
        Self::Oracle(error.to_string())
    }
}
