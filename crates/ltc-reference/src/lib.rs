//! Ground truth for LTCs by quadrature and sampling; shares no code with the closed forms.
//!
//! Everything is f64. The shading frame has x = tangent (carries `alpha_x`), y = bitangent, z = normal, and the
//! shading point at the origin; `wo` points to the eye, `wi` to the light, both unit vectors. Matrices are named by
//! their spaces: `target_from_cosine` takes the clamped cosine to the lobe.
//!
//! | want | use | typical accuracy |
//! |---|---|---|
//! | a lobe over a polygon | [`integrate_polygon`] | the tolerance asked for, down to some 1e-11 |
//! | the same for an LTC, another way | [`integrate_polygon_boundary`] | the same |
//! | the same over a line, a thin cylinder's wall or cap | [`integrate_line`], [`integrate_cylinder_wall`], [`integrate_cap`] | the tolerance asked for |
//! | the same over a strip, as a line and as a rectangle | [`integrate_strip_line`], [`integrate_strip_area`] | the tolerance asked for |
//! | a lobe over an ellipse, sphere or cylinder | [`integrate_ellipse`], [`integrate_sphere_light`], [`integrate_cylinder`] | the same |
//! | the polygon for an LTC, another way | [`integrate_polygon_boundary`] | the same |
//! | GGX and Lambert over any [`Emitter`], fast | [`direct_light`] | unbiased; a large light over a glossy surface: 2e-2 at 64 samples, 2e-3 at 1024 |
//! | the same of a light whose colour varies | [`direct_light_coloured`], [`Picture`] | the same |
//! | magnitude and Fresnel of a table | [`directional_albedo`] | the tolerance asked for |
//! | Beckmann, Disney diffuse, Oren–Nayar, Charlie | [`BeckmannLobe`], [`DisneyDiffuseLobe`], [`OrenNayarLobe`], [`CharlieLobe`] | exact but for Beckmann's Λ (1e-14, by quadrature) |
//! | mass of a lobe, leak of an LTC | [`lobe_mass`] | the tolerance asked for |
//! | whether a sampler draws from its density | [`chi_square`], [`ChiSquareSuite`] | a p-value |
//! | total variation | [`total_variation`], [`ggx_total_variation`] | the tolerance asked for |
//!
//! A new BRDF is a new [`Lobe`]; a new light shape is a region of the sphere, cut into spherical triangles, for the same
//! cubature.
//!
//! ```
//! use glam::dvec3;
//! use ltc_reference::{CosineLobe, PolygonOptions, integrate_polygon};
//!
//! // A one-sided square overhead, its front (counter-clockwise) facing down.
//! let light = [dvec3(-1., -1., 1.), dvec3(-1., 1., 1.), dvec3(1., 1., 1.), dvec3(1., -1., 1.)];
//! let seen = integrate_polygon(&CosineLobe, &light, PolygonOptions::default())?;
//! let exact = 4.0 / (std::f64::consts::PI * 2f64.sqrt()) * (0.5f64.sqrt()).atan();
//! assert!((seen.value - exact).abs() < 1e-9);
//! # Ok::<(), ltc_reference::ReferenceError>(())
//! ```

mod albedo;
mod beckmann;
mod bins;
mod boundary;
mod charlie;
mod chart;
mod chi_square;
mod cubature;
mod cylinder;
mod diffuse;
mod direct;
mod ellipse;
mod emitter;
mod error;
mod fan;
mod ggx;
mod line;
mod lobe;
mod mass;
mod picture;
mod points;
mod polygon;
mod quadrature;
mod rect_light;
mod ruling;
mod special;
mod sphere;
mod sphere_light;
mod strip;
mod transformed;
mod tv;

pub use albedo::{Albedo, directional_albedo};
pub use beckmann::BeckmannLobe;
pub use boundary::integrate_polygon_boundary;
pub use charlie::CharlieLobe;
pub use chart::{CapChart, Chart, TransformedChart};
pub use chi_square::{ChiSquare, ChiSquareOptions, ChiSquareSuite, chi_square, chi_square_unit, sidak};
pub use cubature::integrate_squares;
pub use cylinder::{CylinderShape, integrate_cylinder};
pub use diffuse::{DisneyDiffuseLobe, OrenNayarLobe};
pub use direct::{Direct, direct_light, direct_light_coloured, direct_light_visible, view_direction};
pub use ellipse::integrate_ellipse;
pub use emitter::{CylinderEmitter, EllipseEmitter, Emitter, PolygonEmitter, SphereEmitter};
pub use error::ReferenceError;
pub use ggx::Ggx;
pub use line::{ThinCylinder, integrate_cap, integrate_cylinder_wall, integrate_line, point_cap};
pub use lobe::{AboveHorizon, CosineLobe, GgxLobe, Lobe, LtcLobe, LtcMixture, Scaled};
pub use mass::lobe_mass;
pub use picture::Picture;
pub use points::{R2, SplitMix64, cosine_direction, sphere_direction};
pub use polygon::{PolygonOptions, integrate_polygon};
pub use quadrature::{Estimate, GaussLegendre, Tolerance, integrate_1d};
pub use rect_light::{LightHit, RectLight};
pub use sphere::integrate_sphere;
pub use sphere_light::integrate_sphere_light;
pub use strip::{ThinStrip, integrate_strip_area, integrate_strip_line};
pub use transformed::{BaseShape, TransformedLobe};
pub use tv::{ggx_total_variation, total_variation};
