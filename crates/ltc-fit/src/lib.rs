//! Fits tables of linearly transformed cosines to BRDFs.
//!
//! [`fit`] takes a [`FitSpec`] through four stages: every entry by itself from the medians of its lobe
//! ([`entries`]), all entries together over random queries between them ([`joint`]), magnitude and Fresnel
//! ([`channels`]), and the statistics over queries that no stage has seen ([`measure`]).

use glam::DVec3;

mod albedo;
mod bfgs;
pub mod channels;
pub mod draw;
pub mod entries;
mod entry;
mod error;
mod fit;
pub mod gauge;
pub mod joint;
mod layout;
mod lobe;
pub mod measure;
mod points;
mod progress;
mod regular;
mod spec;
mod start;
mod symmetry;
mod tv;

pub use albedo::{DiskNode, DiskRule};
pub use bfgs::Stop;
pub use entry::{EntryFit, fit_entry, refine_entry};
pub use error::FitError;
pub use fit::{Verification, fit, publish, verify};
pub use layout::{Layout, Reader};
pub use lobe::{Brdf, GgxFamily, Lobe};
pub use points::DiskPoints;
pub use progress::{Observer, Progress, silent};
pub use spec::FitSpec;
pub use start::median_start;
pub use symmetry::{Lattice, Node, Pattern, Tie};
pub use tv::{total_variation, total_variation_gradient};

/// The unit direction of polar angle `theta` and azimuth `phi`.
pub fn direction(theta: f64, phi: f64) -> DVec3 {
    let ((st, ct), (sp, cp)) = (theta.sin_cos(), phi.sin_cos());
    DVec3::new(st * cp, st * sp, ct)
}
