//! Linearly transformed cosines (LTCs): GGX, closed-form light integrals, sampling. The mathematics alone, without I/O.
//!
//! # Conventions, for the whole workspace
//! - **Shading frame**: x = tangent (carries `alpha_x`), y = bitangent (`alpha_y`), z = normal; right-handed.
//! - **View direction** `wo = (sin θ cos φ, sin θ sin φ, cos θ)`, θ ∈ [0, π/2], φ ∈ [0, 2π). Light direction `wi`. Both
//!   point away from the surface and have unit length.
//! - **`M`** maps cosine space to the lobe (`target_from_cosine`), `M⁻¹` back (`cosine_from_target`). Written out, it
//!   is row-major. det M > 0.
//! - **α** is the GGX width ([`Alpha`]); [`PerceptualRoughness`] is its square root.
//! - Angles are in radians. A light's integral is the **fraction of the lobe that sees the light**, in [0, 1]: times the
//!   light's radiance and the material's reflectance it is the reflected radiance.
//! - **Magnitude** `n = ∫ ρ cos` at F = 1, **Fresnel** `f = ∫ (1 − ωo·ωh)^5 ρ cos`; the reflectance is
//!   `F0·n + (F90 − F0)·f` ([`reflectance`]).
//! - `f64` is truth, `f32` is speed: one body of code for both, generic over [`Real`].
//!
//! # Example
//! ```
//! use ltc_core::{Light, Ltc, Matrix, Polygon, Sides};
//! use glam::{DMat3, DVec3};
//!
//! let ltc = Ltc::<f64>::new(DMat3::from_row_array([0.3, 0.0, 0.4, 0.0, 0.2, 0.0, -0.1, 0.0, 0.9]))?;
//! // A square above the shading point; counter-clockwise seen from its emitting side, here from below.
//! let light = [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0)].map(|(x, y)| DVec3::new(x, y, 2.0));
//! let fraction = Polygon::new(&light, Sides::One)?.integrate(&ltc);
//! assert!(fraction > 0.5 && fraction < 1.0);
//! # Ok::<(), ltc_core::InputError>(())
//! ```

mod distribution;
mod error;
mod frame;
mod fresnel;
mod ggx;
mod light;
mod ltc;
pub mod points;
mod real;
mod roughness;
#[cfg(test)]
mod testing;
mod texture;

pub use distribution::{
    Base, ClampedCosine, ClampedCosineSquared, ClosedForm, Distribution, LinearlyTransformed, LtcMixture,
    PolygonBase, UniformHemisphere, UniformSphere,
};
pub use error::{InputError, check_range};
pub use frame::ShadingFrame;
pub use fresnel::{reflectance, schlick, schlick_weight};
pub use ggx::Ggx;
pub use light::{
    AnyLight, Cubic, Cylinder, Disk, EdgeForm, Ellipse, Exact, Horizon, Light, LightSample, Line,
    LineCylinder, LineSample, LtcBatch, Polygon, PolygonSampler, PublishedRational, Quad, QuadBatch,
    Rational, SampleLight, Sides, Sphere, Strip, TEXTURE_SIGMAS, TextureFetch, TextureFrame, TexturedPolygon,
    clipped_sphere, clipped_sphere_fit,
};
pub use ltc::Ltc;
pub use real::{Matrix, Real, Vector};
pub use roughness::{ALPHA_MIN, Alpha, PerceptualRoughness};
pub use texture::{PrefilteredTexture, TexelGrid, TextureLevel, TextureRow, TextureRows};
