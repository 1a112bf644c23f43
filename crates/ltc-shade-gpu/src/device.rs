//! A device without a window.

use std::fmt;

use wgpu::{
    Adapter, Backends, DeviceType, DownlevelFlags, ErrorFilter, Features, Instance, InstanceDescriptor,
};

use crate::{Filtering, GpuError};

/// The numbers of a table on the device.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Texels {
    /// 32 bits. Filtering them takes `FLOAT32_FILTERABLE`.
    #[default]
    F32,
    /// 16 bits: half the memory and traffic, filtered by every device, with eleven bits of each entry (`docs/gpu.md` has
    /// what that costs).
    F16,
}

/// How to choose and use a device.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct GpuOptions {
    /// Take a software driver although there is hardware: the same everywhere, for tests.
    pub software_only: bool,
    /// How tables are interpolated.
    pub filtering: Filtering,
    /// The numbers of tables.
    pub texels: Texels,
    /// The one back end to look at, as in `WGPU_BACKEND`, which is not asked then.
    pub backend: Option<&'static str>,
}

/// What a device says about itself.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GpuInfo {
    /// The adapter's name.
    pub name: String,
    /// `vulkan`, `gl`, `metal` or `dx12`.
    pub backend: String,
    /// The driver and its version.
    pub driver: String,
    /// Whether it computes on the CPU.
    pub software: bool,
}

impl fmt::Display for GpuInfo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, backend, driver, software } = self;
        let kind = if *software { "software" } else { "hardware" };
        write!(f, "{name} ({kind}, {backend}, {driver})")
    }
}

/// An open device.
#[derive(Debug)]
pub struct Gpu {
    device: wgpu::Device,
    queue: wgpu::Queue,
    info: GpuInfo,
    filtering: Filtering,
    texels: Texels,
    draws_floats: bool,
}

impl Gpu {
    /// Opens the best device there is: discrete before integrated before virtual before software, and, among equals, GL
    /// last. The environment variable `WGPU_BACKEND` (`vulkan`, `gl`, `metal`, `dx12`, or several with commas)
    /// restricts the choice.
    ///
    /// # Errors
    /// [`GpuError::NoAdapter`] with what was tried, [`GpuError::UnknownBackend`], and [`GpuError::NotFilterable`]
    /// for [`Filtering::Hardware`] and [`Filtering::Refined`] on a device without it.
    pub fn new(options: GpuOptions) -> Result<Self, GpuError> {
        let backends = match options.backend {
            Some(name) => named(name)?,
            None => backends()?,
        };
        let descriptor = InstanceDescriptor::new_without_display_handle_from_env();
        let instance = Instance::new(InstanceDescriptor { backends, ..descriptor });
        let mut adapters = pollster::block_on(instance.enumerate_adapters(backends));
        adapters.retain(|a| !options.software_only || info(a).software);
        adapters.sort_by_key(rank);
        let mut rejected = String::new();
        for adapter in adapters {
            match Self::open(&adapter, options) {
                Ok(gpu) => return Ok(gpu),
                Err(GpuError::Device { reason }) => {
                    rejected.push_str(&format!("; {} is of no use: {reason}", info(&adapter)));
                }
                Err(other) => return Err(other),
            }
        }
        Err(GpuError::NoAdapter { backends: names(backends), rejected })
    }

