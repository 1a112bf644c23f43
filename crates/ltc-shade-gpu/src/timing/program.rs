//! A program over a grid of pixels.

use wgpu::{BindGroup, BindGroupLayout, ShaderStages};

use super::grid::{TARGET, no_target};
use super::{PixelGrid, Resource};
use crate::modules::Extras;
use crate::table_bindings::TableBindings;
use crate::{Gpu, GpuError, Tables};

/// Where a program runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Workgroups of 8 by 8 pixels.
    Compute,
    /// One triangle over the whole picture.
    Fragment,
}

impl Stage {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Compute, Self::Fragment];

    /// In a word.
    pub fn name(self) -> &'static str {
        match self {
            Self::Compute => "compute",
            Self::Fragment => "fragment",
        }
    }
}

/// What a program is made of.
#[derive(Clone, Copy, Debug)]
pub struct PixelSource<'a> {
    /// WGSL with `fn pixel(at: vec2u, index: u32) -> vec4f`, `index` counting row by row from the top. Tables are in group 0, as
    /// the modules `tables_exact`, `tables_hardware` and `tables_buffer` and, for baked slices, `baked_exact` and its like bind them, resources in group 1 in their order; group 2
    /// and names that begin with `timed_` are taken.
    pub wgsl: &'a str,
    /// The stage.
    pub stage: Stage,
    /// For programs that look into tables.
    pub tables: Option<Tables<'a>>,
    /// How many resources it has, each as the layout of one that stands for all later ones.
    pub resources: &'a [Resource],
}

/// A compiled program with what it reads.
#[derive(Debug)]
pub struct PixelProgram {
    pipeline: Pipeline,
    tables: Option<BindGroup>,
    resources: BindGroup,
    layout: BindGroupLayout,
}

#[derive(Clone, Debug)]
enum Pipeline {
    Compute(wgpu::ComputePipeline, BindGroup),
    Fragment(wgpu::RenderPipeline),
}

/// The entry points around `pixel`.
fn entry_points(grid: &PixelGrid, stage: Stage) -> String {
    let (width, height) = (grid.width(), grid.height());
    match stage {
        Stage::Compute => format!(
            "
@group(2) @binding(0) var<storage, read_write> timed_pixels: array<vec4f>;

@compute @workgroup_size(8, 8)
fn timed_compute(@builtin(global_invocation_id) id: vec3u) {{
    if id.x < {width}u && id.y < {height}u {{
        let index = id.y * {width}u + id.x;
        timed_pixels[index] = pixel(id.xy, index);
    }}
}}
"
        ),
        Stage::Fragment => format!(
            "
@vertex
fn timed_vertex(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {{
    return vec4f(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}}

@fragment
fn timed_fragment(@builtin(position) at: vec4f) -> @location(0) vec4f {{
    let id = vec2u(at.xy);
    return pixel(id, id.y * {width}u + id.x);
}}
"
        ),
    }
}

impl PixelProgram {
    /// Compiles it for this grid.
    ///
    /// # Errors
    /// [`GpuError::Device`] with what is wrong with the text, and for the fragment stage of a device that does not draw into float
    /// textures.
    pub fn new(gpu: &Gpu, grid: &PixelGrid, source: &PixelSource<'_>) -> Result<Self, GpuError> {
        if source.stage == Stage::Fragment && grid.view().is_none() {
            return Err(no_target(gpu));
        }
        let bindings = |tables: Tables<'_>| {
            TableBindings::new(gpu, Extras { textured: false, baked: tables.baked.is_some() })
        };
        let table_bindings = source.tables.map(bindings).transpose()?;
        let tables = match (&table_bindings, source.tables) {
            (Some(bindings), Some(tables)) => Some(bindings.bind(gpu, tables, None)?),
            _ => None,
        };
        gpu.checked(|| {
            let device = gpu.device();
            let text = format!("{}\n{}", source.wgsl, entry_points(grid, source.stage));
            let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some("ltc timed"),
                source: wgpu::ShaderSource::Wgsl(text.into()),
            });
            let layout = resource_layout(device, source.resources);
            let resources = bind(device, &layout, source.resources);
            let groups = [table_bindings.as_ref().map(TableBindings::layout), Some(&layout)];
            let pipeline = match source.stage {
                Stage::Compute => compute(device, &module, groups, grid),
                Stage::Fragment => fragment(device, &module, groups),
            };
            Ok(Self { pipeline, tables, resources, layout })
        })
    }

    /// The same program over other resources of the same kinds.
    ///
    /// # Errors
    /// [`GpuError::Device`] where they are of other kinds.
    pub fn with(&self, gpu: &Gpu, resources: &[Resource]) -> Result<Self, GpuError> {
        gpu.checked(|| {
            let resources = bind(gpu.device(), &self.layout, resources);
            let (pipeline, tables) = (self.pipeline.clone(), self.tables.clone());
            Ok(Self { pipeline, tables, resources, layout: self.layout.clone() })
        })
    }

    /// What it writes: four numbers a pixel, row by row from the top.
    ///
    /// # Errors
    /// [`GpuError::BadOutput`] for a pixel that is not written or not finite, [`GpuError::Device`].
    pub fn pixels(&self, gpu: &Gpu, grid: &PixelGrid) -> Result<Vec<[f32; 4]>, GpuError> {
        let words = gpu.checked(|| {
            grid.spoil(gpu);
            let mut encoder = gpu.device().create_command_encoder(&Default::default());
            self.encode(&mut encoder, grid, None);
            gpu.queue().submit([encoder.finish()]);
            match self.pipeline {
                Pipeline::Compute(..) => grid.read_buffer(gpu),
                Pipeline::Fragment(_) => grid.read_target(gpu),
            }
        })?;
        let floats: Vec<[f32; 4]> = words.as_chunks::<4>().0.iter().map(|w| w.map(f32::from_bits)).collect();
        match floats.iter().position(|pixel| pixel.iter().any(|x| !x.is_finite())) {
            None => Ok(floats),
            Some(index) => {
                let what = format!("{:?}", floats[index]);
                Err(GpuError::BadOutput { item: "pixel", index, what })
            }
        }
    }

    /// One pass over the whole grid; `timestamps` are a query set and the indices to be written at its beginning and end.
    pub(super) fn encode(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        grid: &PixelGrid,
        timestamps: Option<(&wgpu::QuerySet, Option<u32>, Option<u32>)>,
    ) {
        match &self.pipeline {
            Pipeline::Compute(pipeline, output) => {
                let timestamp_writes =
                    timestamps.map(|(query_set, begin, end)| wgpu::ComputePassTimestampWrites {
                        query_set,
                        beginning_of_pass_write_index: begin,
                        end_of_pass_write_index: end,
                    });
                let descriptor = wgpu::ComputePassDescriptor { label: Some("ltc timed"), timestamp_writes };
                let mut pass = encoder.begin_compute_pass(&descriptor);
                pass.set_pipeline(pipeline);
                if let Some(tables) = &self.tables {
                    pass.set_bind_group(0, tables, &[]);
                }
                pass.set_bind_group(1, &self.resources, &[]);
                pass.set_bind_group(2, output, &[]);
                pass.dispatch_workgroups(grid.width().div_ceil(8), grid.height().div_ceil(8), 1);
            }
            Pipeline::Fragment(pipeline) => {
                let timestamp_writes =
                    timestamps.map(|(query_set, begin, end)| wgpu::RenderPassTimestampWrites {
                        query_set,
                        beginning_of_pass_write_index: begin,
                        end_of_pass_write_index: end,
                    });
                // Never absent: such a program is not compiled for a grid without.
                let Some(view) = grid.view() else { return };
                // Every pixel is covered; the clear spares tiles the reading of what was there.
                let ops = wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color { r: f64::NAN, g: 0.0, b: 0.0, a: 0.0 }),
                    store: wgpu::StoreOp::Store,
                };
                let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                    label: Some("ltc timed"),
                    color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                        view,
                        depth_slice: None,
                        resolve_target: None,
                        ops,
                    })],
                    timestamp_writes,
                    ..Default::default()
                });
                pass.set_pipeline(pipeline);
                if let Some(tables) = &self.tables {
                    pass.set_bind_group(0, tables, &[]);
                }
                pass.set_bind_group(1, &self.resources, &[]);
                pass.draw(0..3, 0..1);
            }
        }
    }
}

