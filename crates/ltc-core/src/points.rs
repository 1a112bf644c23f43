//! Deterministic points and numbers: everything random in the workspace has a seed and is the same everywhere.

/// Point `i` of the R2 low-discrepancy sequence in [0, 1)², started at `shift`.
///
/// `(shift + (i + 1) / g, shift + (i + 1) / g²) mod 1` with g the plastic number, the root of `g³ = g + 1` (Roberts 2018).
pub fn r2(i: usize, shift: [f64; 2]) -> [f64; 2] {
    const G: f64 = 1.324_717_957_244_746;
    let n = (i + 1) as f64;
    [(shift[0] + n / G).fract(), (shift[1] + n / (G * G)).fract()]
}

/// SplitMix64 (Steele et al. 2014): a seeded generator whose numbers never change between versions or machines.
#[derive(Clone, Debug)]
pub struct SplitMix64 {
    state: u64,
}

impl SplitMix64 {
    /// The generator of this seed.
    pub fn new(seed: u64) -> Self {
        Self { state: seed }
    }

    /// The seed of a generator that goes on as this one will.
    pub fn seed(&self) -> u64 {
        self.state
    }

    /// The next 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Uniform in [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Uniform in [low, high).
    pub fn range(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_generator_goes_on_from_its_seed() {
        let mut rng = SplitMix64::new(5);
        rng.bits();
        let mut again = SplitMix64::new(rng.seed());
        assert_eq!(again.bits(), rng.bits());
    }

    #[test]
    fn numbers_never_change() {
        let mut rng = SplitMix64::new(0);
        assert_eq!(rng.bits(), 0xE220_A839_7B1D_CDAF, "the reference value of the algorithm");
        assert!((0..1000).all(|_| (2.0..3.0).contains(&rng.range(2.0, 3.0))));
    }

    #[test]
    fn points_fill_the_square_evenly() {
        let mut counts = [0; 16];
        for i in 0..1600 {
            let [u, v] = r2(i, [0.5, 0.5]);
            counts[(u * 4.0) as usize * 4 + (v * 4.0) as usize] += 1;
        }
        assert!(counts.iter().all(|c| (95..=105).contains(c)), "{counts:?}");
    }
}
