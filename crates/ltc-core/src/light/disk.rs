//! Disk lights: the fraction of a lobe that sees the disk, in closed form.

use super::cone_light::ConeLight;
use super::ellipse::Ellipse;
use super::facing::Normal;
use super::{Horizon, Light, LightSample, SampleLight, Sides};
use crate::frame::tangent_to;
use crate::{InputError, Ltc, Real, Vector, check_range};

/// A flat circular light, given relative to the shading point in the shading frame.
///
/// - **Units**: lengths in any one unit; only their ratios matter. The same radiance in all directions.
/// - **Sides**: the front is the side that the normal points to.
/// - **Formula**: exact for every lobe; see [`Ellipse`], of which this is the round one.
/// - **Valid range**: any finite centre, any normal but 0, radius ≥ 0. Radius 0, a shading point in the disk's plane (as far
///   as rounding can tell) or behind a one-sided disk give exactly 0.
///
/// ```
/// use glam::DVec3;
/// use ltc_core::{Disk, Light as _, Sides};
///
/// // Radius 1, overhead at distance 1, facing down: the form factor is r²/(r² + d²).
/// let light = Disk::<f64>::new(DVec3::Z, -DVec3::Z, 1.0, Sides::One)?;
/// assert!((light.irradiance() - 0.5).abs() < 1e-15);
/// # Ok::<(), ltc_core::InputError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Disk<R: Real> {
    centre: R::Vec3,
    /// Unit length.
    normal: R::Vec3,
    radius: R,
    sides: Sides,
}

impl<R: Real> Disk<R> {
    /// The disk around `centre` that faces along `normal`, whose length does not matter.
    ///
    /// # Errors
    /// [`InputError::NotFinite`] for a NaN or infinite number, [`InputError::OutOfRange`] for a negative radius,
    /// [`InputError::Degenerate`] for a normal of length 0.
    pub fn new(centre: R::Vec3, normal: R::Vec3, radius: R, sides: Sides) -> Result<Self, InputError> {
        if !(centre.is_finite() && normal.is_finite()) {
            return Err(InputError::NotFinite { name: "disk centre or normal" });
        }
        check_range("disk radius", radius.to_f64(), 0.0, f64::MAX)?;
        let normal = normal.try_unit().ok_or(InputError::Degenerate { name: "disk normal" })?;
        Ok(Self { centre, normal, radius, sides })
    }

    /// The same light as an ellipse.
    pub fn to_ellipse(&self) -> Ellipse<R> {
        let tangent = tangent_to::<R>(self.normal);
        let [u, v] = [tangent, self.normal.cross(tangent)].map(|axis| axis * self.radius);
        Ellipse::of_valid(self.centre, [u, v], self.sides)
    }
}

impl<R: Real> Light<R> for Disk<R> {
    fn integrate_within(&self, ltc: &Ltc<R>, horizon: Horizon) -> R {
        if !Normal::<R>::given(self.normal).is_seen(self.centre, self.sides) {
            return R::ZERO;
        }
        let tangent = tangent_to::<R>(self.normal);
        let [u, v] = [tangent, self.normal.cross(tangent)].map(|axis| axis * self.radius);
        ConeLight::<R>::new(self.centre, u, v).fraction(ltc, horizon)
    }
}

/// Uniform over the disk's area.
impl<R: Real> SampleLight<R> for Disk<R> {
    fn sample(&self, u: [R; 2]) -> Option<LightSample<R>> {
        self.to_ellipse().sample(u)
    }

    fn pdf(&self, wi: R::Vec3) -> R {
        self.to_ellipse().pdf(wi)
    }
}
