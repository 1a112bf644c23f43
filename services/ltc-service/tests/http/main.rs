//! The service's contract, asked through its router and over real connections.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod caching;
mod data;
mod errors;
mod lists;
mod lookup;
mod ranges;
mod socket;
mod support;
