//! Tables as textures.

use glam::DMat3;
use ltc_core::Matrix as _;
use ltc_table::{Kind, Precision, Table, ktx2};
use wgpu::util::{BufferInitDescriptor, DeviceExt, TextureDataOrder};
use wgpu::{Texture, TextureDimension, TextureViewDimension};

use crate::layout::AxesUniform;
use crate::refined::Refined;
use crate::{BakedSlices, Filtering, Gpu, GpuError, Texels};

/// A table on the device: three RGBA groups in the layout of [`ltc_table::ktx2`], and its axes.
#[derive(Debug)]
pub struct TableTextures {
    kind: Kind,
    axes: AxesUniform,
    texels: Storage,
    refined: bool,
}

/// Where texels are.
#[derive(Debug)]
pub(crate) enum Storage {
    Texture(Texture),
    Buffer(wgpu::Buffer),
}

/// What is bound of them.
pub(crate) enum View<'a> {
    Texture(wgpu::TextureView),
    Buffer(&'a wgpu::Buffer),
}

impl View<'_> {
    pub fn binding(&self) -> wgpu::BindingResource<'_> {
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
    /// For materials that have a slice of their own.
    pub baked: Option<&'a BakedSlices>,
}

impl Storage {
    /// As tables of this kind are bound.
    pub fn view(&self, kind: Kind) -> View<'_> {
        match self {
            Self::Buffer(buffer) => View::Buffer(buffer),
            Self::Texture(texture) => View::Texture(texture.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(view_dimension(kind)),
                ..Default::default()
            })),
        }
    }

    /// Bytes of memory on the device.
    pub fn bytes(&self) -> u64 {
        match self {
            Self::Buffer(buffer) => buffer.size(),
            Self::Texture(texture) => {
                let size = texture.size();
                let count = size.width * size.height * size.depth_or_array_layers;
                u64::from(count) * u64::from(texture.format().block_copy_size(None).unwrap_or(0))
            }
        }
    }

    /// What stands where nothing was given: one texel, never looked at.
    pub fn placeholder(gpu: &Gpu, kind: Kind) -> Self {
        let size = wgpu::Extent3d { width: 1, height: 1, depth_or_array_layers: ktx2::GROUPS as u32 };
        let bytes = [0; 16 * ktx2::GROUPS];
        create(gpu, kind, size, &bytes[..4 * precision(gpu).bytes() * ktx2::GROUPS])
    }
}

impl TableTextures {
    /// Uploads a table of either kind, rounded to the device's [`Texels`].
    ///
    /// # Errors
    /// [`GpuError::TableTooLarge`] when the device's textures are too small for it, [`GpuError::UnsupportedAxis`],
    /// [`GpuError::TableTexels`] where 16 bits cannot hold it,
    /// [`GpuError::Device`].
    pub fn upload(gpu: &Gpu, table: &Table) -> Result<Self, GpuError> {
        let (kind, axes) = (table.kind(), AxesUniform::of(table)?);
        let layers = gpu.device().limits().max_texture_dimension_3d as usize;
        let precision = precision(gpu);
        let refined =
            (gpu.filtering() == Filtering::Refined).then(|| Refined::of(table, precision, layers)).flatten();
        let (size, bytes) = match &refined {
            Some(refined) => (refined.extent(), entry_bytes(precision, &refined.slices)?),
            None => (extent(table), texel_bytes(precision, table)?),
        };
        check_extent(gpu, kind, size)?;
        let texels = gpu.checked(|| Ok(create(gpu, kind, size, &bytes)))?;
        Ok(Self { kind, axes, texels, refined: refined.is_some() })
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
        self.texels.bytes()
    }

    /// Whether it is in the layout of [`Filtering::Refined`], which the isotropic table shares with [`Filtering::Hardware`].
    pub(crate) fn is_refined(&self) -> bool {
        self.refined
    }

    pub(crate) fn axes(&self) -> AxesUniform {
        self.axes
    }

    pub(crate) fn view(&self) -> View<'_> {
        self.texels.view(self.kind)
    }
}

/// Storage buffers hold 32 bits.
pub(crate) fn precision(gpu: &Gpu) -> Precision {
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

/// Groups of four channels one after the other, slices within each, in the layout of a table's texels.
pub(crate) fn entry_bytes(precision: Precision, slices: &[Vec<[f64; 12]>]) -> Result<Vec<u8>, GpuError> {
    let mut bytes = Vec::new();
    for group in 0..ktx2::GROUPS {
        for entry in slices.iter().flatten() {
            let rounded = entry.map(|x| precision.round(x));
            let [m @ .., _, _, _] = rounded;
            if DMat3::from_row_array(m).determinant() <= 0.0 {
                let reason = "a matrix loses its sign".to_owned();
                return Err(GpuError::TableTexels { texels: precision.name(), reason });
            }
            rounded[4 * group..4 * group + 4].iter().for_each(|value| precision.put(*value, &mut bytes));
        }
    }
    Ok(bytes)
}

impl Refined {
    fn extent(&self) -> wgpu::Extent3d {
        let [width, height, thetas] = self.nodes.map(|len| len as u32);
        let depth = thetas * (self.slices.len() * ktx2::GROUPS) as u32;
        wgpu::Extent3d { width, height, depth_or_array_layers: depth }
    }
}

fn extent(table: &Table) -> wgpu::Extent3d {
    let shape = table.shape();
    let [width, height] = [shape[shape.len() - 1] as u32, shape[shape.len() - 2] as u32];
    let slices: usize = shape[..shape.len() - 2].iter().product();
    wgpu::Extent3d { width, height, depth_or_array_layers: (slices * ktx2::GROUPS) as u32 }
}

pub(crate) fn check_extent(gpu: &Gpu, kind: Kind, size: wgpu::Extent3d) -> Result<(), GpuError> {
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

pub(crate) fn create(gpu: &Gpu, kind: Kind, size: wgpu::Extent3d, bytes: &[u8]) -> Storage {
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

pub(crate) fn view_dimension(kind: Kind) -> TextureViewDimension {
    match kind {
        Kind::Isotropic => TextureViewDimension::D2Array,
        Kind::Anisotropic => TextureViewDimension::D3,
    }
}
