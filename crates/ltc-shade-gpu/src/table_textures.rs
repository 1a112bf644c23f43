//! Tables as textures.

use bytemuck::Zeroable;
use ltc_table::{Kind, Precision, Table, ktx2};
use wgpu::util::{BufferInitDescriptor, DeviceExt, TextureDataOrder};
use wgpu::{BindGroup, BindGroupLayout, ShaderStages, Texture, TextureDimension, TextureViewDimension};

use crate::layout::AxesUniform;
use crate::{Filtering, Gpu, GpuError, LightTextures, Texels};

/// A table on the device: three RGBA groups in the layout of [`ltc_table::ktx2`], and its axes.
#[derive(Debug)]
pub struct TableTextures {
    kind: Kind,
    axes: AxesUniform,
    texels: Storage,
}

/// Where the texels are.
#[derive(Debug)]
enum Storage {
    Texture(Texture),
    Buffer(wgpu::Buffer),
}

/// What is bound of a table.
enum View<'a> {
    Texture(wgpu::TextureView),
    Buffer(&'a wgpu::Buffer),
}

impl View<'_> {
    fn binding(&self) -> wgpu::BindingResource<'_> {
        match self {
            Self::Texture(view) => wgpu::BindingResource::TextureView(view),
            Self::Buffer(buffer) => buffer.as_entire_binding(),
        }
    }
}

/// The tables that a pass may look into. A missing one is an error only for whoever needs it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Tables<'a> {
    /// For isotropic materials; they go to the anisotropic table where this one is missing.
    pub isotropic: Option<&'a TableTextures>,
    /// For anisotropic materials.
    pub anisotropic: Option<&'a TableTextures>,
}

impl TableTextures {
    /// Uploads a table of either kind, rounded to the device's [`Texels`].
    ///
    /// # Errors
    /// [`GpuError::TableTooLarge`] when the device's textures are too small for it, [`GpuError::UnsupportedAxis`],
    /// [`GpuError::TableTexels`] where 16 bits cannot hold it,
    /// [`GpuError::Device`].
    pub fn upload(gpu: &Gpu, table: &Table) -> Result<Self, GpuError> {
        let axes = AxesUniform::of(table)?;
        let size = extent(table);
        check_extent(gpu, table.kind(), size)?;
        let bytes = texel_bytes(precision(gpu), table)?;
        let texels = gpu.checked(|| Ok(create(gpu, table.kind(), size, &bytes)))?;
        Ok(Self { kind: table.kind(), axes, texels })
    }

    /// The uniform `LtcAxes` of a table, for hosts that hold its texels elsewhere.
    ///
    /// # Errors
    /// [`GpuError::UnsupportedAxis`].
    pub fn axes_bytes(table: &Table) -> Result<Vec<u8>, GpuError> {
        Ok(bytemuck::bytes_of(&AxesUniform::of(table)?).to_vec())
    }

    /// Isotropic or anisotropic.
    pub fn kind(&self) -> Kind {
        self.kind
    }

    /// Bytes of memory on the device.
    pub fn bytes(&self) -> u64 {
        match &self.texels {
            Storage::Buffer(buffer) => buffer.size(),
            Storage::Texture(texture) => {
                let size = texture.size();
                let count = size.width * size.height * size.depth_or_array_layers;
                u64::from(count) * u64::from(texture.format().block_copy_size(None).unwrap_or(0))
            }
        }
    }

    /// What stands where no table was given: one texel, never looked at.
    fn placeholder(gpu: &Gpu, kind: Kind) -> Self {
        let size = wgpu::Extent3d { width: 1, height: 1, depth_or_array_layers: ktx2::GROUPS as u32 };
        let bytes = [0; 16 * ktx2::GROUPS];
        let bytes = &bytes[..4 * precision(gpu).bytes() * ktx2::GROUPS];
        Self { kind, axes: AxesUniform::zeroed(), texels: create(gpu, kind, size, bytes) }
    }

    fn view(&self) -> View<'_> {
        match &self.texels {
            Storage::Buffer(buffer) => View::Buffer(buffer),
            Storage::Texture(texture) => View::Texture(texture.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(view_dimension(self.kind)),
                ..Default::default()
            })),
        }
    }
}

/// Storage buffers hold 32 bits.
fn precision(gpu: &Gpu) -> Precision {
    let texels = if gpu.filtering() == Filtering::Buffer { Texels::F32 } else { gpu.texels() };
    match texels {
        Texels::F32 => Precision::F32,
        Texels::F16 => Precision::F16,
    }
}

fn texel_bytes(precision: Precision, table: &Table) -> Result<Vec<u8>, GpuError> {
    if precision == Precision::F16 {
        let lost = |error: ltc_table::TableError| GpuError::TableTexels {
            texels: precision.name(),
            reason: error.to_string(),
        };
        table.rounded(precision).map_err(lost)?;
    }
    let mut bytes = Vec::new();
    ktx2::texels(table).iter().flatten().for_each(|value| precision.put(*value, &mut bytes));
    Ok(bytes)
}

fn extent(table: &Table) -> wgpu::Extent3d {
    let shape = table.shape();
    let [width, height] = [shape[shape.len() - 1] as u32, shape[shape.len() - 2] as u32];
    let slices: usize = shape[..shape.len() - 2].iter().product();
    wgpu::Extent3d { width, height, depth_or_array_layers: (slices * ktx2::GROUPS) as u32 }
}

