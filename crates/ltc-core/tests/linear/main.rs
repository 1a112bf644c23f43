//! Linear lights: lines, thin cylinders and strips, against the integrals that define them.

#![expect(clippy::unwrap_used, reason = "a test fails by a panic")]

mod draw;
mod errata;
mod hazards;
mod oracle;
mod properties;
mod sampling;
mod single;
mod true_shapes;
