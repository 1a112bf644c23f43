//! The GPU against the CPU. Runs on any adapter, a software driver included; skips where there is none, unless `CI` is set.

#![expect(clippy::unwrap_used, reason = "a test fails by a panic")]

mod forward;
mod lookups;
mod polygons;
mod shading;
mod support;
mod tables;
mod timing;
