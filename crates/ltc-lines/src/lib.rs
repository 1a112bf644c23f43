//! The lines of `ltc lookup` and `ltc integrate`: what a line of JSON asks, and its answer. No input and output of its own, so
//! that tests and fuzzers reach every word of it.
//!
//! Whatever the line, there is an answer or one line of text that says what is wrong with it.

mod integrate;
mod light;
mod lookup;
mod object;

pub use integrate::{Answer, Integration};
pub use light::LightLine;
pub use lookup::lookup;
pub use object::object;
