//! The service's contract, asked through its router and over real connections.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod again;
mod aliases;
mod auth;
mod benchmarks;
mod caching;
mod data;
mod diffs;
mod encoding;
mod errors;
mod limits;
mod lists;
mod lookup;
mod openapi;
mod ranges;
mod refits;
mod service;
mod shaders;
mod socket;
mod support;
mod uploads;
