//! The uniform sphere.

use core::f64::consts::PI;

use super::polygon::Region;
use super::{Base, LinearlyTransformed, PolygonBase};
use crate::{Horizon, Polygon, Real, Vector};

/// The uniform distribution over all directions, `Do = 1/(4π)`.
///
/// Transformed, it is symmetric about the origin: the density of a direction and of its opposite are equal.
///
/// ```
/// use glam::DVec3;
/// use ltc_core::{Horizon, LinearlyTransformed, Polygon, Sides, UniformSphere};
///
/// // The fraction of the uniform sphere that sees one face of a cube, from its centre: a sixth.
/// let face = [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0)].map(|(x, y)| DVec3::new(x, y, 1.0));
/// let face = Polygon::new(&face, Sides::One)?;
/// let fraction = LinearlyTransformed::<f64, UniformSphere>::identity().integrate_polygon(&face, Horizon::BOTH);
/// assert!((fraction - 1.0 / 6.0).abs() < 1e-15);
/// # Ok::<(), ltc_core::InputError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UniformSphere;

impl<R: Real> Base<R> for UniformSphere {
    const PEAK: f64 = 0.25 / PI;

    fn density(w: R::Vec3, k: R) -> R {
        let length = w.length();
        k / length / length / length * R::of(<Self as Base<R>>::PEAK)
    }

    fn sample(u: [R; 2]) -> R::Vec3 {
        let r = R::of(2.0) * (u[0] * (R::ONE - u[0])).max(R::ZERO).sqrt();
        let (sin, cos) = (R::of(2.0) * R::PI * u[1]).sin_cos();
        R::Vec3::new(r * cos, r * sin, R::ONE - R::of(2.0) * u[0])
    }
}

impl<R: Real> PolygonBase<R> for UniformSphere {
    /// The solid angle of the transformed polygon over 4π; at most ½.
    fn integrate_polygon(
        distribution: &LinearlyTransformed<R, Self>,
        polygon: &Polygon<'_, R>,
        horizon: Horizon,
    ) -> R {
        let region = Region::of(distribution, polygon, Horizon { cosine: false, ..horizon });
        R::of(region.solid_angle * 0.25 / PI).clamped(R::ZERO, R::of(0.5))
    }
}
