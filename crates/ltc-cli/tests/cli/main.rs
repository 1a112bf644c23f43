//! The binary `ltc`, run as a user runs it.

#![expect(clippy::unwrap_used, reason = "a test fails by a panic")]

mod bench;
mod export;
mod fit;
mod help;
mod lines;
mod probe;
mod render;
#[cfg(unix)]
mod resume;
#[cfg(unix)]
mod serve;
mod shader;
mod store;
mod support;
mod tables;
