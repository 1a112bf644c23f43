//! Lights, as a shading point sees them: each file a shape, each shape a closed form.

mod angle;
mod any;
mod batch;
mod boundary;
mod cone;
mod cone_light;
mod cone_region;
mod convex;
mod cylinder;
mod disk;
mod edge_form;
mod ellipse;
mod facing;
mod horizon;
mod lane;
mod line;
mod line_cylinder;
mod plane;
mod polygon;
mod polygon_sample;
mod proxy;
mod quad;
mod ring;
mod sample;
mod segment;
mod simd;
mod solid_angle;
mod spaces;
mod sphere;
mod spherical_triangle;
mod strip;
mod surround;
mod textured;
mod triangulate;
mod wide;

pub use any::AnyLight;
pub use batch::{LtcBatch, QuadBatch};
pub(crate) use boundary::widen;
pub use cylinder::Cylinder;
pub use disk::Disk;
pub use edge_form::{Cubic, EdgeForm, Exact, PublishedRational, Rational};
pub use ellipse::Ellipse;
pub use horizon::Horizon;
pub use line::{Line, LineSample};
pub use line_cylinder::LineCylinder;
pub(crate) use plane::Plane;
pub use polygon::Polygon;
pub use polygon_sample::PolygonSampler;
pub use proxy::{clipped_sphere, clipped_sphere_fit};
pub use quad::Quad;
pub use sample::{LightSample, SampleLight};
pub(crate) use solid_angle::{half_triangle, sum_of_units};
pub use sphere::Sphere;
pub use strip::Strip;
pub use textured::{TEXTURE_SIGMAS, TextureFetch, TextureFrame, TexturedPolygon};

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
