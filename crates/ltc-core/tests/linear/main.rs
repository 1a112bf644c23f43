//! Linear lights: lines, thin cylinders and strips, against the integrals that define them.

mod draw;
mod oracle;
mod single;
