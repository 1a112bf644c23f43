//! Distributions against `ltc-reference`: densities, samples, integrals over polygons.

mod medians;
mod mixture;
mod polygons;
mod robustness;
mod sampling;
mod support;
