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

mod compute;
mod constants;
mod device;
mod error;
mod forward;
#[cfg(test)]
mod function_tests;
mod integrate;
mod layout;
mod light;
mod lookup;
pub mod modules;
mod request;
mod shade;
mod surface;
mod table_textures;

pub use device::{Filtering, Gpu, GpuInfo, GpuOptions, Texels};
pub use error::GpuError;
pub use forward::{Forward, ForwardMaterial, ForwardVertex, ForwardView};
pub use integrate::{LightJob, Lights, PolygonJob, Polygons};
pub use light::{AreaLight, LightShape};
pub use lookup::{LookupResult, Lookups};
pub use request::{Feature, LightKind, ShaderRequest, UnknownName};
pub use shade::Shader;
pub use surface::SurfacePoint;
pub use table_textures::{TableTextures, Tables};
