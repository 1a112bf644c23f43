//! Points and numbers for this crate's tests.

use glam::DVec3;

/// The unit direction of polar angle `theta` and azimuth `phi`.
pub fn direction(theta: f64, phi: f64) -> DVec3 {
    DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos())
}

/// Point `i` of the R2 sequence.
pub fn r2(i: usize) -> [f64; 2] {
    crate::points::r2(i, [0.5, 0.5])
}

/// Uniform numbers in [0, 1) from a seed.
pub fn random(seed: u64) -> impl FnMut() -> f64 {
    let mut rng = crate::points::SplitMix64::new(seed);
    move || rng.unit()
}
