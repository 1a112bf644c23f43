//! Distributions of directions: linear transformations of four bases, and mixtures.

mod clamped_cosine;
mod clamped_cosine_squared;
mod mixture;
mod polygon;
mod transformed;
mod uniform_hemisphere;
mod uniform_sphere;

pub use clamped_cosine::ClampedCosine;
pub use clamped_cosine_squared::ClampedCosineSquared;
pub use mixture::LtcMixture;
pub use transformed::LinearlyTransformed;
pub use uniform_hemisphere::UniformHemisphere;
pub use uniform_sphere::UniformSphere;

use core::fmt::Debug;

use crate::{Horizon, Light, Polygon, Real};

/// A probability density over directions that can be evaluated and drawn from.
///
/// ```
/// use ltc_core::{Distribution, Ltc, LtcMixture};
///
/// let narrow = Ltc::<f64>::new(glam::DMat3::from_diagonal(glam::dvec3(0.1, 0.1, 1.0)))?;
/// let lobes: [Box<dyn Distribution<f64>>; 2] =
///     [Box::new(narrow), Box::new(LtcMixture::new([(0.7, narrow), (0.3, Ltc::cosine())])?)];
/// for lobe in &lobes {
///     assert!(lobe.density(lobe.sample([0.3, 0.6])) > 0.0);
/// }
/// # Ok::<(), ltc_core::InputError>(())
/// ```
pub trait Distribution<R: Real> {
    /// Density at the unit direction `w`, in 1/sr. Its integral over the sphere is 1.
    fn density(&self, w: R::Vec3) -> R;

    /// A unit direction of this density, from `u` ∈ [0, 1)².
    fn sample(&self, u: [R; 2]) -> R::Vec3;
}

/// A distribution with a closed form over lights: what [`crate::Ltc`] and [`LtcMixture`] have in common.
///
/// ```
/// use glam::DVec3;
/// use ltc_core::{ClosedForm, Ltc, LtcMixture, Polygon, Sides};
///
/// let light = [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0)].map(|(x, y)| DVec3::new(x, y, 2.0));
/// let light = Polygon::new(&light, Sides::One)?;
/// let mixture = LtcMixture::from(Ltc::<f64>::cosine());
/// let lobes: [&dyn ClosedForm<f64>; 2] = [&Ltc::cosine(), &mixture];
/// assert_eq!(lobes[0].integrate(&light), lobes[1].integrate(&light));
/// # Ok::<(), ltc_core::InputError>(())
/// ```
pub trait ClosedForm<R: Real>: Distribution<R> {
    /// The fraction of the distribution that sees `light`, cut by the horizons asked for; in [0, 1].
    fn integrate_within(&self, light: &dyn Light<R>, horizon: Horizon) -> R;

    /// The fraction of the distribution that sees `light`, cut by both horizons.
    fn integrate(&self, light: &dyn Light<R>) -> R {
        self.integrate_within(light, Horizon::BOTH)
    }
}

/// A distribution `Do` over directions that linear transformations start from, symmetric about z (2016 paper, §3.1).
///
/// It is a type without values: every base of the paper is one shape.
pub trait Base<R: Real>: Copy + Debug + PartialEq + Send + Sync + 'static {
    /// The largest value of `Do`, in 1/sr.
    const PEAK: f64;

    /// `Do(w/‖w‖) · k / ‖w‖³` for a vector `w` of any length above 0 and a factor `k`: the density of eq. 1 with
    /// `w = M⁻¹ω`, `k = |M⁻¹|`. For unit `w` and k = 1 it is `Do`.
    ///
    /// Products are ordered so that they do not overflow while the result does not.
    fn density(w: R::Vec3, k: R) -> R;

    /// A unit direction of density `Do`, from `u` ∈ [0, 1)².
    fn sample(u: [R; 2]) -> R::Vec3;
}

/// A base with a closed form over polygons.
pub trait PolygonBase<R: Real>: Base<R> {
    /// `∫ D(ω) dω` over the directions that hit `polygon` (2016 paper, eq. 3), in [0, 1].
    fn integrate_polygon(
        distribution: &LinearlyTransformed<R, Self>,
        polygon: &Polygon<'_, R>,
        horizon: Horizon,
    ) -> R;
}
