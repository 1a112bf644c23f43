//! Disk, ellipse, sphere and cylinder lights: against cubature, textbooks, each other, and every degenerate configuration.

#![expect(clippy::unwrap_used, reason = "a test fails by a panic")]

mod exact;
mod hazards;
mod invariance;
mod sampling;
mod single;
mod support;
mod textbook;
