//! The exported WGSL in a wgpu program that knows nothing else of this workspace: `cargo run -p ltc-shade-gpu --example
//! host-wgsl`.

use std::error::Error;

use ltc_shade_gpu::{Code, Feature, Language, LightKind, ShaderRequest};
use wgpu::BufferUsages;
use wgpu::util::{BufferInitDescriptor, DeviceExt as _};

/// Columns of M, corners of the quad and flags, as `Job` in `batch.wgsl` has them.
pub type Job = [u32; 32];

/// The exported functions, and behind them what holds the bindings. An engine would keep both in files.
fn source() -> Result<String, Box<dyn Error>> {
    let features = [Feature::SurfaceHorizon, Feature::CosineHorizon, Feature::TwoSided];
    let exported = ShaderRequest::new([LightKind::Quad], features).export(Language::Wgsl)?;
    match exported.code {
        Code::Text(library) => Ok(format!("{library}\n{}", include_str!("batch.wgsl"))),
        Code::Words(_) => Err("WGSL is text".into()),
    }
}

/// The fraction of each job's lobe that sees its quad.
pub fn fractions(jobs: &[Job]) -> Result<Vec<f32>, Box<dyn Error>> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
    let adapter = pollster::block_on(instance.request_adapter(&Default::default()))?;
    let (device, queue) = pollster::block_on(adapter.request_device(&Default::default()))?;
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: None,
        source: wgpu::ShaderSource::Wgsl(source()?.into()),
    });
    let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: None,
        layout: None,
        module: &module,
        entry_point: Some("batch"),
        compilation_options: Default::default(),
        cache: None,
    });
    let buffer = |contents: &[u8], usage| {
        device.create_buffer_init(&BufferInitDescriptor { label: None, contents, usage })
    };
    let count = buffer(bytemuck::cast_slice(&[jobs.len() as u32, 0, 0, 0]), BufferUsages::UNIFORM);
    let input = buffer(bytemuck::cast_slice(jobs), BufferUsages::STORAGE);
    let unwritten = vec![f32::NAN; jobs.len()];
    let output = buffer(bytemuck::cast_slice(&unwritten), BufferUsages::STORAGE | BufferUsages::COPY_SRC);
    let staging = buffer(bytemuck::cast_slice(&unwritten), BufferUsages::MAP_READ | BufferUsages::COPY_DST);
    let bound = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipeline.get_bind_group_layout(0),
        entries: &[
            wgpu::BindGroupEntry { binding: 0, resource: count.as_entire_binding() },
            wgpu::BindGroupEntry { binding: 1, resource: input.as_entire_binding() },
            wgpu::BindGroupEntry { binding: 2, resource: output.as_entire_binding() },
        ],
    });
    let mut encoder = device.create_command_encoder(&Default::default());
    let mut pass = encoder.begin_compute_pass(&Default::default());
    pass.set_pipeline(&pipeline);
    pass.set_bind_group(0, &bound, &[]);
    pass.dispatch_workgroups((jobs.len() as u32).div_ceil(64), 1, 1);
    drop(pass);
    encoder.copy_buffer_to_buffer(&output, 0, &staging, 0, output.size());
    queue.submit([encoder.finish()]);
    let (sender, receiver) = std::sync::mpsc::channel();
    staging.map_async(wgpu::MapMode::Read, .., move |mapped| {
        // The receiver lives until the message is there.
        let _ = sender.send(mapped);
    });
    device.poll(wgpu::PollType::wait_indefinitely())?;
    receiver.recv()??;
    Ok(bytemuck::pod_collect_to_vec(&staging.get_mapped_range(..)?))
}

/// Lambert's lobe under a square of side 2, 2 above it: 0.239.
#[cfg_attr(test, expect(dead_code, reason = "the test takes the functions alone"))]
fn main() -> Result<(), Box<dyn Error>> {
    let square = [[1.0, -1.0], [-1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]];
    let mut job = [0.0_f32; 32];
    (job[0], job[5], job[10]) = (1.0, 1.0, 1.0);
    for (corner, [x, y]) in square.into_iter().enumerate() {
        job[12 + 4 * corner..15 + 4 * corner].copy_from_slice(&[x, y, 2.0]);
    }
    let mut words = job.map(f32::to_bits);
    words[31] = 256;
    let found = fractions(&[words])?;
    println!("{found:?}");
    Ok(())
}
