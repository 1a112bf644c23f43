//! Deferred shading.

use crate::compute::{Batch, Kernel, compile};
use crate::light::EncodedLights;
use crate::modules::{Extras, Program};
use crate::table_bindings::TableBindings;
use crate::{AreaLight, Gpu, GpuError, LightTextures, SurfacePoint, Tables};

/// Points that go to the device at once: 12 MiB of G-buffer.
const CHUNK: usize = 1 << 17;

/// The pipeline that shades a G-buffer.
///
/// The radiance of a point is the sum over lights of `radiance · ((F0·n + (F90 − F0)·f) · s + albedo · d)`: n and f are the
/// table's magnitude and Fresnel term, s the fraction of the table's lobe and d the fraction of Lambert's that see the
/// light. A point's lobe is looked up once for all lights. Lights cast no shadows. Where an interpolated matrix is
/// singular, s is 0.
#[derive(Debug)]
pub struct Shader {
    kernel: Kernel,
    tables: TableBindings,
    textures: Option<LightTextures>,
}

/// What a shading pipeline is to have beyond the two tables and lights of one colour: nothing else is compiled.
#[derive(Debug, Default)]
pub struct ShadingOptions {
    /// The textures of lights that have some: their radiance is multiplied with the colour that the lobe sees of the texture
    /// ([`ltc_core::TexturedPolygon`] has the formula and its error).
    pub textures: Option<LightTextures>,
    /// Whether points may look into [`crate::BakedSlices`].
    pub baked: bool,
}

impl ShadingOptions {
    pub(crate) fn extras(&self) -> Extras {
        Extras { textured: self.textures.is_some(), baked: self.baked }
    }
}

impl Shader {
    /// Compiles the pipeline.
    ///
    /// # Errors
    /// [`GpuError::Device`].
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        Self::with(gpu, ShadingOptions::default())
    }

    /// Compiles the pipeline with more than lights of one colour and the two tables.
    ///
    /// # Errors
    /// [`GpuError::Device`].
    pub fn with(gpu: &Gpu, options: ShadingOptions) -> Result<Self, GpuError> {
        let module = compile(gpu, Program::Shade(gpu.filtering(), options.extras()))?;
        let tables = TableBindings::new(gpu, options.extras())?;
        let kernel = Kernel::new(gpu, &module, "main", Some(tables.layout()), 3)?;
        Ok(Self { kernel, tables, textures: options.textures })
    }

    /// Radiance towards the eye of each point, linear RGB, in the unit of the lights' radiance.
    ///
    /// # Errors
    /// [`GpuError::Input`] and [`GpuError::NotIsotropic`] with the index of the first invalid point or light,
    /// [`GpuError::MissingTable`], [`GpuError::WrongSlice`], [`GpuError::MissingTexture`]; then nothing is run.
    pub fn shade(
        &self,
        gpu: &Gpu,
        tables: Tables<'_>,
        points: &[SurfacePoint],
        lights: &[AreaLight],
    ) -> Result<Vec<[f32; 3]>, GpuError> {
        let EncodedLights { records: light_buffer, vertices } =
            EncodedLights::of(lights, self.textures.as_ref())?;
        let tables = self.tables.bound(tables);
        let point_buffer =
            points.iter().enumerate().map(|(i, p)| p.encode(i, tables)).collect::<Result<Vec<_>, _>>()?;
        let bound = self.tables.bind(gpu, tables, self.textures.as_ref())?;
        let mut radiance = Vec::with_capacity(points.len());
        for chunk in point_buffer.chunks(CHUNK) {
            let batch = Batch {
                item: "point",
                first: radiance.len(),
                items: chunk.len(),
                counts: [chunk.len() as u32, lights.len() as u32, 0, 0],
                inputs: &[
                    bytemuck::cast_slice(chunk),
                    bytemuck::cast_slice(&light_buffer),
                    bytemuck::cast_slice(&vertices),
                ],
                floats_each: 4,
                tables: Some(&bound),
            };
            let floats = self.kernel.run(gpu, &batch)?;
            radiance.extend(floats.as_chunks::<4>().0.iter().map(|[r, g, b, _]| [*r, *g, *b]));
        }
        Ok(radiance)
    }
}
