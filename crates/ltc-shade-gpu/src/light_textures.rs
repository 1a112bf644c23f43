//! Textures of lights on the device.

use glam::Vec3;
use ltc_core::{InputError, PrefilteredTexture, TextureFrame, check_range};
use wgpu::util::{DeviceExt, TextureDataOrder};
use wgpu::{BindGroupEntry, BindGroupLayoutEntry, ShaderStages};

use crate::{Gpu, GpuError, TextureAtlas};

/// Prefiltered textures on the device, for lights to name by their numbers. Cheap to clone.
#[derive(Clone, Debug)]
pub struct LightTextures {
    atlas: wgpu::Texture,
    /// The largest value of each.
    brightest: Vec<[f32; 3]>,
}

/// A texture on a flat light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightTexture {
    /// Its number in [`LightTextures`].
    pub number: usize,
    /// How it lies, in the light's plane and space: (u, v) is at `origin + u · axis_u + v · axis_v`. A light that does not fill the
    /// texture's square should be its coverage ([`ltc_core::TexelGrid`]); one that reaches beyond it sees the texture's edges there.
    pub frame: TextureFrame<f32>,
}

impl LightTexture {
    /// A texture that fills a parallelogram: (0, 0) at the first corner, u towards the second, v towards the last. Seen from
    /// behind it is mirrored.
    pub fn filling(number: usize, corners: &[Vec3; 4]) -> Self {
        Self { number, frame: TextureFrame::filling(corners) }
    }
}

/// Where the textures are bound, in the group of the tables.
const BINDING: u32 = 5;

impl LightTextures {
    /// Uploads textures, numbered in their order: 16 bytes for each texel of all levels, some four times those of the pictures.
    ///
    /// # Errors
    /// [`GpuError::TexturesTooLarge`] where the device's textures cannot hold them together, [`GpuError::Device`].
    pub fn upload(gpu: &Gpu, textures: &[PrefilteredTexture]) -> Result<Self, GpuError> {
        let atlas = TextureAtlas::of(textures);
        let limit = gpu.device().limits().max_texture_dimension_2d;
        for (what, found) in [("wide", atlas.width()), ("high", atlas.height())] {
            if found > limit {
                return Err(GpuError::TexturesTooLarge { what, found, limit });
            }
        }
        let descriptor = wgpu::TextureDescriptor {
            label: Some("ltc light textures"),
            size: wgpu::Extent3d { width: atlas.width(), height: atlas.height(), depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba32Float,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        };
        let bytes = bytemuck::cast_slice(atlas.texels());
        let order = TextureDataOrder::LayerMajor;
        let atlas = gpu
            .checked(|| Ok(gpu.device().create_texture_with_data(gpu.queue(), &descriptor, order, bytes)))?;
        Ok(Self { atlas, brightest: textures.iter().map(PrefilteredTexture::brightest).collect() })
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.brightest.len()
    }

    /// Bytes of memory on the device.
    pub fn bytes(&self) -> u64 {
        16 * u64::from(self.atlas.width()) * u64::from(self.atlas.height())
    }

    /// Whether the texture exists, lies in a plane, and is not too bright for `radiance` times it to stay finite.
    pub(crate) fn check(&self, texture: &LightTexture, radiance: Vec3, light: usize) -> Result<(), GpuError> {
        let &LightTexture { number, frame } = texture;
        let Some(brightest) = self.brightest.get(number) else {
            return Err(GpuError::MissingTexture { light, texture: number, count: self.count() });
        };
        let bright = (0..3).map(|c| f64::from(brightest[c]) * f64::from(radiance[c])).fold(0.0, f64::max);
        let in_range = |_: ()| check_range("radiance times texture", bright, 0.0, f64::from(f32::MAX) / 4.0);
        frame.check().and_then(in_range).map(drop).map_err(|source: InputError| GpuError::Input {
            item: "light",
            index: light,
            source,
        })
    }

    pub(crate) fn layout_entry() -> BindGroupLayoutEntry {
        BindGroupLayoutEntry {
            binding: BINDING,
            visibility: ShaderStages::COMPUTE | ShaderStages::FRAGMENT,
            ty: wgpu::BindingType::Texture {
                sample_type: wgpu::TextureSampleType::Float { filterable: false },
                view_dimension: wgpu::TextureViewDimension::D2,
                multisampled: false,
            },
            count: None,
        }
    }

    pub(crate) fn view(&self) -> wgpu::TextureView {
        self.atlas.create_view(&Default::default())
    }

    pub(crate) fn entry(view: &wgpu::TextureView) -> BindGroupEntry<'_> {
        BindGroupEntry { binding: BINDING, resource: wgpu::BindingResource::TextureView(view) }
    }
}
