//! The shading frame.

use crate::{InputError, Matrix, Real, Vector};

/// Right-handed orthonormal frame at a shading point: x = tangent (carries `alpha_x`), y = bitangent
/// (`alpha_y`), z = normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadingFrame<R: Real> {
    world_from_shading: R::Mat3,
}

impl<R: Real> ShadingFrame<R> {
    /// The frame with this normal and with the tangent nearest to `tangent` (orthogonalised).
    ///
    /// A tangent that is zero or parallel to the normal has no direction in the surface: the frame then takes an
    /// arbitrary one, as [`ShadingFrame::from_normal`] does.
    ///
    /// # Errors
    /// [`InputError::Degenerate`] for a zero or non-finite normal, [`InputError::NotFinite`] for such a tangent.
    pub fn new(normal: R::Vec3, tangent: R::Vec3) -> Result<Self, InputError> {
        let n = normal.try_unit().ok_or(InputError::Degenerate { name: "normal" })?;
        if !tangent.is_finite() {
            return Err(InputError::NotFinite { name: "tangent" });
        }
        let t = tangent.try_unit().and_then(|t| {
            let in_surface = t - n * t.dot(n);
            // What is left of a parallel tangent is rounding error, whose direction means nothing.
            let keeps_a_direction = in_surface.length() > R::EPSILON * R::of(16.0);
            if keeps_a_direction { in_surface.try_unit() } else { None }
        });
        Ok(t.map_or_else(|| Self::around(n), |t| Self::from_unit(n, t)))
    }

    /// The frame with this normal and any tangent: for isotropic materials.
    ///
    /// # Errors
    /// [`InputError::Degenerate`] for a zero or non-finite normal.
    pub fn from_normal(normal: R::Vec3) -> Result<Self, InputError> {
        normal.try_unit().map(Self::around).ok_or(InputError::Degenerate { name: "normal" })
    }

    /// The frame whose x–z plane contains the view direction `wo`, in which an isotropic lobe has φ = 0.
    /// For `wo` parallel to the normal every tangent is right and an arbitrary one is taken.
    ///
    /// # Errors
    /// As [`ShadingFrame::new`].
    pub fn from_normal_and_view(normal: R::Vec3, wo: R::Vec3) -> Result<Self, InputError> {
        Self::new(normal, wo)
    }

    fn around(n: R::Vec3) -> Self {
        Self::from_unit(n, tangent_to::<R>(n))
    }

    fn from_unit(n: R::Vec3, t: R::Vec3) -> Self {
        Self { world_from_shading: R::Mat3::from_columns(t, n.cross(t), n) }
    }

    /// Tangent, in world space.
    pub fn tangent(&self) -> R::Vec3 {
        self.world_from_shading.columns()[0]
    }

    /// Bitangent, in world space.
    pub fn bitangent(&self) -> R::Vec3 {
        self.world_from_shading.columns()[1]
    }

    /// Normal, in world space.
    pub fn normal(&self) -> R::Vec3 {
        self.world_from_shading.columns()[2]
    }

    /// A world-space vector in shading space.
    pub fn shading_from_world(&self, v: R::Vec3) -> R::Vec3 {
        let [t, b, n] = self.world_from_shading.columns();
        R::Vec3::new(v.dot(t), v.dot(b), v.dot(n))
    }

    /// A shading-space vector in world space.
    pub fn world_from_shading(&self, v: R::Vec3) -> R::Vec3 {
        self.world_from_shading.apply(v)
    }
}

/// A unit vector at right angles to the unit vector `n` (Duff et al. 2017, "Building an Orthonormal Basis, Revisited": no
/// singular direction).
pub(crate) fn tangent_to<R: Real>(n: R::Vec3) -> R::Vec3 {
    let sign = if n.z() < R::ZERO { -R::ONE } else { R::ONE };
    let a = -R::ONE / (sign + n.z());
    let b = n.x() * n.y() * a;
    R::Vec3::new(R::ONE + sign * n.x() * n.x() * a, sign * b, -sign * n.x())
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn assert_orthonormal(frame: &ShadingFrame<f64>) {
        let (t, b, n) = (frame.tangent(), frame.bitangent(), frame.normal());
        for (value, expected) in [
            (t.length(), 1.0),
            (b.length(), 1.0),
            (n.length(), 1.0),
            (t.dot(b), 0.0),
            (b.dot(n), 0.0),
            (n.dot(t), 0.0),
            (t.cross(b).dot(n), 1.0),
        ] {
            assert!((value - expected).abs() < 1e-14, "{frame:?}: {value} is not {expected}");
        }
    }

    #[test]
    fn view_parallel_to_normal_has_a_frame() {
        for n in [DVec3::Z, -DVec3::Z, DVec3::X, DVec3::new(0.3, -0.4, 0.2), DVec3::new(1e-9, 0.0, -1.0)] {
            for wo in [n, n * 3.0, -n, DVec3::ZERO, n + DVec3::splat(1e-17)] {
                let frame = ShadingFrame::<f64>::from_normal_and_view(n, wo).unwrap();
                assert_orthonormal(&frame);
                assert!(frame.normal().dot(n) > 0.0);
            }
        }
    }

    #[test]
    fn the_tangent_is_kept_in_the_surface() {
        let frame = ShadingFrame::<f64>::new(DVec3::new(0.0, 0.0, 2.0), DVec3::new(3.0, 4.0, 7.0)).unwrap();
        assert_orthonormal(&frame);
        assert!((frame.tangent() - DVec3::new(0.6, 0.8, 0.0)).length() < 1e-15);
        let v = DVec3::new(0.1, -0.7, 2.0);
        assert!((frame.world_from_shading(frame.shading_from_world(v)) - v).length() < 1e-14);
    }

    #[test]
    fn a_normal_without_direction_is_an_error() {
        assert!(ShadingFrame::<f64>::from_normal(DVec3::ZERO).is_err());
        assert!(ShadingFrame::<f64>::new(DVec3::Z, DVec3::NAN).is_err());
        assert!(ShadingFrame::<f32>::from_normal(glam::Vec3::splat(f32::INFINITY)).is_err());
    }
}
