//! Lights of four corners, by a shorter way than any polygon's.

use super::ring::integrate;
use super::{Horizon, Light, Polygon, Sides};
use crate::{InputError, Ltc, Matrix as _, Real, Vector as _};

/// A flat light of four corners, given relative to the shading point in the shading frame.
///
/// The same light, convex or not, as a [`Polygon`] of these vertices, and the same value within rounding, in about a
/// quarter of the time: a convex quad off its plane has its four edges summed side by side, any other goes the polygon's
/// way. Vertices run counter-clockwise seen from the emitting side. For many at once see [`crate::QuadBatch`].
///
/// ```
/// use glam::DVec3;
/// use ltc_core::{Light, Ltc, Polygon, Quad, Sides};
/// let corners = [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0)].map(|(x, y)| DVec3::new(x, y, 2.0));
/// let quad = Quad::<f64>::new(corners, Sides::One)?;
/// let polygon = Polygon::<f64>::new(&corners, Sides::One)?;
/// assert!((quad.irradiance() - polygon.irradiance()).abs() < 1e-14);
/// # Ok::<(), ltc_core::InputError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Quad<R: Real> {
    vertices: [R::Vec3; 4],
    sides: Sides,
}

impl<R: Real> Quad<R> {
    /// # Errors
    /// [`InputError::NotFinite`] for a NaN or infinite coordinate.
    #[inline]
    pub fn new(vertices: [R::Vec3; 4], sides: Sides) -> Result<Self, InputError> {
        if !vertices.iter().all(|v| v.is_finite()) {
            return Err(InputError::NotFinite { name: "vertex" });
        }
        Ok(Self { vertices, sides })
    }

    /// The four corners.
    pub fn vertices(&self) -> &[R::Vec3; 4] {
        &self.vertices
    }

    /// Which sides emit.
    pub fn sides(&self) -> Sides {
        self.sides
    }

    /// The same light as a polygon.
    pub fn polygon(&self) -> Polygon<'_, R> {
        Polygon::of_quad(&self.vertices, self.sides)
    }

    #[cold]
    fn the_long_way(&self, ltc: &Ltc<R>, horizon: Horizon) -> R {
        self.polygon().integrate_within(ltc, horizon)
    }
}

impl<R: Real> Light<R> for Quad<R> {
    /// As [`Polygon`]'s.
    #[inline]
    fn integrate_within(&self, ltc: &Ltc<R>, horizon: Horizon) -> R {
        let columns = ltc.cosine_from_target().columns().map(|c| [c.x(), c.y(), c.z()].map(R::to_f64));
        let vertices = self.vertices.map(|v| [v.x(), v.y(), v.z()].map(R::to_f64));
        // Beyond this, products leave the range of f64.
        let [x, y, z] = columns.map(|[x, y, z]| x.abs() + y.abs() + z.abs());
        let wild = x + y + z > 1e30;
        if !horizon.cosine || wild {
            return self.the_long_way(ltc, horizon);
        }
        match integrate(&vertices, &columns, horizon.surface) {
            Some((fraction, front)) if front || self.sides == Sides::Two => R::of(fraction),
            Some(_) => R::ZERO,
            None => self.the_long_way(ltc, horizon),
        }
    }
}
