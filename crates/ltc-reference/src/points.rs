//! Deterministic points in the unit square, and a small seeded generator.

use std::f64::consts::TAU;

use glam::{DVec3, dvec3};

/// 2⁻⁵³, the spacing of the numbers that [`unit_interval`] makes.
const ULP: f64 = 1.0 / (1u64 << 53) as f64;

/// The top 53 bits of `bits` as a number in [0, 1).
fn unit_interval(bits: u64) -> f64 {
    (bits >> 11) as f64 * ULP
}

/// The R2 sequence (Roberts 2018): `point(i) = frac(offset + i · (1/g, 1/g²))`, g the real root of g³ = g + 1.
///
/// Its discrepancy falls nearly as 1/n for every n. Integer arithmetic keeps it exact for any index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct R2 {
    offset: [u64; 2],
}

impl R2 {
    /// 1/g in units of 2⁻⁶⁴.
    const STEP_X: u64 = 0xC13F_A9A9_02A6_328F;
    /// 1/g² in units of 2⁻⁶⁴.
    const STEP_Y: u64 = 0x91E1_0DA5_C79E_7B1D;

    /// The sequence with the classical offset of one half.
    pub fn new() -> Self {
        Self { offset: [1 << 63; 2] }
    }

    /// The sequence shifted (modulo 1) by an offset drawn from `seed`: an unbiased estimator for each seed.
    pub fn shifted(seed: u64) -> Self {
        let mut random = SplitMix64::new(seed);
        Self { offset: [random.next_u64(), random.next_u64()] }
    }

    /// Point number `index`, in [0, 1)².
    pub fn point(&self, index: u64) -> [f64; 2] {
        let [x, y] = self.offset;
        [
            unit_interval(x.wrapping_add(index.wrapping_mul(Self::STEP_X))),
            unit_interval(y.wrapping_add(index.wrapping_mul(Self::STEP_Y))),
        ]
    }
}

impl Default for R2 {
    fn default() -> Self {
        Self::new()
    }
}

/// SplitMix64 (Steele, Lea, Flood 2014): a seeded generator for Monte Carlo, period 2⁶⁴.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SplitMix64 {
    state: u64,
}

impl SplitMix64 {
    /// The generator that starts at `seed`.
    pub fn new(seed: u64) -> Self {
        Self { state: seed }
    }

    /// The next 64 bits.
    pub fn next_u64(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// The next number in [0, 1).
    pub fn next_f64(&mut self) -> f64 {
        unit_interval(self.next_u64())
    }

    /// The next point in [0, 1)².
    pub fn next_2d(&mut self) -> [f64; 2] {
        [self.next_f64(), self.next_f64()]
    }
}

/// A direction of the upper hemisphere with density `cos θ / π`, from a point of [0, 1)².
pub fn cosine_direction(u: [f64; 2]) -> DVec3 {
    let (sin_phi, cos_phi) = (TAU * u[1]).sin_cos();
    let radius = u[0].sqrt();
    dvec3(radius * cos_phi, radius * sin_phi, (1.0 - u[0]).max(0.0).sqrt())
}

/// A direction of the whole sphere with density `1 / 4π`, from a point of [0, 1)².
pub fn sphere_direction(u: [f64; 2]) -> DVec3 {
    let (sin_phi, cos_phi) = (TAU * u[1]).sin_cos();
    let z = 1.0 - 2.0 * u[0];
    let radius = ((1.0 - z) * (1.0 + z)).max(0.0).sqrt();
    dvec3(radius * cos_phi, radius * sin_phi, z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_the_powers_of_the_plastic_number() {
        let x = unit_interval(R2::STEP_X);
        let y = unit_interval(R2::STEP_Y);
        let g = 1.0 / x;
        assert!((g * g * g - g - 1.0).abs() < 1e-14);
        assert!((y - x * x).abs() < 1e-15);
    }

    #[test]
    fn r2_beats_random_points_on_a_smooth_integral() {
        let f = |[x, y]: [f64; 2]| x * x * y;
        let n = 4096;
        let r2 = R2::shifted(3);
        let low: f64 = (0..n).map(|i| f(r2.point(i))).sum::<f64>() / n as f64;
        let mut random = SplitMix64::new(3);
        let high: f64 = (0..n).map(|_| f(random.next_2d())).sum::<f64>() / n as f64;
        assert!((low - 1.0 / 6.0).abs() < 5e-4, "{low}");
        // The generator's error is that of Monte Carlo: there, but not more than five standard deviations.
        assert!((high - 1.0 / 6.0).abs() < 5.0 * 0.2 / (n as f64).sqrt(), "{high}");
    }
}
