//! A compute pipeline that reads structures and writes floats.

use wgpu::util::{BufferInitDescriptor, DeviceExt};
use wgpu::{BindGroup, BindGroupLayout, Buffer, BufferUsages};

use crate::modules::Program;
use crate::{Gpu, GpuError};

/// Invocations in a workgroup; every entry point says `@workgroup_size(64)`.
const WORKGROUP: u32 = 64;
/// Pre-filled into every output: a NaN that no arithmetic makes, so that what stays unwritten is told from any result.
pub(crate) const UNWRITTEN: u32 = 0xFFF1_5EED;

/// One entry point of a program, compiled.
#[derive(Debug)]
pub(crate) struct Kernel {
    pipeline: wgpu::ComputePipeline,
    io_group: u32,
}

/// What a kernel reads and how much it writes.
pub(crate) struct Batch<'a> {
    /// What an item is called in errors.
    pub item: &'static str,
    /// How many items went before these, for errors.
    pub first: usize,
    /// Number of items: one invocation each.
    pub items: usize,
    /// Numbers in the uniform at binding 0, the number of items first.
    pub counts: [u32; 4],
    /// Read-only storage buffers from binding 1 on, as bytes.
    pub inputs: &'a [&'a [u8]],
    /// Floats that each item writes to the last binding.
    pub floats_each: usize,
    /// The bind group of the tables, if the program has one.
    pub tables: Option<&'a BindGroup>,
}

/// The shader module of a program; all of its kernels share it.
pub(crate) fn compile(gpu: &Gpu, program: Program) -> Result<wgpu::ShaderModule, GpuError> {
    gpu.checked(|| {
        Ok(gpu.device().create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("ltc"),
            source: wgpu::ShaderSource::Wgsl(program.source().into()),
        }))
    })
}

impl Kernel {
    /// `inputs` is the number of read-only storage buffers.
    pub fn new(
        gpu: &Gpu,
        module: &wgpu::ShaderModule,
        entry_point: &str,
        tables: Option<&BindGroupLayout>,
        inputs: u32,
    ) -> Result<Self, GpuError> {
        gpu.checked(|| {
            let device = gpu.device();
            let io = io_layout(device, inputs);
            let groups: Vec<_> = tables.into_iter().chain([&io]).map(Some).collect();
            let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some("ltc"),
                bind_group_layouts: &groups,
                immediate_size: 0,
            });
            let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(entry_point),
                layout: Some(&layout),
                module,
                entry_point: Some(entry_point),
                compilation_options: Default::default(),
                cache: None,
            });
            Ok(Self { pipeline, io_group: u32::from(tables.is_some()) })
        })
    }

    /// Runs one batch and waits for its results: `items × floats_each` numbers, all of them finite.
    pub fn run(&self, gpu: &Gpu, batch: &Batch<'_>) -> Result<Vec<f32>, GpuError> {
        if batch.items == 0 {
            return Ok(Vec::new());
        }
        check_sizes(gpu, batch)?;
        let words = gpu.checked(|| {
            let results = self.dispatch(gpu, batch);
            read_back(gpu, &results)
        })?;
        check_results(batch, words)
    }

    fn dispatch(&self, gpu: &Gpu, batch: &Batch<'_>) -> Buffer {
        let device = gpu.device();
        let buffer = |contents: &[u8], usage| {
            device.create_buffer_init(&BufferInitDescriptor { label: Some("ltc"), contents, usage })
        };
        let mut buffers = vec![buffer(bytemuck::cast_slice(&batch.counts), BufferUsages::UNIFORM)];
        buffers.extend(batch.inputs.iter().map(|bytes| buffer(bytes, BufferUsages::STORAGE)));
        let unwritten = vec![UNWRITTEN; batch.items * batch.floats_each];
        let output = BufferUsages::STORAGE | BufferUsages::COPY_SRC;
        buffers.push(buffer(bytemuck::cast_slice(&unwritten), output));
        let entries: Vec<_> = (0..)
            .zip(&buffers)
            .map(|(binding, b)| wgpu::BindGroupEntry { binding, resource: b.as_entire_binding() })
            .collect();
        let io = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("ltc"),
            layout: &self.pipeline.get_bind_group_layout(self.io_group),
            entries: &entries,
        });
        let mut encoder = device.create_command_encoder(&Default::default());
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&self.pipeline);
        if let Some(tables) = batch.tables {
            pass.set_bind_group(0, tables, &[]);
        }
        pass.set_bind_group(self.io_group, &io, &[]);
        pass.dispatch_workgroups((batch.items as u32).div_ceil(WORKGROUP), 1, 1);
        drop(pass);
        gpu.queue().submit([encoder.finish()]);
        buffers.swap_remove(buffers.len() - 1)
    }
}

