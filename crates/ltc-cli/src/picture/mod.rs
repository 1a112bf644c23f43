//! Pictures of tables.

mod canvas;
mod colour_scale;
mod error_map;
mod heat_map;

pub use error_map::error_map;
