//! The clamped cosine.

use core::f64::consts::FRAC_1_PI;

use super::{Base, LinearlyTransformed, PolygonBase};
use crate::{Horizon, Light as _, Polygon, Real, Vector};

/// The clamped cosine, `Do = max(0, z)/π` (2016 paper, eq. 4): Lambert's lobe, and the base of [`crate::Ltc`].
///
/// ```
/// use ltc_core::{Base, ClampedCosine};
///
/// assert!((ClampedCosine::density(glam::DVec3::Z, 1.0) - core::f64::consts::FRAC_1_PI).abs() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ClampedCosine;

impl<R: Real> Base<R> for ClampedCosine {
    const PEAK: f64 = FRAC_1_PI;

    fn density(w: R::Vec3, k: R) -> R {
        if w.z() <= R::ZERO {
            return R::ZERO;
        }
        let inverse_squared = R::ONE / w.dot(w);
        (w.z() * inverse_squared * k) * inverse_squared * R::of(<Self as Base<R>>::PEAK)
    }

    fn sample(u: [R; 2]) -> R::Vec3 {
        let r = u[0].sqrt();
        let (sin, cos) = (R::of(2.0) * R::PI * u[1]).sin_cos();
        R::Vec3::new(r * cos, r * sin, (R::ONE - u[0]).max(R::ZERO).sqrt())
    }
}

impl<R: Real> PolygonBase<R> for ClampedCosine {
    /// The form factor of the transformed polygon: [`crate::Light::integrate_within`].
    fn integrate_polygon(
        distribution: &LinearlyTransformed<R, Self>,
        polygon: &Polygon<'_, R>,
        horizon: Horizon,
    ) -> R {
        polygon.integrate_within(distribution, horizon)
    }
}
