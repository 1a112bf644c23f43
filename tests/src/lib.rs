//! Cross-crate tests: one body over CPU f64, CPU f32 and GPU.
//!
//! What the tests in `tests/` share: the [`BackEnd`]s, the jobs that all of them get ([`Job`], [`pairs()`]), the shapes
//! that hazards are made of ([`shapes`]), and the tolerances, each named once and justified ([`tolerance`]).

mod back_end;
mod devices;
mod job;
mod lean;
mod lights;
pub mod make;
mod pairs;
pub mod shapes;
mod textured;
pub mod tolerance;

pub use back_end::{BackEnd, CpuF32, CpuF64, Gpu, Path};
pub use job::Job;
pub use lean::{LeanLights, lean_lights};
pub use lights::{
    LightBackEnd, LightsF32, LightsF64, LightsOnGpu, condition, light_back_ends, light_jobs, matrix,
};
pub use pairs::{lit, lit_share, pairs, wide};
pub use textured::{
    TexturedBackEnd, TexturedOnCpu, TexturedOnGpu, texture, textured_back_ends, textured_jobs,
    textured_matrix, textures,
};

use ltc_table::{Catalogue, Table};

/// The shipped tables.
///
/// # Panics
/// When an embedded table is damaged: no test can go on then.
pub fn shipped() -> Catalogue {
    match ltc_tables::shipped() {
        Ok(catalogue) => catalogue,
        Err(error) => panic!("a shipped table is damaged: {error}"),
    }
}

/// The latest version of a shipped table.
///
/// # Panics
/// When there is none of that name.
pub fn table(name: &str) -> Table {
    match shipped().find(name) {
        Ok(version) => version.table().clone(),
        Err(error) => panic!("{error}"),
    }
}
