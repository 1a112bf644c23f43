//! Any bytes as a lobe and a light: the answer is a fraction, in both precisions.
#![no_main]

use libfuzzer_sys::fuzz_target;
use ltc_core::{Horizon, Ltc, Matrix, Real};

#[path = "../../crates/ltc-core/tests/adversarial/generator.rs"]
mod generator;

fn check<R: Real>(input: &generator::Input) {
    let Ok(ltc) = Ltc::<R>::new(R::Mat3::from_row_array(input.m.map(R::of))) else { return };
    let Ok(value) = input.light.integrate(&ltc, Horizon::BOTH) else { return };
    let value = value.to_f64();
    assert!((0.0..=1.0).contains(&value), "{value} for {input:?}");
    assert!(!input.is_nothing || value == 0.0, "{value} for {input:?}");
}

fuzz_target!(|bytes: &[u8]| {
    let mut words = bytes.chunks(8).map(|chunk| {
        let mut word = [0; 8];
        word[..chunk.len()].copy_from_slice(chunk);
        u64::from_le_bytes(word)
    });
    let mut next = move || words.next().unwrap_or(0);
    let nothing = next() % 8 == 0;
    let mut generator = generator::Generator::new(&mut next);
    let input = if nothing { generator.nothing() } else { generator.input() };
    check::<f64>(&input);
    check::<f32>(&input);
});
