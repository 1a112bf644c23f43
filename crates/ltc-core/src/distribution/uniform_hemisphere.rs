//! The uniform hemisphere.

use core::f64::consts::PI;

use super::polygon::Region;
use super::{Base, LinearlyTransformed, PolygonBase};
use crate::{Horizon, Polygon, Real, Vector};

/// The uniform distribution over the upper hemisphere, `Do = 1/(2π)` for z > 0.
///
/// ```
/// use glam::DVec3;
/// use ltc_core::{Horizon, LinearlyTransformed, Polygon, Sides, UniformHemisphere};
///
/// // One face of a cube, from its centre: a third of the hemisphere.
/// let face = [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0)].map(|(x, y)| DVec3::new(x, y, 1.0));
/// let face = Polygon::new(&face, Sides::One)?;
/// let fraction = LinearlyTransformed::<f64, UniformHemisphere>::identity().integrate_polygon(&face, Horizon::BOTH);
/// assert!((fraction - 1.0 / 3.0).abs() < 1e-15);
/// # Ok::<(), ltc_core::InputError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UniformHemisphere;

impl<R: Real> Base<R> for UniformHemisphere {
    const PEAK: f64 = 0.5 / PI;

    fn density(w: R::Vec3, k: R) -> R {
        if w.z() <= R::ZERO {
            return R::ZERO;
        }
        let length = w.length();
        k / length / length / length * R::of(<Self as Base<R>>::PEAK)
    }

    fn sample(u: [R; 2]) -> R::Vec3 {
        let r = (u[0] * (R::of(2.0) - u[0])).max(R::ZERO).sqrt();
        let (sin, cos) = (R::of(2.0) * R::PI * u[1]).sin_cos();
        R::Vec3::new(r * cos, r * sin, R::ONE - u[0])
    }
}

impl<R: Real> PolygonBase<R> for UniformHemisphere {
    /// The solid angle, over 2π, of the transformed polygon's part above z = 0.
    fn integrate_polygon(
        distribution: &LinearlyTransformed<R, Self>,
        polygon: &Polygon<'_, R>,
        horizon: Horizon,
    ) -> R {
        let region = Region::of(distribution, polygon, horizon);
        R::of(region.solid_angle * 0.5 / PI).clamped(R::ZERO, R::ONE)
    }
}
