//! NumPy's default generator, as far as the draws of the first measured baselines need it.

/// PCG64 (O'Neill 2014, XSL-RR) seeded through NumPy's `SeedSequence`, as `numpy.random.default_rng(seed)`.
pub struct DefaultRng {
    state: u128,
    increment: u128,
}

const MULTIPLIER: u128 = 0x2360_ED05_1FC6_5DA4_4385_DF64_9FCC_F645;

impl DefaultRng {
    /// `default_rng(seed)`
    pub fn new(seed: u32) -> Self {
        let words = seed_words(seed);
        let wide = |high: usize| {
            let word = |i: usize| u128::from(words[i]) | u128::from(words[i + 1]) << 32;
            word(high) << 64 | word(high + 2)
        };
        let increment = wide(4) << 1 | 1;
        let mut rng = Self { state: 0, increment };
        rng.step();
        rng.state = rng.state.wrapping_add(wide(0));
        rng.step();
        rng
    }

    fn step(&mut self) {
        self.state = self.state.wrapping_mul(MULTIPLIER).wrapping_add(self.increment);
    }

    /// `random()`
    pub fn unit(&mut self) -> f64 {
        self.step();
        let folded = (self.state >> 64) as u64 ^ self.state as u64;
        let bits = folded.rotate_right((self.state >> 122) as u32);
        (bits >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// `uniform(low, high, count)`
    pub fn uniform(&mut self, low: f64, high: f64, count: usize) -> Vec<f64> {
        (0..count).map(|_| low + (high - low) * self.unit()).collect()
    }
}

/// `SeedSequence(seed).generate_state(8, uint32)`
fn seed_words(seed: u32) -> [u32; 8] {
    let mut constant = 0x43b0_d7e5_u32;
    let mut hashed = |value: u32| {
        let mixed = value ^ constant;
        constant = constant.wrapping_mul(0x931e_8875);
        let product = mixed.wrapping_mul(constant);
        product ^ product >> 16
    };
    let mut pool = [seed, 0, 0, 0].map(&mut hashed);
    for source in 0..4 {
        for target in 0..4 {
            if source != target {
                let other = hashed(pool[source]);
                let mixed =
                    pool[target].wrapping_mul(0xca01_f9dd).wrapping_sub(other.wrapping_mul(0x4973_f715));
                pool[target] = mixed ^ mixed >> 16;
            }
        }
    }
    let mut constant = 0x8b51_f9dd_u32;
    core::array::from_fn(|i| {
        let mixed = pool[i % 4] ^ constant;
        constant = constant.wrapping_mul(0x58f3_8ded);
        let product = mixed.wrapping_mul(constant);
        product ^ product >> 16
    })
}
