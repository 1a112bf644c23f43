//! A scene to a picture.

use std::ops::ControlFlow;
use std::time::Instant;

use ltc_core::PrefilteredTexture;
use ltc_table::{Kind, Table};
use rayon::prelude::*;

use crate::cpu::Cpu;
use crate::emitter::Emitter;
use crate::gbuffer::GBuffer;
#[cfg(feature = "gpu")]
use crate::gpu::GpuBackend;
use crate::reference::Reference;
use crate::scene::World;
use crate::shader::Shade;
use crate::texture_map::TextureMap;
use crate::{Image, RenderError, Scene};

/// What shades.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Backend {
    /// LTC on the GPU, in `f32`. Needs the feature `gpu`.
    Gpu,
    /// LTC on the CPU, in `f64`.
    Cpu,
    /// The BRDFs themselves, sampled.
    Reference,
}

/// The tables that the LTC back ends use.
#[derive(Clone, Copy, Debug)]
pub struct RenderTables<'a> {
    /// For materials with `alpha_x = alpha_y`.
    pub isotropic: &'a Table,
    /// For all others.
    pub anisotropic: &'a Table,
}

/// How to render.
#[derive(Clone, Copy)]
pub struct RenderOptions<'a> {
    /// Camera samples a pixel: a square number from 1 to 64.
    pub samples_per_pixel: u32,
    /// For [`Backend::Reference`]: light samples for each of its three techniques, camera sample and light, from 1 to
    /// 65,536.
    pub reference_samples: u32,
    /// For [`Backend::Reference`]: the same seed gives the same picture.
    pub seed: u64,
    /// Called now and then with what part is done, in [0, 1]; the last time with 1.
    pub progress: Option<&'a (dyn Fn(f32) + Sync)>,
}

impl Default for RenderOptions<'_> {
    fn default() -> Self {
        Self { samples_per_pixel: 1, reference_samples: 256, seed: 1, progress: None }
    }
}

/// A picture and how it came about.
#[derive(Clone, Debug)]
pub struct Rendered {
    /// Linear radiance.
    pub image: Image,
    /// For each pixel, whether it shows a surface, at least in part. All others are the same with every back end.
    pub on_surface: Vec<bool>,
    /// Wall time of everything, the opening of a device included.
    pub seconds: f64,
    /// Wall time of shading alone.
    pub shading_seconds: f64,
    /// Where it was shaded.
    pub device: String,
}

/// Renders the scene.
///
/// # Errors
/// [`RenderError`] for an invalid scene or option, tables of the wrong kind, and failures of the GPU.
pub fn render(
    scene: &Scene,
    tables: &RenderTables<'_>,
    backend: Backend,
    options: &RenderOptions<'_>,
) -> Result<Rendered, RenderError> {
    let start = Instant::now();
    // What is asked for is looked at before a device is opened for it.
    let side = options.check()?;
    let world = scene.world()?;
    Renderer::new(tables, backend)?.frames_of(&world, options, side, start, |_| ControlFlow::Break(()))
}

/// A back end that renders many scenes, or one scene many times: it keeps what they share, on the GPU the device with its
/// tables and programs.
pub struct Renderer<'a> {
    tables: RenderTables<'a>,
    backend: Backend,
    #[cfg(feature = "gpu")]
    device: Option<crate::gpu::Device>,
}

impl<'a> Renderer<'a> {
    /// Opens it.
    ///
    /// # Errors
    /// [`RenderError`] for tables of the wrong kind, and where there is no GPU for [`Backend::Gpu`].
    pub fn new(tables: &RenderTables<'a>, backend: Backend) -> Result<Self, RenderError> {
        tables.check()?;
        #[cfg(feature = "gpu")]
        let device = (backend == Backend::Gpu).then(|| crate::gpu::Device::open(tables)).transpose()?;
        #[cfg(not(feature = "gpu"))]
        if backend == Backend::Gpu {
            return Err(RenderError::NoGpuBackend);
        }
        Ok(Self {
            tables: *tables,
            backend,
            #[cfg(feature = "gpu")]
            device,
        })
    }

    /// Whether the processor computes: always, but for a graphics device that is none of its own software.
    pub fn is_on_processor(&self) -> bool {
        #[cfg(feature = "gpu")]
        return self.device.as_ref().is_none_or(crate::gpu::Device::is_software);
        #[cfg(not(feature = "gpu"))]
        true
    }

    /// Renders a scene.
    ///
    /// # Errors
    /// [`RenderError`] for an invalid scene or option, and failures of the GPU.
    pub fn render(&self, scene: &Scene, options: &RenderOptions<'_>) -> Result<Rendered, RenderError> {
        self.frames(scene, options, |_| ControlFlow::Break(()))
    }

