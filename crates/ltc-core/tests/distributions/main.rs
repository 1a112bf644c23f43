//! Distributions against `ltc-reference`: densities, samples, integrals over polygons.

#![expect(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

mod medians;
mod mixture;
mod polygons;
mod robustness;
mod sampling;
mod support;
