//! LTC area lights on the GPU, through wgpu, without a window: tables as textures, batches of lookups and integrals,
//! deferred shading.
//!
//! [`Gpu`] opens a device: hardware where there is one, a software driver otherwise. [`TableTextures`] holds a table there.
//! [`Lookups`], [`Lights`] and [`Shader`] are compute pipelines over it, [`Forward`] shades triangles as they are drawn. Conventions and units are those of
//! [`ltc_core`]; everything on the device is `f32`.
//!
//! The WGSL comes in [`modules`]: pure functions that know no bindings, and thin entry points that hold them. A program is
//! their concatenation; [`ShaderRequest`] gives the functions alone, just those asked for.
//!
//! [`timing`] says how long programs over a grid of pixels take.
//!
//! [`ShaderRequest::export`] writes them in other languages. [`probe`] tests a device by feature.
//!
//! Feature `device` (on) brings the devices, through wgpu; `export` (on) the other languages, through naga alone.
//!
//! # What is guaranteed
//! - Inputs are checked here, on the host: a NaN, an infinity, a singular matrix or an impossible width is an
//!   [`GpuError::Input`] that names the item's index. Nothing of that batch runs then.
//! - Degenerate lights (no area, in the plane of the shading point, below the horizon, behind their own face) give
//!   exactly 0; there is no NaN, no infinity and no negative light.
//! - Output buffers are pre-filled, and what a pipeline did not write or wrote as a NaN or infinity is an error, never
//!   a number.
//!
//! # Example
//! ```no_run
//! use ltc_core::Sides;
//! use ltc_shade_gpu::{Gpu, GpuOptions, PolygonJob, Polygons};
//!
//! let gpu = Gpu::new(GpuOptions::default())?;
//! println!("{}", gpu.info());
//! let square = [[-1.0, -1.0, 2.0], [-1.0, 1.0, 2.0], [1.0, 1.0, 2.0], [1.0, -1.0, 2.0]];
//! let cosine = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
//! let job = PolygonJob { m: cosine, vertices: &square, sides: Sides::One };
//! let fractions = Polygons::new(&gpu)?.integrate(&gpu, &[job])?;
//! # Ok::<(), ltc_shade_gpu::GpuError>(())
//! ```

#[cfg(feature = "device")]
mod baked;
#[cfg(feature = "device")]
mod compute;
mod constants;
#[cfg(feature = "device")]
mod device;
#[cfg(feature = "device")]
mod error;
#[cfg(feature = "export")]
mod export;
mod filtering;
#[cfg(feature = "device")]
mod forward;
#[cfg(test)]
#[cfg(feature = "device")]
mod function_tests;
#[cfg(feature = "device")]
mod integrate;
#[cfg(feature = "device")]
mod layout;
#[cfg(feature = "device")]
mod light;
#[cfg(feature = "device")]
mod light_textures;
#[cfg(feature = "device")]
mod lookup;
pub mod modules;
#[cfg(feature = "device")]
mod probe;
#[cfg(feature = "device")]
mod refined;
mod request;
#[cfg(feature = "device")]
mod shade;
#[cfg(feature = "device")]
mod surface;
#[cfg(feature = "device")]
mod table_bindings;
#[cfg(feature = "device")]
mod table_textures;
mod texture_atlas;
#[cfg(feature = "device")]
mod textured;
#[cfg(feature = "device")]
pub mod timing;

#[cfg(feature = "device")]
pub use baked::BakedSlices;
#[cfg(feature = "device")]
pub use device::{Gpu, GpuInfo, GpuOptions, Texels};
#[cfg(feature = "device")]
pub use error::GpuError;
#[cfg(feature = "export")]
pub use export::{Code, ExportError, Exported, Language};
pub use filtering::Filtering;
#[cfg(feature = "device")]
pub use forward::{Forward, ForwardMaterial, ForwardVertex, ForwardView};
#[cfg(feature = "device")]
pub use integrate::{LightJob, Lights, PolygonJob, Polygons};
#[cfg(feature = "device")]
pub use light::{AreaLight, LightShape};
#[cfg(feature = "device")]
pub use light_textures::{LightTexture, LightTextures};
#[cfg(feature = "device")]
pub use lookup::{BakedLookups, BakedQuery, LookupResult, Lookups};
#[cfg(feature = "device")]
pub use probe::{Finding, ProbeReport, Verdict, probe};
pub use request::{Feature, LightKind, ShaderRequest, UnknownName};
#[cfg(feature = "device")]
pub use shade::{Shader, ShadingOptions};
#[cfg(feature = "device")]
pub use surface::SurfacePoint;
#[cfg(feature = "device")]
pub use table_textures::{TableTextures, Tables};
pub use texture_atlas::TextureAtlas;
#[cfg(feature = "device")]
pub use textured::{TexturedJob, TexturedLights};