    fn open(adapter: &Adapter, options: GpuOptions) -> Result<Self, GpuError> {
        let info = info(adapter);
        if !adapter.get_downlevel_capabilities().flags.contains(DownlevelFlags::COMPUTE_SHADERS) {
            return Err(GpuError::device("it has no compute shaders"));
        }
        let features = adapter.features() & (Features::FLOAT32_FILTERABLE | Features::TIMESTAMP_QUERY);
        if !can_filter(features, options.filtering, options.texels) {
            return Err(GpuError::NotFilterable { device: info.to_string() });
        }
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("ltc"),
            required_features: features,
            required_limits: adapter.limits(),
            ..Default::default()
        };
        let (device, queue) =
            pollster::block_on(adapter.request_device(&descriptor)).map_err(GpuError::device)?;
        let usages = adapter.get_texture_format_features(wgpu::TextureFormat::Rgba32Float).allowed_usages;
        let draws_floats = usages.contains(wgpu::TextureUsages::RENDER_ATTACHMENT);
        let GpuOptions { filtering, texels, .. } = options;
        Ok(Self { device, queue, info, filtering, texels, draws_floats })
    }

    /// The same device, with tables interpolated and held in another way.
    ///
    /// # Errors
    /// [`GpuError::NotFilterable`].
    pub fn with_tables(&self, filtering: Filtering, texels: Texels) -> Result<Self, GpuError> {
        if !can_filter(self.device.features(), filtering, texels) {
            return Err(GpuError::NotFilterable { device: self.info.to_string() });
        }
        let (device, queue, info) = (self.device.clone(), self.queue.clone(), self.info.clone());
        Ok(Self { device, queue, info, filtering, texels, draws_floats: self.draws_floats })
    }

    /// Name, back end and driver.
    pub fn info(&self) -> &GpuInfo {
        &self.info
    }

    /// How tables are interpolated.
    pub fn filtering(&self) -> Filtering {
        self.filtering
    }

    /// The numbers of tables.
    pub fn texels(&self) -> Texels {
        self.texels
    }

    /// Whether it draws into textures of 32-bit floats; GL without extensions does not.
    pub(crate) fn draws_floats(&self) -> bool {
        self.draws_floats
    }

    pub(crate) fn device(&self) -> &wgpu::Device {
        &self.device
    }

    pub(crate) fn queue(&self) -> &wgpu::Queue {
        &self.queue
    }

    /// Runs `work`, and turns what wgpu would otherwise report by a panic into an error.
    pub(crate) fn checked<T>(&self, work: impl FnOnce() -> Result<T, GpuError>) -> Result<T, GpuError> {
        let filters = [ErrorFilter::Validation, ErrorFilter::OutOfMemory, ErrorFilter::Internal];
        let scopes = filters.map(|filter| self.device.push_error_scope(filter));
        let result = work();
        let mut first = None;
        for scope in scopes.into_iter().rev() {
            first = pollster::block_on(scope.pop()).or(first);
        }
        match first {
            Some(error) => Err(GpuError::device(error)),
            None => result,
        }
    }
}

fn can_filter(features: Features, filtering: Filtering, texels: Texels) -> bool {
    let filters_f32 = filtering.is_by_texture_unit() && texels == Texels::F32;
    !filters_f32 || features.contains(Features::FLOAT32_FILTERABLE)
}

fn backends() -> Result<Backends, GpuError> {
    match std::env::var("WGPU_BACKEND") {
        Err(_) => Ok(Backends::all()),
        Ok(value) => named(&value),
    }
}

fn named(list: &str) -> Result<Backends, GpuError> {
    let chosen = Backends::from_comma_list(list);
    if chosen.is_empty() { Err(GpuError::UnknownBackend { value: list.to_owned() }) } else { Ok(chosen) }
}

/// The names of those that were compiled in; of all, where none was.
fn names(backends: Backends) -> String {
    let compiled_in = backends & Instance::enabled_backend_features();
    let enabled = if compiled_in.is_empty() { backends } else { compiled_in };
    let list: Vec<_> = enabled.iter_names().map(|(name, _)| name.to_lowercase()).collect();
    list.join(", ")
}

fn info(adapter: &Adapter) -> GpuInfo {
    let info = adapter.get_info();
    let driver = format!("{} {}", info.driver, info.driver_info);
    GpuInfo {
        name: info.name,
        backend: info.backend.to_str().to_owned(),
        driver: driver.trim().to_owned(),
        software: info.device_type == DeviceType::Cpu,
    }
}

/// Smaller is better.
fn rank(adapter: &Adapter) -> (u8, bool) {
    let info = adapter.get_info();
    let kind = match info.device_type {
        DeviceType::DiscreteGpu => 0,
        DeviceType::IntegratedGpu => 1,
        DeviceType::VirtualGpu => 2,
        DeviceType::Other => 3,
        DeviceType::Cpu => 4,
    };
    (kind, info.backend == wgpu::Backend::Gl)
}
