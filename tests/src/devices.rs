//! The devices that can run here.

use ltc_shade_gpu::{Gpu, GpuError, GpuOptions};

/// A device of each kind of driver that can run here, with what `make` makes on it: of what wgpu finds by itself, and of GL.
/// Says aloud which there is not.
///
/// # Panics
/// For any other fault of a device, and without any device where `CI` is set.
pub(crate) fn on_each_device<T>(make: impl Fn(&Gpu) -> Result<T, GpuError>) -> Vec<(Gpu, T)> {
    let mut found: Vec<(Gpu, T)> = Vec::new();
    for backend in [None, Some("gl")] {
        match Gpu::new(GpuOptions { backend, ..GpuOptions::default() }) {
            Ok(gpu) if found.iter().any(|(other, _)| other.info() == gpu.info()) => {}
            Ok(gpu) => match make(&gpu) {
                Ok(made) => found.push((gpu, made)),
                Err(error) => panic!("{}: {error}", gpu.info()),
            },
            Err(error @ GpuError::NoAdapter { .. }) => {
                let back_end = backend.unwrap_or("GPU");
                println!("{back_end} skipped, because no adapter can run this: {error}");
            }
            Err(error) => panic!("{error}"),
        }
    }
    assert!(!found.is_empty() || std::env::var_os("CI").is_none(), "no GPU, and CI is set");
    found
}
