//! Fits tables of linearly transformed cosines to BRDFs.
//!
//! [`fit`] takes a [`FitSpec`] through four stages: every entry by itself from the medians of its lobe
//! ([`entries`]), all entries together over random queries between them ([`joint`]), magnitude and Fresnel
//! ([`channels`]), and the statistics over queries that no stage has seen ([`measure`]).

use glam::DVec3;

mod bfgs;
pub mod channels;
pub mod draw;
pub mod entries;
mod entry;
mod error;
mod fit;
pub mod form;
pub mod gauge;
pub mod joint;
mod lobe;
pub mod measure;
mod nelder_mead;
pub mod objective;
mod optimiser;
pub mod path;
mod points;
mod progress;
mod regular;
mod spec;
mod start;
mod symmetry;

pub use bfgs::{Minimum, Point, Stop};
pub use entry::{EntryFit, fit_entry, refine_by, refine_by_simplex, refine_entry};
pub use error::FitError;
pub use fit::{Verification, fit, publish, verify};
pub use lobe::{Brdf, GgxFamily, Lobe};
pub use objective::{Goal, Objective, total_variation, total_variation_gradient};
pub use optimiser::Optimiser;
pub use points::DiskPoints;
pub use progress::{Observer, Progress, silent};
pub use spec::FitSpec;
pub use start::median_start;
pub use symmetry::{Lattice, Node, Pattern, Tie};

/// The unit direction of polar angle `theta` and azimuth `phi`.
pub fn direction(theta: f64, phi: f64) -> DVec3 {
    let ((st, ct), (sp, cp)) = (theta.sin_cos(), phi.sin_cos());
    DVec3::new(st * cp, st * sp, ct)
}
