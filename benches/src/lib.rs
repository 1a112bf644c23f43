//! Run time against error: the benches are in `benches/`; run them with `cargo bench -p ltc-benches`.

mod double_double;
pub mod stability;

pub use double_double::DoubleDouble;