    /// Renders a scene again and again, until `each` has enough of it, and returns the last frame. What has to be made of a
    /// scene before its first frame is made once.
    ///
    /// # Errors
    /// As [`Self::render`].
    pub fn frames(
        &self,
        scene: &Scene,
        options: &RenderOptions<'_>,
        each: impl FnMut(&Rendered) -> ControlFlow<()>,
    ) -> Result<Rendered, RenderError> {
        let start = Instant::now();
        let side = options.check()?;
        self.frames_of(&scene.world()?, options, side, start, each)
    }

    /// The first frame began at `start`.
    fn frames_of(
        &self,
        world: &World,
        options: &RenderOptions<'_>,
        side: u32,
        mut start: Instant,
        mut each: impl FnMut(&Rendered) -> ControlFlow<()>,
    ) -> Result<Rendered, RenderError> {
        let shader = self.shader(world, options)?;
        loop {
            let rendered = frame(world, &*shader, options, side, start)?;
            if each(&rendered).is_break() {
                return Ok(rendered);
            }
            start = Instant::now();
        }
    }

    fn shader<'b>(
        &'b self,
        world: &'b World,
        options: &RenderOptions<'_>,
    ) -> Result<Box<dyn Shade + 'b>, RenderError> {
        let lights = &world.lights;
        #[cfg(feature = "gpu")]
        if let Some(device) = &self.device {
            return Ok(Box::new(GpuBackend::new(device, &self.tables, lights, &world.materials)?));
        }
        Ok(match self.backend {
            Backend::Reference => {
                Box::new(Reference { lights, samples: options.reference_samples, seed: options.seed })
            }
            _ => Box::new(Cpu { tables: &self.tables, lights, textures: prefiltered(lights)? }),
        })
    }
}

fn frame(
    world: &World,
    shader: &dyn Shade,
    options: &RenderOptions<'_>,
    side: u32,
    start: Instant,
) -> Result<Rendered, RenderError> {
    let (width, height) = (world.view.width(), world.view.height());
    let batch = u32::try_from(shader.batch()).unwrap_or(u32::MAX);
    let band = (batch / (width * options.samples_per_pixel)).max(1);
    let size = width as usize * height as usize;
    let mut pixels = Vec::with_capacity(size);
    let mut on_surface = Vec::with_capacity(size);
    let mut shading_seconds = 0.0;
    let mut row = 0;
    while row < height {
        let end = (row + band).min(height);
        let buffer = GBuffer::cast(world, row..end, side);
        let before = Instant::now();
        let radiance = shader.shade(buffer.points())?;
        shading_seconds += before.elapsed().as_secs_f64();
        for pixel in buffer.resolve(&radiance) {
            pixels.push(pixel.radiance);
            on_surface.push(pixel.on_surface);
        }
        row = end;
        if let Some(progress) = options.progress {
            progress(row as f32 / height as f32);
        }
    }
    let image = Image::new(width, height, pixels);
    let seconds = start.elapsed().as_secs_f64();
    Ok(Rendered { image, on_surface, seconds, shading_seconds, device: shader.device() })
}

/// The lights' textures, one for each light.
pub(crate) fn prefiltered(lights: &[Emitter]) -> Result<Vec<Option<PrefilteredTexture>>, RenderError> {
    let textures =
        lights.par_iter().map(|light| light.texture.as_ref().map(TextureMap::prefiltered).transpose());
    Ok(textures.collect::<Result<_, _>>()?)
}

impl RenderOptions<'_> {
    /// The side of the grid of samples in a pixel.
    fn check(&self) -> Result<u32, RenderError> {
        if !(1..=65_536).contains(&self.reference_samples) {
            let value = self.reference_samples.to_string();
            return Err(RenderError::Option { name: "reference samples", value, must: "1 to 65536" });
        }
        let side = self.samples_per_pixel.isqrt();
        if !(1..=8).contains(&side) || side * side != self.samples_per_pixel {
            let value = self.samples_per_pixel.to_string();
            let must = "a square number: 1, 4, 9, 16, 25, 36, 49 or 64";
            return Err(RenderError::Option { name: "samples per pixel", value, must });
        }
        Ok(side)
    }
}

impl RenderTables<'_> {
    fn check(&self) -> Result<(), RenderError> {
        for (table, kind, expected) in [
            (self.isotropic, Kind::Isotropic, "isotropic"),
            (self.anisotropic, Kind::Anisotropic, "anisotropic"),
        ] {
            if table.kind() != kind {
                return Err(RenderError::WrongTable { expected });
            }
        }
        Ok(())
    }
}
