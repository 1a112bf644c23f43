//! Forward shading: triangles, shaded in the fragment stage as they are drawn.

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec3};
use wgpu::util::{BufferInitDescriptor, DeviceExt};
use wgpu::{BindGroup, BindGroupLayout, BufferUsages, ShaderStages, TextureFormat, vertex_attr_array};

use crate::compute::{compile, read_back};
use crate::layout::ForwardLayout;
use crate::light::EncodedLights;
use crate::modules::Program;
use crate::table_bindings::TableBindings;
use crate::{AreaLight, Gpu, GpuError, LightTextures, ShadingOptions, SurfacePoint, Tables};

/// What is drawn into: four floats a pixel.
const TARGET: TextureFormat = TextureFormat::Rgba32Float;
const DEPTH: TextureFormat = TextureFormat::Depth32Float;
/// Rows of what is copied to a buffer begin at multiples of this.
const ROW: u32 = wgpu::COPY_BYTES_PER_ROW_ALIGNMENT;

/// A corner of a triangle, in world space.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct ForwardVertex {
    /// Where it is.
    pub position: [f32; 3],
    /// Shading normal; interpolated, any length.
    pub normal: [f32; 3],
    /// Carries `alpha_x`; interpolated, any length.
    pub tangent: [f32; 3],
}

/// From where triangles are seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForwardView {
    /// World space to clip space, depth 0 to 1.
    pub clip_from_world: Mat4,
    /// The eye, in world space.
    pub eye: Vec3,
    /// Pixels.
    pub width: u32,
    /// Pixels.
    pub height: u32,
}

/// The material of one draw; the fields are those of [`SurfacePoint`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(missing_docs, reason = "described at SurfacePoint")]
pub struct ForwardMaterial {
    pub alpha_x: f32,
    pub alpha_y: f32,
    pub isotropic: bool,
    pub slice: Option<u32>,
    pub f0: Vec3,
    pub f90: f32,
    pub albedo: Vec3,
}

/// The pipeline that shades triangles as they are drawn: the formula of [`crate::Shader`], in the fragment stage.
#[derive(Debug)]
pub struct Forward {
    pipeline: wgpu::RenderPipeline,
    tables: TableBindings,
    inputs: BindGroupLayout,
    textures: Option<LightTextures>,
}

impl Forward {
    /// Compiles the pipeline.
    ///
    /// # Errors
    /// [`GpuError::Device`].
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        Self::with(gpu, ShadingOptions::default())
    }

    /// As [`crate::Shader::with`].
    ///
    /// # Errors
    /// [`GpuError::Device`].
    pub fn with(gpu: &Gpu, options: ShadingOptions) -> Result<Self, GpuError> {
        let module = compile(gpu, Program::Forward(gpu.filtering(), options.extras()))?;
        let tables = TableBindings::new(gpu, options.extras())?;
        gpu.checked(|| {
            let inputs = input_layout(gpu.device());
            let pipeline = pipeline(gpu.device(), &module, &[Some(tables.layout()), Some(&inputs)]);
            Ok(Self { pipeline, tables, inputs, textures: options.textures })
        })
    }

    /// Draws triangles, three vertices each, and gives the radiance towards the eye of each pixel, row by row from the top;
    /// alpha is 1 where there is a surface and 0 elsewhere.
    ///
    /// # Errors
    /// As [`crate::Shader::shade`]; the material counts as point 0. [`GpuError::TableTooLarge`] for a picture that is larger
    /// than the device's textures.
    pub fn draw(
        &self,
        gpu: &Gpu,
        tables: Tables<'_>,
        view: &ForwardView,
        material: &ForwardMaterial,
        triangles: &[ForwardVertex],
        lights: &[AreaLight],
    ) -> Result<Vec<[f32; 4]>, GpuError> {
        check_size(gpu, view)?;
        let tables = self.tables.bound(tables);
        let uniform = uniform(view, material, lights.len(), tables)?;
        let lights = EncodedLights::of(lights, self.textures.as_ref())?;
        let bound = self.tables.bind(gpu, tables, self.textures.as_ref())?;
        let bytes = gpu.checked(|| {
            let inputs = self.bind_inputs(gpu, &uniform, &lights);
            let pixels = self.render(gpu, view, triangles, &bound, &inputs);
            read_back(gpu, &pixels)
        })?;
        let row = row_bytes(view.width) as usize / 4;
        let pixel = |w: &[u32; 4]| w.map(f32::from_bits);
        Ok(bytes
            .chunks(row)
            .flat_map(|row| row[..4 * view.width as usize].as_chunks::<4>().0.iter().map(pixel))
            .collect())
    }

    fn bind_inputs(&self, gpu: &Gpu, uniform: &ForwardLayout, lights: &EncodedLights) -> BindGroup {
        let device = gpu.device();
        let buffer = |contents: &[u8], usage| {
            device.create_buffer_init(&BufferInitDescriptor { label: Some("ltc forward"), contents, usage })
        };
        let buffers = [
            buffer(bytemuck::bytes_of(uniform), BufferUsages::UNIFORM),
            buffer(bytemuck::cast_slice(&lights.records), BufferUsages::STORAGE),
            buffer(bytemuck::cast_slice(&lights.vertices), BufferUsages::STORAGE),
        ];
        let entries: Vec<_> = (0..)
            .zip(&buffers)
            .map(|(binding, b)| wgpu::BindGroupEntry { binding, resource: b.as_entire_binding() })
            .collect();
        let label = Some("ltc forward");
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label,
            layout: &self.inputs,
            entries: &entries,
        })
    }

    fn render(
        &self,
        gpu: &Gpu,
        view: &ForwardView,
        triangles: &[ForwardVertex],
        tables: &BindGroup,
        inputs: &BindGroup,
    ) -> wgpu::Buffer {
        let device = gpu.device();
        let (target, depth) = (
            texture(device, view, TARGET, wgpu::TextureUsages::COPY_SRC),
            texture(device, view, DEPTH, wgpu::TextureUsages::empty()),
        );
        let vertices = device.create_buffer_init(&BufferInitDescriptor {
            label: Some("ltc forward"),
            contents: bytemuck::cast_slice(triangles),
            usage: BufferUsages::VERTEX,
        });
        let mut encoder = device.create_command_encoder(&Default::default());
        let (colour, depth) =
            (target.create_view(&Default::default()), depth.create_view(&Default::default()));
        let clear =
            |value| wgpu::Operations { load: wgpu::LoadOp::Clear(value), store: wgpu::StoreOp::Store };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("ltc forward"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &colour,
                depth_slice: None,
                resolve_target: None,
                ops: clear(wgpu::Color::TRANSPARENT),
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &depth,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(1.0),
                    store: wgpu::StoreOp::Discard,
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, tables, &[]);
        pass.set_bind_group(1, inputs, &[]);
        if !triangles.is_empty() {
            pass.set_vertex_buffer(0, vertices.slice(..));
            pass.draw(0..triangles.len() as u32, 0..1);
        }
        drop(pass);
        let pixels = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("ltc forward"),
            size: u64::from(row_bytes(view.width)) * u64::from(view.height),
            usage: BufferUsages::COPY_DST | BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(row_bytes(view.width)),
            rows_per_image: None,
        };
        let to = wgpu::TexelCopyBufferInfo { buffer: &pixels, layout };
        encoder.copy_texture_to_buffer(target.as_image_copy(), to, target.size());
        gpu.queue().submit([encoder.finish()]);
        pixels
    }
}