fn resource_layout(device: &wgpu::Device, resources: &[Resource]) -> BindGroupLayout {
    let entries: Vec<_> = (0..).zip(resources).map(|(binding, r)| r.layout(binding)).collect();
    let label = Some("ltc timed");
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label, entries: &entries })
}

fn bind(device: &wgpu::Device, layout: &BindGroupLayout, resources: &[Resource]) -> BindGroup {
    let entries: Vec<_> = (0..)
        .zip(resources)
        .map(|(binding, r)| wgpu::BindGroupEntry { binding, resource: r.binding() })
        .collect();
    let label = Some("ltc timed");
    device.create_bind_group(&wgpu::BindGroupDescriptor { label, layout, entries: &entries })
}

fn compute(
    device: &wgpu::Device,
    module: &wgpu::ShaderModule,
    [tables, resources]: [Option<&BindGroupLayout>; 2],
    grid: &PixelGrid,
) -> Pipeline {
    let label = Some("ltc timed");
    let output = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label,
        entries: &[wgpu::BindGroupLayoutEntry {
            binding: 0,
            visibility: ShaderStages::COMPUTE,
            ty: wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Storage { read_only: false },
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            count: None,
        }],
    });
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label,
        bind_group_layouts: &[tables, resources, Some(&output)],
        immediate_size: 0,
    });
    let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label,
        layout: Some(&layout),
        module,
        entry_point: Some("timed_compute"),
        compilation_options: Default::default(),
        cache: None,
    });
    let entries = [wgpu::BindGroupEntry { binding: 0, resource: grid.buffer.as_entire_binding() }];
    let bound =
        device.create_bind_group(&wgpu::BindGroupDescriptor { label, layout: &output, entries: &entries });
    Pipeline::Compute(pipeline, bound)
}

fn fragment(
    device: &wgpu::Device,
    module: &wgpu::ShaderModule,
    groups: [Option<&BindGroupLayout>; 2],
) -> Pipeline {
    let label = Some("ltc timed");
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label,
        bind_group_layouts: &groups,
        immediate_size: 0,
    });
    let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label,
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module,
            entry_point: Some("timed_vertex"),
            compilation_options: Default::default(),
            buffers: &[],
        },
        primitive: Default::default(),
        depth_stencil: None,
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module,
            entry_point: Some("timed_fragment"),
            compilation_options: Default::default(),
            targets: &[Some(TARGET.into())],
        }),
        multiview_mask: None,
        cache: None,
    });
    Pipeline::Fragment(pipeline)
}
