//! Why a fit was refused or did not end well.

use ltc_core::InputError;
use ltc_table::TableError;

use crate::plan::Limits;

/// Why there is no table.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FitError {
    /// A field of the specification makes no sense.
    #[error("{field}: {reason}")]
    Spec {
        /// Which field.
        field: &'static str,
        /// What is wrong with it.
        reason: String,
    },
    /// There is no such preset.
    #[error("no preset named \"{name}\"; there are: {known}")]
    NoSuchPreset {
        /// The name asked for.
        name: String,
        /// The names there are.
        known: String,
    },
    /// The BRDF gave something that is no BRDF.
    #[error("BRDF \"{name}\": {what} is {value}, at theta {theta}, alpha {alpha_x}, {alpha_y}")]
    Brdf {
        /// Its name.
        name: &'static str,
        /// What was asked of it.
        what: &'static str,
        /// What it said.
        value: f64,
        /// Polar angle of the view, radians.
        theta: f64,
        /// Width along the tangent.
        alpha_x: f64,
        /// Width along the bitangent.
        alpha_y: f64,
    },
    /// The fit would take more memory or time than it may.
    #[error(
        "{entries} entries would take about {} of memory and {} on one core; the limits are {} and {}",
        bytes(*memory), duration(*seconds), bytes(limits.memory), duration(limits.seconds)
    )]
    TooLarge {
        /// Entries of the table.
        entries: u64,
        /// Memory that it would take, bytes.
        memory: u64,
        /// Seconds of one core that it would take.
        seconds: f64,
        /// What it may take.
        limits: Limits,
    },
    /// A state is of another fit.
    #[error("the state is not one of this fit: {what}")]
    State {
        /// What does not fit.
        what: &'static str,
    },
    /// The observer asked the fit to stop.
    #[error("stopped before the table was complete; nothing was written")]
    Stopped,
    /// A number is out of range.
    #[error(transparent)]
    Input(#[from] InputError),
    /// The result is no valid table.
    #[error(transparent)]
    Table(#[from] TableError),
}

fn bytes(count: u64) -> String {
    const MIB: u64 = 1 << 20;
    if count < 10 << 30 { format!("{} MiB", count.div_ceil(MIB)) } else { format!("{} GiB", count >> 30) }
}

fn duration(seconds: f64) -> String {
    if seconds < 120.0 {
        format!("{seconds:.0} s")
    } else if seconds < 7200.0 {
        format!("{:.0} min", seconds / 60.0)
    } else {
        format!("{:.0} h", seconds / 3600.0)
    }
}
