//! The clamped squared cosine.

use core::f64::consts::PI;

use super::polygon::Region;
use super::{Base, LinearlyTransformed, PolygonBase};
use crate::{Horizon, Polygon, Real, Vector};

/// The clamped squared cosine, `Do = 3 max(0, z)²/(2π)`: tighter than [`crate::ClampedCosine`].
///
/// ```
/// use glam::DVec3;
/// use ltc_core::{ClampedCosineSquared, Horizon, LinearlyTransformed, Polygon, Sides};
///
/// // One face of a cube, from its centre. By symmetry ∫x² = ∫y² over it, and ∫(x² + y² + z²) is its solid angle.
/// let face = [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0)].map(|(x, y)| DVec3::new(x, y, 1.0));
/// let face = Polygon::new(&face, Sides::One)?;
/// let fraction = LinearlyTransformed::<f64, ClampedCosineSquared>::identity().integrate_polygon(&face, Horizon::BOTH);
/// assert!((fraction - (1.0 / 3.0 + 2.0 / (3.0_f64.sqrt() * core::f64::consts::PI))).abs() < 1e-15);
/// # Ok::<(), ltc_core::InputError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ClampedCosineSquared;

impl<R: Real> Base<R> for ClampedCosineSquared {
    const PEAK: f64 = 1.5 / PI;

    fn density(w: R::Vec3, k: R) -> R {
        if w.z() <= R::ZERO {
            return R::ZERO;
        }
        let length = w.length();
        let cosine = w.z() / length;
        k / length / length * cosine / length * cosine * R::of(<Self as Base<R>>::PEAK)
    }

    /// `z = (1 − u)^(1/3)`; the radius by `1 − z² = u (1 + z)/(1 + z + z²)`, which does not cancel at the pole.
    fn sample(u: [R; 2]) -> R::Vec3 {
        let z = (R::ONE - u[0]).max(R::ZERO).cbrt();
        let r = (u[0] * (R::ONE + z) / (R::ONE + z + z * z)).sqrt();
        let (sin, cos) = (R::of(2.0) * R::PI * u[1]).sin_cos();
        R::Vec3::new(r * cos, r * sin, z)
    }
}

impl<R: Real> PolygonBase<R> for ClampedCosineSquared {
    /// Arvo's axial moment of order 2 (1995, "Applications of irradiance tensors", eq. 17 with n = 2), as
    /// `3 ∫ z² dω = Ω − ∮ z (z-axis · n) ds` with n the outward normal of the boundary, which holds because z has
    /// `div(z ∇z) = 1 − 3z²` on the sphere. Along the great circle from a to b the boundary term is rational:
    /// `(a + b)_z (a × b)_z / (1 + a·b)`. Edges along the horizon add nothing to it, only to Ω.
    fn integrate_polygon(
        distribution: &LinearlyTransformed<R, Self>,
        polygon: &Polygon<'_, R>,
        horizon: Horizon,
    ) -> R {
        let region = Region::of(distribution, polygon, horizon);
        let moment = region.solid_angle + region.axial_boundary;
        R::of(moment * 0.5 / PI).clamped(R::ZERO, R::ONE)
    }
}
