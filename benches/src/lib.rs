//! Run time against error: the study behind `ltc bench` ([`study`]), the errors of rounding over wide sweeps ([`stability`]),
//! and Criterion benches of single functions in `benches/` (`cargo bench -p ltc-benches`).

mod double_double;
mod ready;
pub mod stability;
pub mod study;

pub use double_double::DoubleDouble;
