//! Derivatives in a fragment shader, which also tells whether anything is drawn at all.

use super::{Finding, module};
use crate::compute::read_floats;
use crate::{Gpu, GpuError};

/// Pixels along each side: a row is 256 bytes, as copies from textures want.
const SIDE: u32 = 16;
const EXPECTED: [f32; 4] = [3.0, 5.0, 0.0, 1.0];

pub fn finding(gpu: &Gpu, source: &str) -> Result<Finding, GpuError> {
    if !gpu.draws_floats() {
        return Ok(Finding::absent("derivatives", "not measured: it does not draw into float textures"));
    }
    let module = module(gpu, source)?;
    let pixels = gpu.checked(|| draw(gpu, &module))?;
    let errors = pixels.as_chunks::<4>().0.iter().flat_map(|pixel| {
        pixel.iter().zip(EXPECTED).map(|(found, expected)| f64::from((found - expected).abs()))
    });
    // Unlike `max`, this keeps a NaN.
    let largest = errors.fold(0.0, |a: f64, b| if b <= a { a } else { b });
    let note = "error of dpdx, dpdy and fwidth of known slopes; no function here takes derivatives, but an engine's do";
    Ok(Finding::measured("derivatives", largest, 1e-4, note))
}

fn draw(gpu: &Gpu, module: &wgpu::ShaderModule) -> Result<Vec<f32>, GpuError> {
    let device = gpu.device();
    let format = wgpu::TextureFormat::Rgba32Float;
    let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("ltc probe"),
        layout: None,
        vertex: wgpu::VertexState {
            module,
            entry_point: Some("everywhere"),
            compilation_options: Default::default(),
            buffers: &[],
        },
        primitive: Default::default(),
        depth_stencil: None,
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module,
            entry_point: Some("slopes"),
            compilation_options: Default::default(),
            targets: &[Some(format.into())],
        }),
        multiview_mask: None,
        cache: None,
    });
    let target = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("ltc probe"),
        size: wgpu::Extent3d { width: SIDE, height: SIDE, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    });
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("ltc probe"),
        size: u64::from(SIDE * SIDE * 16),
        usage: wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut encoder = device.create_command_encoder(&Default::default());
    let view = target.create_view(&Default::default());
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("ltc probe"),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: &view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                store: wgpu::StoreOp::Store,
            },
        })],
        ..Default::default()
    });
    pass.set_pipeline(&pipeline);
    pass.draw(0..3, 0..1);
    drop(pass);
    let layout =
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(SIDE * 16), rows_per_image: None };
    encoder.copy_texture_to_buffer(
        target.as_image_copy(),
        wgpu::TexelCopyBufferInfo { buffer: &buffer, layout },
        target.size(),
    );
    gpu.queue().submit([encoder.finish()]);
    read_floats(gpu, &buffer)
}
