//! A device and random numbers for the tests.

use ltc_shade_gpu::{Filtering, Gpu, GpuError, GpuOptions};

/// A device, or `None` with a word about it where there is none, or none that can filter so. With `CI` set, a missing device
/// fails the test.
pub fn gpu(filtering: Filtering) -> Option<Gpu> {
    match Gpu::new(GpuOptions { filtering, ..GpuOptions::default() }) {
        Ok(gpu) => {
            eprintln!("on {}", gpu.info());
            Some(gpu)
        }
        Err(error @ GpuError::NotFilterable { .. }) => {
            eprintln!("skipped, because {error}");
            None
        }
        Err(error @ GpuError::NoAdapter { .. }) => {
            assert!(std::env::var_os("CI").is_none(), "{error}");
            eprintln!("skipped, because no GPU adapter can run this: {error}");
            None
        }
        Err(error) => panic!("{error}"),
    }
}

/// SplitMix64 (Steele, Lea, Flood 2014), as numbers in [0, 1).
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
