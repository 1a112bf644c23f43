//! Points and numbers for this crate's tests.

use glam::DVec3;

/// The unit direction of polar angle `theta` and azimuth `phi`.
pub fn direction(theta: f64, phi: f64) -> DVec3 {
    DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos())
}

/// Point `i` of the R2 low-discrepancy sequence.
pub fn r2(i: usize) -> [f64; 2] {
    let g = 1.324_717_957_244_746;
    [1.0 / g, 1.0 / (g * g)].map(|step| (0.5 + (i + 1) as f64 * step).fract())
}

/// Uniform numbers in [0, 1) from a seed (SplitMix64).
pub fn random(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}