fn io_layout(device: &wgpu::Device, inputs: u32) -> BindGroupLayout {
    let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
        count: None,
    };
    let mut entries = vec![entry(0, wgpu::BufferBindingType::Uniform)];
    for i in 0..=inputs {
        entries.push(entry(1 + i, wgpu::BufferBindingType::Storage { read_only: i < inputs }));
    }
    device
        .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some("ltc"), entries: &entries })
}

fn check_sizes(gpu: &Gpu, batch: &Batch<'_>) -> Result<(), GpuError> {
    let limits = gpu.device().limits();
    let limit = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
    let output = batch.items * batch.floats_each * size_of::<f32>();
    for (what, bytes) in
        batch.inputs.iter().map(|b| ("an input buffer", b.len())).chain([("an output buffer", output)])
    {
        if bytes as u64 > limit {
            return Err(GpuError::TooLarge { what, bytes: bytes as u64, limit });
        }
    }
    Ok(())
}

/// The floats in a buffer, whatever they are.
pub(crate) fn read_floats(gpu: &Gpu, source: &Buffer) -> Result<Vec<f32>, GpuError> {
    Ok(read_back(gpu, source)?.into_iter().map(f32::from_bits).collect())
}

pub(crate) fn read_back(gpu: &Gpu, source: &Buffer) -> Result<Vec<u32>, GpuError> {
    let device = gpu.device();
    let staging = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("ltc read-back"),
        size: source.size(),
        usage: BufferUsages::MAP_READ | BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut encoder = device.create_command_encoder(&Default::default());
    encoder.copy_buffer_to_buffer(source, 0, &staging, 0, source.size());
    gpu.queue().submit([encoder.finish()]);
    let (sender, receiver) = std::sync::mpsc::channel();
    staging.map_async(wgpu::MapMode::Read, .., move |mapped| {
        // The receiver lives until the message is there or the device is lost.
        let _ = sender.send(mapped);
    });
    device.poll(wgpu::PollType::wait_indefinitely()).map_err(GpuError::device)?;
    receiver.recv().map_err(GpuError::device)?.map_err(GpuError::device)?;
    let view = staging.get_mapped_range(..).map_err(GpuError::device)?;
    Ok(bytemuck::pod_collect_to_vec(&view))
}

fn check_results(batch: &Batch<'_>, words: Vec<u32>) -> Result<Vec<f32>, GpuError> {
    let floats: Vec<f32> = words.iter().map(|word| f32::from_bits(*word)).collect();
    match floats.iter().position(|value| !value.is_finite()) {
        None => Ok(floats),
        Some(at) => {
            let what = if words[at] == UNWRITTEN { "unwritten".to_owned() } else { floats[at].to_string() };
            Err(GpuError::BadOutput { item: batch.item, index: batch.first + at / batch.floats_each, what })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn batch(items: usize) -> Batch<'static> {
        Batch { item: "query", first: 5, items, counts: [0; 4], inputs: &[], floats_each: 2, tables: None }
    }

    #[test]
    fn unwritten_and_non_finite_results_are_errors() {
        let one = 1.0_f32.to_bits();
        assert_eq!(check_results(&batch(1), vec![one, 0]).unwrap(), [1.0, 0.0]);
        let error = check_results(&batch(2), vec![one, one, one, UNWRITTEN]).unwrap_err();
        assert_eq!(error.to_string(), "query 6 came back unwritten");
        let error = check_results(&batch(1), vec![one, f32::INFINITY.to_bits()]).unwrap_err();
        assert_eq!(error.to_string(), "query 5 came back inf");
    }

    const LAZY: &str = "
        @group(0) @binding(0) var<uniform> counts: vec4u;
        @group(0) @binding(1) var<storage, read_write> results: array<f32>;
        @compute @workgroup_size(64)
        fn lazy(@builtin(global_invocation_id) id: vec3u) {
            if id.x < counts.x && id.x != 3u {
                results[2u * id.x] = 0.0;
                results[2u * id.x + 1u] = 0.0;
            }
        }";

    #[test]
    fn a_shader_that_leaves_out_an_item_is_caught() {
        let gpu = match Gpu::new(crate::GpuOptions::default()) {
            Ok(gpu) => gpu,
            Err(error) => {
                assert!(std::env::var_os("CI").is_none(), "{error}");
                eprintln!("skipped, because no GPU adapter can run this: {error}");
                return;
            }
        };
        let source = wgpu::ShaderSource::Wgsl(LAZY.into());
        let module = gpu.device().create_shader_module(wgpu::ShaderModuleDescriptor { label: None, source });
        let kernel = Kernel::new(&gpu, &module, "lazy", None, 0).unwrap();
        let run = |items: usize| kernel.run(&gpu, &Batch { counts: [items as u32, 0, 0, 0], ..batch(items) });
        assert_eq!(run(3).unwrap(), [0.0; 6]);
        assert_eq!(run(100).unwrap_err().to_string(), "query 8 came back unwritten");
        assert!(Kernel::new(&gpu, &module, "missing", None, 0).is_err(), "an error, not a panic");
    }
}