fn row_bytes(width: u32) -> u32 {
    (16 * width).next_multiple_of(ROW)
}

fn check_size(gpu: &Gpu, view: &ForwardView) -> Result<(), GpuError> {
    let limit = gpu.device().limits().max_texture_dimension_2d;
    for (what, found) in [("picture's width", view.width), ("picture's height", view.height)] {
        if found == 0 || found > limit {
            return Err(GpuError::TableTooLarge { what, found, limit });
        }
    }
    Ok(())
}

/// The checks are those of a surface point.
fn uniform(
    view: &ForwardView,
    material: &ForwardMaterial,
    lights: usize,
    tables: Tables<'_>,
) -> Result<ForwardLayout, GpuError> {
    let ForwardMaterial { alpha_x, alpha_y, isotropic, slice, f0, f90, albedo } = *material;
    let point = SurfacePoint {
        position: view.eye,
        normal: Vec3::Z,
        tangent: Vec3::X,
        wo: Vec3::Z,
        alpha_x,
        alpha_y,
        isotropic,
        slice,
        f0,
        f90,
        albedo,
    };
    let checked = point.encode(0, tables)?;
    Ok(ForwardLayout {
        clip_from_world: view.clip_from_world.to_cols_array_2d(),
        eye: view.eye.to_array(),
        light_count: lights as u32,
        f0: checked.f0,
        f90: checked.f90,
        albedo: checked.albedo,
        table: checked.table,
        alpha_x: checked.alpha_x,
        alpha_y: checked.alpha_y,
        unused: [0; 2],
    })
}

fn input_layout(device: &wgpu::Device) -> BindGroupLayout {
    let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: ShaderStages::VERTEX_FRAGMENT,
        ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
        count: None,
    };
    let storage = wgpu::BufferBindingType::Storage { read_only: true };
    let fragment = |binding| wgpu::BindGroupLayoutEntry {
        visibility: ShaderStages::FRAGMENT,
        ..entry(binding, storage)
    };
    let entries = [entry(0, wgpu::BufferBindingType::Uniform), fragment(1), fragment(2)];
    let label = Some("ltc forward");
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label, entries: &entries })
}

fn pipeline(
    device: &wgpu::Device,
    module: &wgpu::ShaderModule,
    groups: &[Option<&BindGroupLayout>],
) -> wgpu::RenderPipeline {
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("ltc forward"),
        bind_group_layouts: groups,
        immediate_size: 0,
    });
    let attributes = vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Float32x3];
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("ltc forward"),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module,
            entry_point: Some("vertex_main"),
            compilation_options: Default::default(),
            buffers: &[Some(wgpu::VertexBufferLayout {
                array_stride: size_of::<ForwardVertex>() as u64,
                step_mode: wgpu::VertexStepMode::Vertex,
                attributes: &attributes,
            })],
        },
        primitive: Default::default(),
        depth_stencil: Some(wgpu::DepthStencilState {
            format: DEPTH,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Less),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module,
            entry_point: Some("fragment_main"),
            compilation_options: Default::default(),
            targets: &[Some(TARGET.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}

fn texture(
    device: &wgpu::Device,
    view: &ForwardView,
    format: TextureFormat,
    further: wgpu::TextureUsages,
) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: Some("ltc forward"),
        size: wgpu::Extent3d { width: view.width, height: view.height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | further,
        view_formats: &[],
    })
}
