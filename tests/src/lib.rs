//! Cross-crate tests: one body over CPU f64, CPU f32 and GPU.
