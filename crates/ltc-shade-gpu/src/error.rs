//! What can go wrong on the way to the GPU and back.

use ltc_core::InputError;

/// Why a device could not be opened, or a batch not be run.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GpuError {
    /// `WGPU_BACKEND` holds no name of a back end.
    #[error("WGPU_BACKEND is \"{value}\"; it must list some of vulkan, gl, metal, dx12")]
    UnknownBackend {
        /// What it holds.
        value: String,
    },
    /// There is no graphics driver at all, or none that can compute.
    #[error(
        "no GPU adapter found among the back ends {backends}{rejected}; a software driver will do, for example \
         Debian's package mesa-vulkan-drivers"
    )]
    NoAdapter {
        /// The back ends that were asked.
        backends: String,
        /// Adapters that were there and why each was of no use, or empty.
        rejected: String,
    },
    /// Filtering of 32-bit float textures was asked for and the device has none.
    #[error("{device} cannot filter 32-bit float textures; use exact filtering")]
    NotFilterable {
        /// The device.
        device: String,
    },
    /// A table does not fit the device.
    #[error("the table's {what} is {found}, the device allows {limit}")]
    TableTooLarge {
        /// Which extent.
        what: &'static str,
        /// What the table needs.
        found: u32,
        /// What the device has.
        limit: u32,
    },
    /// A table cannot be held in the numbers asked for.
    #[error("the table does not survive as {texels}: {reason}")]
    TableTexels {
        /// Which numbers.
        texels: &'static str,
        /// What is lost.
        reason: String,
    },
    /// A table was uploaded in a layout that the pipeline does not read.
    #[error("the table was uploaded for another filtering than that of the pipeline")]
    OtherFiltering,
    /// A table's axis is spaced in a way that the shaders do not know.
    #[error("the shaders know the mapping {mapping} for theta only, not for {quantity}")]
    UnsupportedAxis {
        /// How it is spaced.
        mapping: &'static str,
        /// The axis.
        quantity: &'static str,
    },
    /// A point needs a table that was not given.
    #[error("{item} {index} needs the {table} table, which was not given")]
    MissingTable {
        /// What needs it: a point or a query.
        item: &'static str,
        /// Its index.
        index: usize,
        /// Which table.
        table: &'static str,
    },
    /// A point or query looks into a slice that is not there, or that was baked for other widths.
    #[error("{item} {index} looks into slice {slice}, which is not there or was baked for other widths")]
    WrongSlice {
        /// What looks.
        item: &'static str,
        /// Its index.
        index: usize,
        /// The slice.
        slice: u32,
    },
    /// Slices are baked of anisotropic tables alone.
    #[error("slices are baked of an anisotropic table; this one is isotropic")]
    NotAnisotropic,
    /// A table could not be looked into.
    #[error(transparent)]
    Table(#[from] ltc_table::TableError),
    /// An isotropic table or material was asked for an anisotropic lobe.
    #[error(
        "{item} {index} is isotropic, but has alpha_x = {alpha_x}, alpha_y = {alpha_y}: they must be equal"
    )]
    NotIsotropic {
        /// What asked: a point or a query.
        item: &'static str,
        /// Its index.
        index: usize,
        /// Width along the tangent.
        alpha_x: f64,
        /// Width along the bitangent.
        alpha_y: f64,
    },
    /// An input is invalid; nothing of its batch was run.
    #[error("{item} {index}: {source}")]
    Input {
        /// What it belongs to.
        item: &'static str,
        /// The index of that item.
        index: usize,
        /// What is wrong.
        source: InputError,
    },
    /// The textures of lights do not fit the device together.
    #[error("the textures of the lights together are {found} texels {what}, the device allows {limit}")]
    TexturesTooLarge {
        /// `wide` or `high`.
        what: &'static str,
        /// What they need.
        found: u32,
        /// What the device has.
        limit: u32,
    },
    /// A light names a texture that is not there; there are none in pipelines without textures.
    #[error("light {light} has texture number {texture}, of {count}")]
    MissingTexture {
        /// The index of the light.
        light: usize,
        /// The number that it names.
        texture: usize,
        /// How many there are.
        count: usize,
    },
    /// A light that is not flat and bounded by edges has a texture.
    #[error("light {light} is a {kind}; only quads and polygons have textures")]
    NotTexturable {
        /// The index of the light.
        light: usize,
        /// What it is.
        kind: crate::LightKind,
    },
    /// A single item is larger than a buffer of the device.
    #[error("{what} takes {bytes} bytes, the device's buffers hold {limit}")]
    TooLarge {
        /// What is too large.
        what: &'static str,
        /// Its size.
        bytes: u64,
        /// The device's limit.
        limit: u64,
    },
    /// The device or its driver reported an error.
    #[error("the graphics device failed: {reason}")]
    Device {
        /// Its words.
        reason: String,
    },
    /// A result was left unwritten, or is NaN or infinite: the driver or the shader is broken.
    #[error("{item} {index} came back {what}")]
    BadOutput {
        /// What the result belongs to.
        item: &'static str,
        /// The index of that item.
        index: usize,
        /// `unwritten` or the value.
        what: String,
    },
}

impl GpuError {
    /// For `map_err` on a check of item number `index`.
    pub(crate) fn input(item: &'static str, index: usize) -> impl FnOnce(InputError) -> Self {
        move |source| Self::Input { item, index, source }
    }

    pub(crate) fn device(reason: impl ToString) -> Self {
        Self::Device { reason: reason.to_string() }
    }
}
