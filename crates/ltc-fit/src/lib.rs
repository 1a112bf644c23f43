//! Fits tables of linearly transformed cosines to BRDFs.
//!
//! [`fit`] takes a [`FitSpec`] through four stages: every entry by itself from the medians of its lobe
//! ([`entries`]), all entries together over random queries between them ([`joint`]), magnitude and Fresnel
//! ([`channels`]), and the statistics over queries that no stage has seen ([`measure`]).
//!
//! It does so piece by piece ([`FitRun`]): between any two pieces its state can be written down, and the fit goes on from
//! it in another process ([`checkpoint`]) to the very same table. Specifications are read from TOML ([`spec_file`]).

mod albedo;
mod bfgs;
pub mod brdf;
pub mod channels;
pub mod checkpoint;
pub mod diff;
pub mod draw;
pub mod entries;
mod entry;
mod error;
mod fit;
mod forecast;
pub mod form;
pub mod gauge;
pub mod grid_errors;
pub mod joint;
mod layout;
mod lobe;
pub mod measure;
mod measurement;
mod nelder_mead;
pub mod objective;
mod optimiser;
pub mod path;
mod pieces;
mod plan;
mod points;
pub mod progress;
mod regular;
pub mod report;
mod run;
mod spec;
pub mod spec_file;
mod start;
mod symmetry;
mod verify;

pub use albedo::{DiskNode, DiskRule};
pub use bfgs::{Point, Stop};
pub use brdf::{Beckmann, Brdf, CharlieSheen, DisneyDiffuse, GgxFamily, OrenNayar};
pub use entry::{EntryFit, fit_entry, refine_by, refine_by_simplex, refine_entry};
pub use error::FitError;
pub use fit::{fit, fit_with, publish, publish_with};
pub use forecast::{Forecast, Outlook};
pub use layout::{Layout, Reader};
pub use lobe::Lobe;
pub use ltc_table::direction;
pub use objective::{Goal, Objective, total_variation, total_variation_gradient};
pub use optimiser::Optimiser;
pub use plan::{Cost, Limits, Plan};
pub use points::DiskPoints;
pub use progress::{Observer, Progress, silent};
pub use report::FitReport;
pub use run::{EntryRecord, FitRun, FitState, Fitted, StageTime};
pub use spec::FitSpec;
pub use start::median_start;
pub use symmetry::{Lattice, Node, Pattern, Tie};
pub use verify::{Verification, refit_digest, refit_plan, verify, verify_with};