fn check_extent(gpu: &Gpu, kind: Kind, size: wgpu::Extent3d) -> Result<(), GpuError> {
    let limits = gpu.device().limits();
    let side = match kind {
        Kind::Isotropic => limits.max_texture_dimension_2d,
        Kind::Anisotropic => limits.max_texture_dimension_3d,
    };
    let layers = match kind {
        Kind::Isotropic => limits.max_texture_array_layers,
        Kind::Anisotropic => side,
    };
    for (what, found, limit) in [
        ("width", size.width, side),
        ("height", size.height, side),
        ("depth", size.depth_or_array_layers, layers),
    ] {
        if found > limit {
            return Err(GpuError::TableTooLarge { what, found, limit });
        }
    }
    Ok(())
}

fn create(gpu: &Gpu, kind: Kind, size: wgpu::Extent3d, bytes: &[u8]) -> Storage {
    if gpu.filtering() == Filtering::Buffer {
        let usage = wgpu::BufferUsages::STORAGE;
        let descriptor = BufferInitDescriptor { label: Some("ltc table"), contents: bytes, usage };
        return Storage::Buffer(gpu.device().create_buffer_init(&descriptor));
    }
    let dimension = match kind {
        Kind::Isotropic => TextureDimension::D2,
        Kind::Anisotropic => TextureDimension::D3,
    };
    let descriptor = wgpu::TextureDescriptor {
        label: Some("ltc table"),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension,
        format: match gpu.texels() {
            Texels::F32 => wgpu::TextureFormat::Rgba32Float,
            Texels::F16 => wgpu::TextureFormat::Rgba16Float,
        },
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    };
    let order = TextureDataOrder::LayerMajor;
    Storage::Texture(gpu.device().create_texture_with_data(gpu.queue(), &descriptor, order, bytes))
}

fn view_dimension(kind: Kind) -> TextureViewDimension {
    match kind {
        Kind::Isotropic => TextureViewDimension::D2Array,
        Kind::Anisotropic => TextureViewDimension::D3,
    }
}

/// The bindings of group 0, as `tables_exact.wgsl` and `tables_hardware.wgsl` have them.
pub(crate) fn bind_group_layout(gpu: &Gpu) -> Result<BindGroupLayout, GpuError> {
    textured_layout(gpu, false)
}

/// The same, with that of `light_textures.wgsl` if `textured`.
pub(crate) fn textured_layout(gpu: &Gpu, textured: bool) -> Result<BindGroupLayout, GpuError> {
    let hardware = gpu.filtering() == Filtering::Hardware;
    let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: ShaderStages::COMPUTE | ShaderStages::FRAGMENT,
        ty,
        count: None,
    };
    let uniform = wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Uniform,
        has_dynamic_offset: false,
        min_binding_size: None,
    };
    let texture = |kind| match gpu.filtering() {
        Filtering::Buffer => wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Storage { read_only: true },
            has_dynamic_offset: false,
            min_binding_size: None,
        },
        Filtering::Exact | Filtering::Hardware => wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: hardware },
            view_dimension: view_dimension(kind),
            multisampled: false,
        },
    };
    let mut entries = vec![
        entry(0, uniform),
        entry(1, texture(Kind::Isotropic)),
        entry(2, uniform),
        entry(3, texture(Kind::Anisotropic)),
    ];
    if hardware {
        entries.push(entry(4, wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering)));
    }
    entries.extend(textured.then(LightTextures::layout_entry));
    gpu.checked(|| {
        let label = Some("ltc tables");
        Ok(gpu
            .device()
            .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label, entries: &entries }))
    })
}

/// Binds the tables that there are, and placeholders for the others.
pub(crate) fn bind_group(
    gpu: &Gpu,
    layout: &BindGroupLayout,
    tables: Tables<'_>,
) -> Result<BindGroup, GpuError> {
    textured_group(gpu, layout, tables, None)
}

/// The same, with the textures that [`textured_layout`] was made for.
pub(crate) fn textured_group(
    gpu: &Gpu,
    layout: &BindGroupLayout,
    tables: Tables<'_>,
    textures: Option<&LightTextures>,
) -> Result<BindGroup, GpuError> {
    gpu.checked(|| {
        let placeholders =
            [Kind::Isotropic, Kind::Anisotropic].map(|kind| TableTextures::placeholder(gpu, kind));
        let isotropic = tables.isotropic.unwrap_or(&placeholders[0]);
        let anisotropic = tables.anisotropic.unwrap_or(&placeholders[1]);
        let device = gpu.device();
        let axes = |table: &TableTextures| {
            device.create_buffer_init(&BufferInitDescriptor {
                label: Some("ltc axes"),
                contents: bytemuck::bytes_of(&table.axes),
                usage: wgpu::BufferUsages::UNIFORM,
            })
        };
        let (axes_2d, axes_4d) = (axes(isotropic), axes(anisotropic));
        let (view_2d, view_4d) = (isotropic.view(), anisotropic.view());
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        });
        let mut resources = vec![
            axes_2d.as_entire_binding(),
            view_2d.binding(),
            axes_4d.as_entire_binding(),
            view_4d.binding(),
        ];
        if gpu.filtering() == Filtering::Hardware {
            resources.push(wgpu::BindingResource::Sampler(&sampler));
        }
        let mut entries: Vec<_> = (0..)
            .zip(resources)
            .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource })
            .collect();
        let textures = textures.map(LightTextures::view);
        entries.extend(textures.as_ref().map(LightTextures::entry));
        let label = Some("ltc tables");
        Ok(device.create_bind_group(&wgpu::BindGroupDescriptor { label, layout, entries: &entries }))
    })
}
