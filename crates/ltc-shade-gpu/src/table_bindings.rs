//! Group 0: tables and what goes with them.

use bytemuck::Zeroable;
use ltc_table::Kind;
use wgpu::util::{BufferInitDescriptor, DeviceExt};
use wgpu::{BindGroup, BindGroupLayout, ShaderStages};

use crate::layout::AxesUniform;
use crate::modules::Extras;
use crate::table_textures::{Storage, view_dimension};
use crate::{Filtering, Gpu, GpuError, LightTextures, Tables};

/// The layout of group 0, as `tables_exact.wgsl` and its like have it.
#[derive(Debug)]
pub(crate) struct TableBindings {
    layout: BindGroupLayout,
    extras: Extras,
}

impl TableBindings {
    pub fn new(gpu: &Gpu, extras: Extras) -> Result<Self, GpuError> {
        let hardware = gpu.filtering().is_by_texture_unit();
        let mut entries = vec![
            entry(0, UNIFORM),
            entry(1, texels(gpu, Kind::Isotropic)),
            entry(2, UNIFORM),
            entry(3, texels(gpu, Kind::Anisotropic)),
        ];
        if hardware {
            entries.push(entry(4, wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering)));
        }
        entries.extend(extras.textured.then(LightTextures::layout_entry));
        if extras.baked {
            entries.extend([entry(6, UNIFORM), entry(7, texels(gpu, Kind::Isotropic))]);
        }
        let label = Some("ltc tables");
        let descriptor = wgpu::BindGroupLayoutDescriptor { label, entries: &entries };
        let layout = gpu.checked(|| Ok(gpu.device().create_bind_group_layout(&descriptor)))?;
        Ok(Self { layout, extras })
    }

    pub fn layout(&self) -> &BindGroupLayout {
        &self.layout
    }

    /// Of these tables those that the layout has a place for.
    pub fn bound<'a>(&self, tables: Tables<'a>) -> Tables<'a> {
        Tables { baked: tables.baked.filter(|_| self.extras.baked), ..tables }
    }

    /// Binds the tables that there are, and placeholders for the others; `textures` where the layout has them.
    pub fn bind(
        &self,
        gpu: &Gpu,
        tables: Tables<'_>,
        textures: Option<&LightTextures>,
    ) -> Result<BindGroup, GpuError> {
        let refined = gpu.filtering() == Filtering::Refined;
        if tables.anisotropic.is_some_and(|table| table.is_refined() != refined) {
            return Err(GpuError::OtherFiltering);
        }
        gpu.checked(|| {
            let [flat, full] =
                [Kind::Isotropic, Kind::Anisotropic].map(|kind| Storage::placeholder(gpu, kind));
            let none = AxesUniform::zeroed();
            let held = [
                tables.isotropic.map_or((none, flat.view(Kind::Isotropic)), |t| (t.axes(), t.view())),
                tables.anisotropic.map_or((none, full.view(Kind::Anisotropic)), |t| (t.axes(), t.view())),
                tables.baked.map_or((none, flat.view(Kind::Isotropic)), |slices| slices.bound()),
            ];
            let axes = held.each_ref().map(|(axes, _)| {
                gpu.device().create_buffer_init(&BufferInitDescriptor {
                    label: Some("ltc axes"),
                    contents: bytemuck::bytes_of(axes),
                    usage: wgpu::BufferUsages::UNIFORM,
                })
            });
            let sampler = gpu.device().create_sampler(&wgpu::SamplerDescriptor {
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                ..Default::default()
            });
            let bound = |binding, resource| wgpu::BindGroupEntry { binding, resource };
            let pair = |first: u32, k: usize| {
                [bound(first, axes[k].as_entire_binding()), bound(first + 1, held[k].1.binding())]
            };
            let mut entries: Vec<_> = [pair(0, 0), pair(2, 1)].into_iter().flatten().collect();
            if gpu.filtering().is_by_texture_unit() {
                entries.push(bound(4, wgpu::BindingResource::Sampler(&sampler)));
            }
            let textures = textures.map(LightTextures::view);
            entries.extend(textures.as_ref().map(LightTextures::entry));
            if self.extras.baked {
                entries.extend(pair(6, 2));
            }
            let (label, layout) = (Some("ltc tables"), &self.layout);
            let descriptor = wgpu::BindGroupDescriptor { label, layout, entries: &entries };
            Ok(gpu.device().create_bind_group(&descriptor))
        })
    }
}

const UNIFORM: wgpu::BindingType = wgpu::BindingType::Buffer {
    ty: wgpu::BufferBindingType::Uniform,
    has_dynamic_offset: false,
    min_binding_size: None,
};

fn entry(binding: u32, ty: wgpu::BindingType) -> wgpu::BindGroupLayoutEntry {
    let visibility = ShaderStages::COMPUTE | ShaderStages::FRAGMENT;
    wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None }
}

fn texels(gpu: &Gpu, kind: Kind) -> wgpu::BindingType {
    match gpu.filtering() {
        Filtering::Buffer => wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Storage { read_only: true },
            has_dynamic_offset: false,
            min_binding_size: None,
        },
        filtering => wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: filtering.is_by_texture_unit() },
            view_dimension: view_dimension(kind),
            multisampled: false,
        },
    }
}
