//! Linear lights: lines, thin cylinders and strips, against the integrals that define them.

mod draw;
mod errata;
mod oracle;
mod single;
mod true_shapes;
