//! Lights, as a shading point sees them: each file a shape, each shape a closed form.

mod boundary;
mod horizon;
mod polygon;
mod sample;
mod textured;

pub use horizon::Horizon;
pub use polygon::Polygon;
pub use sample::{LightSample, SampleLight};
pub use textured::{TextureFetch, TextureFrame, TexturedPolygon};

use crate::{Ltc, Real};

/// Which sides of a flat light emit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sides {
    /// Only the front; each light says which side that is.
    One,
    /// Both.
    Two,
}

/// A light of constant radiance, in the shading frame with the shading point at the origin.
///
/// Every value is a fraction of a lobe, in [0, 1] whatever the input: times the light's radiance and the material's
/// reflectance it is the reflected radiance. A light without extent, one that is seen edge-on or from behind, and one below
/// the surface's horizon give exactly 0.
pub trait Light<R: Real> {
    /// The fraction of `ltc` that sees the light, `∫ D(ω) dω` over the light's directions, with the light cut by the
    /// horizons asked for.
    fn integrate_within(&self, ltc: &Ltc<R>, horizon: Horizon) -> R;

    /// The fraction of `ltc` that sees the light, cut by both horizons: the right one.
    fn integrate(&self, ltc: &Ltc<R>) -> R {
        self.integrate_within(ltc, Horizon::BOTH)
    }

    /// The fraction of a Lambertian lobe that sees the light: its form factor. Times π it is the irradiance per radiance.
    fn irradiance(&self) -> R {
        self.integrate(&Ltc::cosine())
    }
}
