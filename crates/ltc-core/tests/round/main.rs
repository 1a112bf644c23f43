//! Disk, ellipse, sphere and cylinder lights: against cubature, textbooks, each other, and every degenerate configuration.

mod exact;
mod hazards;
mod invariance;
mod sampling;
mod single;
mod support;
mod textbook;
