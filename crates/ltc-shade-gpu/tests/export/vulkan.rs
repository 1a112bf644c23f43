//! SPIR-V that is not wgpu's own, on a Vulkan device.

use ltc_shade_gpu::TextureAtlas;
use wgpu::util::{BufferInitDescriptor, DeviceExt as _};
use wgpu::{BufferUsages, ShaderStages};

/// A device that takes SPIR-V as it is.
pub struct Vulkan {
    device: wgpu::Device,
    queue: wgpu::Queue,
}

/// Read-only storage buffers, and the binding of the one that is written.
#[derive(Default)]
pub struct Bindings<'a> {
    pub group: u32,
    pub count: u32,
    pub inputs: &'a [(u32, &'a [u32])],
    pub output: u32,
    /// One float, or the four of a textured light.
    pub colours: bool,
    /// The textures of lights, and where they are bound.
    pub textures: Option<(u32, &'a TextureAtlas)>,
}

impl Bindings<'_> {
    fn floats_each(&self) -> usize {
        if self.colours { 4 } else { 1 }
    }
}

impl Vulkan {
    /// `None` with a word about it where there is none. With `CI` set that fails the test.
    pub fn open() -> Option<Self> {
        let backends = wgpu::Backends::VULKAN;
        let descriptor = wgpu::InstanceDescriptor::new_without_display_handle_from_env();
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor { backends, ..descriptor });
        let adapters = pollster::block_on(instance.enumerate_adapters(backends));
        let needed = wgpu::Features::PASSTHROUGH_SHADERS;
        let Some(adapter) = adapters.into_iter().find(|a| a.features().contains(needed)) else {
            assert!(std::env::var_os("CI").is_none(), "no Vulkan device");
            eprintln!("skipped, because there is no Vulkan device");
            return None;
        };
        eprintln!("on {}", adapter.get_info().name);
        let descriptor = wgpu::DeviceDescriptor {
            required_features: needed,
            required_limits: adapter.limits(),
            ..Default::default()
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor)).unwrap();
        Some(Self { device, queue })
    }

    /// One invocation for each of `count` items, in groups of 64, each writing a float or four.
    pub fn run(&self, spirv: &[u32], entry_point: &str, bindings: &Bindings<'_>) -> Vec<f32> {
        let module = self.module(spirv, entry_point);
        let (pipeline, group_layout) = self.pipeline(&module, entry_point, bindings);
        let buffer = |words: &[u32], usage| {
            let contents = bytemuck::cast_slice(words);
            self.device.create_buffer_init(&BufferInitDescriptor { label: None, contents, usage })
        };
        let mut buffers = vec![(0, buffer(&[bindings.count, 0, 0, 0], BufferUsages::UNIFORM))];
        buffers.extend(bindings.inputs.iter().map(|(at, words)| (*at, buffer(words, BufferUsages::STORAGE))));
        let unwritten = vec![u32::MAX; bindings.count as usize * bindings.floats_each()];
        buffers.push((bindings.output, buffer(&unwritten, BufferUsages::STORAGE | BufferUsages::COPY_SRC)));
        let mut entries: Vec<_> = buffers
            .iter()
            .map(|(binding, b)| wgpu::BindGroupEntry { binding: *binding, resource: b.as_entire_binding() })
            .collect();
        let textures = bindings.textures.map(|(at, atlas)| (at, self.texture(atlas)));
        if let Some((binding, view)) = &textures {
            let resource = wgpu::BindingResource::TextureView(view);
            entries.push(wgpu::BindGroupEntry { binding: *binding, resource });
        }
        let group = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &group_layout,
            entries: &entries,
        });
        let mut encoder = self.device.create_command_encoder(&Default::default());
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(bindings.group, &group, &[]);
        pass.dispatch_workgroups(bindings.count.div_ceil(64), 1, 1);
        drop(pass);
        let source = &buffers[buffers.len() - 1].1;
        let staging = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: source.size(),
            usage: BufferUsages::MAP_READ | BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        encoder.copy_buffer_to_buffer(source, 0, &staging, 0, source.size());
        self.queue.submit([encoder.finish()]);
        staging.map_async(wgpu::MapMode::Read, .., |mapped| mapped.unwrap());
        self.device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
        bytemuck::pod_collect_to_vec(&staging.get_mapped_range(..).unwrap())
    }

    fn texture(&self, atlas: &TextureAtlas) -> wgpu::TextureView {
        let descriptor = wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d { width: atlas.width(), height: atlas.height(), depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba32Float,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        };
        let bytes = bytemuck::cast_slice(atlas.texels());
        let order = wgpu::util::TextureDataOrder::LayerMajor;
        let texture = self.device.create_texture_with_data(&self.queue, &descriptor, order, bytes);
        texture.create_view(&Default::default())
    }

    #[expect(unsafe_code, reason = "wgpu does not look into SPIR-V; spirv-val has")]
    fn module(&self, spirv: &[u32], entry_point: &str) -> wgpu::ShaderModule {
        let entry =
            wgpu::PassthroughShaderEntryPoint { name: entry_point.into(), workgroup_size: (64, 1, 1) };
        let descriptor = wgpu::ShaderModuleDescriptorPassthrough {
            entry_points: vec![entry].into(),
            spirv: Some(spirv.into()),
            ..Default::default()
        };
        // SAFETY: a validated module whose accesses stay within the buffers that `run` binds.
        unsafe { self.device.create_shader_module_passthrough(descriptor) }
    }

    fn pipeline(
        &self,
        module: &wgpu::ShaderModule,
        entry_point: &str,
        bindings: &Bindings<'_>,
    ) -> (wgpu::ComputePipeline, wgpu::BindGroupLayout) {
        let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: ShaderStages::COMPUTE,
            ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
            count: None,
        };
        let storage = |read_only| wgpu::BufferBindingType::Storage { read_only };
        let mut entries = vec![entry(0, wgpu::BufferBindingType::Uniform)];
        entries.extend(bindings.inputs.iter().map(|(at, _)| entry(*at, storage(true))));
        entries.push(entry(bindings.output, storage(false)));
        entries.extend(bindings.textures.map(|(binding, _)| wgpu::BindGroupLayoutEntry {
            ty: wgpu::BindingType::Texture {
                sample_type: wgpu::TextureSampleType::Float { filterable: false },
                view_dimension: wgpu::TextureViewDimension::D2,
                multisampled: false,
            },
            ..entry(binding, storage(true))
        }));
        let group = self
            .device
            .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: None, entries: &entries });
        let mut groups = vec![None; bindings.group as usize];
        groups.push(Some(&group));
        let layout = self.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: None,
            bind_group_layouts: &groups,
            immediate_size: 0,
        });
        let pipeline = self.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: None,
            layout: Some(&layout),
            module,
            entry_point: Some(entry_point),
            compilation_options: Default::default(),
            cache: None,
        });
        (pipeline, group)
    }
}
