//! Scenes of spheres and planes under area lights of every shape, shaded by LTC on the CPU or the GPU, or by the reference
//! integrator.
//!
//! A [`Scene`] is read from JSON (`examples/scenes/README.md` documents the format). [`render`] makes an [`Image`] of it
//! with one [`Backend`]; [`compare`] renders it twice and reports the difference. All back ends shade the same
//! [`gbuffer`]: visibility from the camera is by ray casting in `f64`, once, so that pictures differ by their shading
//! alone.
//!
//! **There are no shadows and no light between objects**, in any back end: the reference integrates unoccluded direct
//! light, too. What separates it from the others is then the error of the LTCs and nothing else.
//!
//! World space is right-handed with y up; the unit of length is the scene's own. Radiance is linear RGB in W/(m²·sr) or
//! nits, whichever the lights are given in.
//!
//! # Example
//! ```no_run
//! use ltc_render::{Backend, RenderOptions, RenderTables, Scene, ToneMap, render};
//! # fn example(isotropic: &ltc_table::Table, anisotropic: &ltc_table::Table) -> Result<(), ltc_render::RenderError> {
//! let scene = Scene::load("examples/scenes/anisotropic-spheres.json".as_ref())?;
//! let tables = RenderTables { isotropic, anisotropic };
//! let rendered = render(&scene, &tables, Backend::Cpu, &RenderOptions::default())?;
//! println!("{:.1} s on {}", rendered.seconds, rendered.device);
//! rendered.image.write("spheres.png".as_ref(), ToneMap::default())?;
//! # Ok(())
//! # }
//! ```

mod camera;
mod compare;
mod cpu;
mod emitter;
mod error;
pub mod gbuffer;
#[cfg(feature = "gpu")]
mod gpu;
mod image;
mod light;
mod material;
mod object;
mod picture_file;
mod reference;
mod render;
mod scene;
mod shader;
mod texture;
mod texture_map;
mod tone;
mod validate;

pub use camera::Camera;
pub use compare::{Comparison, ErrorFigures, compare};
pub use error::{RenderError, SceneError};
pub use image::{Format, Image};
pub use light::{Light, Rectangle};
pub use material::{Material, ResolvedMaterial};
pub use object::{Object, Plane, Sphere};
pub use render::{Backend, RenderOptions, RenderTables, Rendered, Renderer, render};
pub use scene::Scene;
pub use texture::{Checker, Frame, Texture};
pub use tone::ToneMap;
