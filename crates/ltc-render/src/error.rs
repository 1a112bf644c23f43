//! What can go wrong with a scene or a picture.

use std::fmt;

use ltc_core::InputError;
use ltc_reference::ReferenceError;
use ltc_table::TableError;

/// A scene that makes no sense: which field, and what is wrong with it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneError {
    /// The path of the field, for example `objects[2].radius`.
    pub field: String,
    /// What is wrong, for example `is -1, must be above 0`.
    pub problem: String,
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.field, self.problem)
    }
}

impl std::error::Error for SceneError {}

/// Why there is no picture.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RenderError {
    /// The scene file could not be read.
    #[error("{path}: {source}")]
    Read {
        /// Which file.
        path: String,
        /// Why.
        source: std::io::Error,
    },
    /// The scene file is not JSON, or not that of a scene.
    #[error("{path}: {source}")]
    Json {
        /// Which file.
        path: String,
        /// Where and why.
        source: serde_json::Error,
    },
    /// The scene makes no sense.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// An option is out of its range.
    #[error("{name} is {value}, must be {must}")]
    Option {
        /// Which option.
        name: &'static str,
        /// Its value.
        value: String,
        /// What it must be.
        must: &'static str,
    },
    /// The file name's extension is not one of a picture's.
    #[error("{path}: unknown picture format, the file name must end in .png or .exr")]
    UnknownFormat {
        /// Which file.
        path: String,
    },
    /// The picture could not be written.
    #[error(transparent)]
    Write(TableError),
    /// The picture could not be encoded.
    #[error("cannot encode the picture as {format}: {reason}")]
    Encode {
        /// PNG or EXR.
        format: &'static str,
        /// Why.
        reason: String,
    },
    /// The tables are of the wrong kind or refuse a lookup.
    #[error(transparent)]
    Table(#[from] TableError),
    /// A table of the other kind was given.
    #[error("the table given as {expected} is not")]
    WrongTable {
        /// `isotropic` or `anisotropic`.
        expected: &'static str,
    },
    /// A number that the mathematics refuses.
    #[error(transparent)]
    Input(#[from] InputError),
    /// The reference integrator refused its input.
    #[error(transparent)]
    Reference(#[from] ReferenceError),
    /// The GPU failed.
    #[cfg(feature = "gpu")]
    #[error(transparent)]
    Gpu(#[from] ltc_shade_gpu::GpuError),
    /// The program was built without the GPU back end.
    #[error("this build has no GPU back end; use the cpu or reference back end")]
    NoGpuBackend,
}
