//! The pixels that programs write.

use wgpu::{BufferUsages, TextureFormat, TextureUsages};

use crate::compute::{UNWRITTEN, read_back};
use crate::{Gpu, GpuError};

/// What is drawn into: four floats a pixel, as the compute stage writes.
pub(super) const TARGET: TextureFormat = TextureFormat::Rgba32Float;
/// Rows of what is copied to a buffer begin at multiples of this.
const ROW: u32 = wgpu::COPY_BYTES_PER_ROW_ALIGNMENT;

/// A grid of pixels, four floats each: a storage buffer for the compute stage and a texture for the fragment stage. All
/// programs share it.
#[derive(Debug)]
pub struct PixelGrid {
    width: u32,
    height: u32,
    pub(super) buffer: wgpu::Buffer,
    /// Where the device draws into floats.
    target: Option<Target>,
}

#[derive(Debug)]
struct Target {
    texture: wgpu::Texture,
    view: wgpu::TextureView,
}

impl Target {
    /// None where the device does not draw into floats, as GL without extensions.
    fn new(gpu: &Gpu, width: u32, height: u32) -> Option<Self> {
        if !gpu.draws_floats() {
            return None;
        }
        let texture = gpu.device().create_texture(&wgpu::TextureDescriptor {
            label: Some("ltc pixels"),
            size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: TARGET,
            usage: TextureUsages::RENDER_ATTACHMENT | TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let view = texture.create_view(&Default::default());
        Some(Self { texture, view })
    }
}

impl PixelGrid {
    /// A grid of this size.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`] for one that no buffer of the device holds, [`GpuError::TableTooLarge`] for one wider or higher
    /// than its textures, [`GpuError::Device`].
    pub fn new(gpu: &Gpu, width: u32, height: u32) -> Result<Self, GpuError> {
        let limits = gpu.device().limits();
        for (what, found) in [("picture's width", width), ("picture's height", height)] {
            let limit = limits.max_texture_dimension_2d;
            if found == 0 || found > limit {
                return Err(GpuError::TableTooLarge { what, found, limit });
            }
        }
        let bytes = 16 * u64::from(width) * u64::from(height);
        let limit = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
        if bytes > limit {
            return Err(GpuError::TooLarge { what: "an output buffer", bytes, limit });
        }
        gpu.checked(|| {
            let buffer = gpu.device().create_buffer(&wgpu::BufferDescriptor {
                label: Some("ltc pixels"),
                size: bytes,
                usage: BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST,
                mapped_at_creation: false,
            });
            Ok(Self { width, height, buffer, target: Target::new(gpu, width, height) })
        })
    }

    /// Pixels in a row.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Number of pixels.
    pub fn count(&self) -> usize {
        self.width as usize * self.height as usize
    }

    /// Fills the buffer with what no program writes.
    pub(super) fn spoil(&self, gpu: &Gpu) {
        let words = vec![UNWRITTEN; 4 * self.count()];
        gpu.queue().write_buffer(&self.buffer, 0, bytemuck::cast_slice(&words));
    }

    pub(super) fn read_buffer(&self, gpu: &Gpu) -> Result<Vec<u32>, GpuError> {
        read_back(gpu, &self.buffer)
    }

    /// What the fragment stage draws into.
    pub(super) fn view(&self) -> Option<&wgpu::TextureView> {
        self.target.as_ref().map(|target| &target.view)
    }

    pub(super) fn read_target(&self, gpu: &Gpu) -> Result<Vec<u32>, GpuError> {
        let Some(Target { texture, .. }) = &self.target else { return Err(no_target(gpu)) };
        let row = (16 * self.width).next_multiple_of(ROW);
        let pixels = gpu.device().create_buffer(&wgpu::BufferDescriptor {
            label: Some("ltc pixels"),
            size: u64::from(row) * u64::from(self.height),
            usage: BufferUsages::COPY_DST | BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        let layout =
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: None };
        let to = wgpu::TexelCopyBufferInfo { buffer: &pixels, layout };
        let mut encoder = gpu.device().create_command_encoder(&Default::default());
        encoder.copy_texture_to_buffer(texture.as_image_copy(), to, texture.size());
        gpu.queue().submit([encoder.finish()]);
        let words = read_back(gpu, &pixels)?;
        let used = 4 * self.width as usize;
        Ok(words.chunks(row as usize / 4).flat_map(|row| row[..used].iter().copied()).collect())
    }
}

/// What a program of the fragment stage is told where there is nothing to draw into.
pub(super) fn no_target(gpu: &Gpu) -> GpuError {
    GpuError::device(format!("{} does not draw into float textures", gpu.info()))
}
