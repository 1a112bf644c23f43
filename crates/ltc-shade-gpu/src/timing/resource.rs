//! What a program reads beside tables.

use wgpu::util::{BufferInitDescriptor, DeviceExt, TextureDataOrder};
use wgpu::{
    BindingType, BufferBindingType, BufferUsages, ShaderStages, TextureDimension, TextureViewDimension,
};

use crate::{Gpu, GpuError};

/// A buffer, texture or sampler on the device; copies are of the handle alone.
#[derive(Clone, Debug)]
pub struct Resource(Kind);

#[derive(Clone, Debug)]
enum Kind {
    Storage(wgpu::Buffer),
    Uniform(wgpu::Buffer),
    Texture(wgpu::TextureView, TextureViewDimension),
    Sampler(wgpu::Sampler),
}

impl Resource {
    /// A read-only storage buffer with these bytes.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`], [`GpuError::Device`].
    pub fn storage(gpu: &Gpu, bytes: &[u8]) -> Result<Self, GpuError> {
        let limit = gpu.device().limits().max_storage_buffer_binding_size;
        if bytes.len() as u64 > limit {
            return Err(GpuError::TooLarge { what: "an input buffer", bytes: bytes.len() as u64, limit });
        }
        Ok(Self(Kind::Storage(buffer(gpu, bytes, BufferUsages::STORAGE)?)))
    }

    /// A uniform buffer with these bytes.
    ///
    /// # Errors
    /// [`GpuError::Device`].
    pub fn uniform(gpu: &Gpu, bytes: &[u8]) -> Result<Self, GpuError> {
        Ok(Self(Kind::Uniform(buffer(gpu, bytes, BufferUsages::UNIFORM)?)))
    }

    /// A filterable texture of four half floats a texel, little-endian: `texture_2d<f32>` for a depth of 0, otherwise
    /// `texture_3d<f32>`.
    ///
    /// # Errors
    /// [`GpuError::Device`], also for another number of bytes than the size has.
    pub fn half_texture(gpu: &Gpu, [width, height, depth]: [u32; 3], bytes: &[u8]) -> Result<Self, GpuError> {
        let size = wgpu::Extent3d { width, height, depth_or_array_layers: depth.max(1) };
        if bytes.len() as u64 != 8 * u64::from(width) * u64::from(height) * u64::from(depth.max(1)) {
            return Err(GpuError::device(format!("{} bytes for {width} x {height} x {depth}", bytes.len())));
        }
        let (dimension, seen_as) = match depth {
            0 => (TextureDimension::D2, TextureViewDimension::D2),
            _ => (TextureDimension::D3, TextureViewDimension::D3),
        };
        let descriptor = wgpu::TextureDescriptor {
            label: Some("ltc timed"),
            size,
            mip_level_count: 1,
            sample_count: 1,
            dimension,
            format: wgpu::TextureFormat::Rgba16Float,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        };
        gpu.checked(|| {
            let order = TextureDataOrder::LayerMajor;
            let texture = gpu.device().create_texture_with_data(gpu.queue(), &descriptor, order, bytes);
            Ok(Self(Kind::Texture(texture.create_view(&Default::default()), seen_as)))
        })
    }

    /// A sampler that filters linearly and clamps to the edge.
    ///
    /// # Errors
    /// [`GpuError::Device`].
    pub fn sampler(gpu: &Gpu) -> Result<Self, GpuError> {
        gpu.checked(|| {
            Ok(Self(Kind::Sampler(gpu.device().create_sampler(&wgpu::SamplerDescriptor {
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                ..Default::default()
            }))))
        })
    }

    pub(super) fn layout(&self, binding: u32) -> wgpu::BindGroupLayoutEntry {
        let buffer = |ty| BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None };
        let ty = match &self.0 {
            Kind::Storage(_) => buffer(BufferBindingType::Storage { read_only: true }),
            Kind::Uniform(_) => buffer(BufferBindingType::Uniform),
            Kind::Texture(_, view_dimension) => BindingType::Texture {
                sample_type: wgpu::TextureSampleType::Float { filterable: true },
                view_dimension: *view_dimension,
                multisampled: false,
            },
            Kind::Sampler(_) => BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
        };
        let visibility = ShaderStages::COMPUTE | ShaderStages::FRAGMENT;
        wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None }
    }

    pub(super) fn binding(&self) -> wgpu::BindingResource<'_> {
        match &self.0 {
            Kind::Storage(buffer) | Kind::Uniform(buffer) => buffer.as_entire_binding(),
            Kind::Texture(view, _) => wgpu::BindingResource::TextureView(view),
            Kind::Sampler(sampler) => wgpu::BindingResource::Sampler(sampler),
        }
    }
}

fn buffer(gpu: &Gpu, contents: &[u8], usage: BufferUsages) -> Result<wgpu::Buffer, GpuError> {
    let label = Some("ltc timed");
    gpu.checked(|| Ok(gpu.device().create_buffer_init(&BufferInitDescriptor { label, contents, usage })))
}
