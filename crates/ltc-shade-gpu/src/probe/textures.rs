//! Filtering of 32-bit float textures.

use wgpu::util::{DeviceExt as _, TextureDataOrder};
use wgpu::{BindGroup, BindGroupLayout, ShaderStages};

use super::arithmetic::answers;
use super::{Finding, module};
use crate::compute::Kernel;
use crate::{Gpu, GpuError};

const PLACES: usize = 1024;

pub fn findings(gpu: &Gpu, source: &str) -> Result<Vec<Finding>, GpuError> {
    let filterable = "filtering of float textures";
    if !gpu.device().features().contains(wgpu::Features::FLOAT32_FILTERABLE) {
        return Ok(vec![Finding::absent(filterable, "without it tables are interpolated by the shader")]);
    }
    let (layout, bound) = gpu.checked(|| Ok(ramp(gpu)))?;
    let kernel = Kernel::new(gpu, &module(gpu, source)?, "filtering", Some(&layout), 1)?;
    // From the middle of the first texel, where 0 is, to that of the second, where 1 is.
    let cases: Vec<_> = (0..=PLACES).map(|i| [0.5 + i as f32 / PLACES as f32, 0.0, 0.0, 0.0]).collect();
    let Some(found) = answers(gpu, &kernel, &bound, &cases)? else {
        return Ok(vec![Finding::failed(filterable, "no finite answer came back")]);
    };
    let errors = cases.iter().zip(found.as_chunks::<4>().0);
    let largest = errors.map(|(case, found)| f64::from(found[0] - (case[0] - 0.5)).abs()).fold(0.0, f64::max);
    Ok(vec![
        Finding::measured(filterable, 0.0, 0.0, "there is"),
        Finding::measured(
            "filtering precision",
            largest,
            // Weights of eight bits, rounded or cut off.
            1.001 / 256.0,
            "error of a weight; hardware-filtering is coarser than 8 bits if off: interpolate by the shader",
        ),
    ])
}

/// Two texels, 0 and 1, and a filter.
fn ramp(gpu: &Gpu) -> (BindGroupLayout, BindGroup) {
    let device = gpu.device();
    let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: ShaderStages::COMPUTE,
        ty,
        count: None,
    };
    let texture_type = wgpu::BindingType::Texture {
        sample_type: wgpu::TextureSampleType::Float { filterable: true },
        view_dimension: wgpu::TextureViewDimension::D2,
        multisampled: false,
    };
    let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("ltc probe"),
        entries: &[
            entry(0, texture_type),
            entry(1, wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering)),
        ],
    });
    let descriptor = wgpu::TextureDescriptor {
        label: Some("ltc probe"),
        size: wgpu::Extent3d { width: 2, height: 1, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba32Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    };
    let texels = [[0.0_f32; 4], [1.0; 4]];
    let bytes = bytemuck::cast_slice(&texels);
    let texture =
        device.create_texture_with_data(gpu.queue(), &descriptor, TextureDataOrder::LayerMajor, bytes);
    let view = texture.create_view(&Default::default());
    let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        ..Default::default()
    });
    let bound = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("ltc probe"),
        layout: &layout,
        entries: &[
            wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&view) },
            wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::Sampler(&sampler) },
        ],
    });
    (layout, bound)
}
