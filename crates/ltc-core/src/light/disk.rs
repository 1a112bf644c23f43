//! Disk lights: the fraction of a lobe that sees the disk, in closed form.

use glam::DVec3;

use super::cone_light::ConeLight;
use super::ellipse::Ellipse;
use super::facing::{Facing, Seen, side_of_normal};
use super::spaces::Spaces;
use super::wide::widened;
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
/// - **Accuracy**: that of [`Ellipse`].
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
    /// As it was given.
    normal: R::Vec3,
    /// Of unit length, at right angles to each other and to the normal.
    across: [R::Vec3; 2],
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
        let unit = normal.try_unit().ok_or(InputError::Degenerate { name: "disk normal" })?;
        let tangent = tangent_to::<R>(unit);
        Ok(Self { centre, normal, across: [tangent, unit.cross(tangent)], radius, sides })
    }

    /// In f64, axes included.
    #[cold]
    fn grazing(&self, side: Seen) -> ConeLight<f64> {
        let normal = widened::<R>(self.normal).try_unit().unwrap_or(DVec3::Z);
        let tangent = tangent_to::<f64>(normal);
        let [u, v] = [tangent, normal.cross(tangent)].map(|axis| axis * self.radius.to_f64());
        ConeLight::seen(side, widened::<R>(self.centre), u, v)
    }

    /// The same light as an ellipse.
    pub fn to_ellipse(&self) -> Ellipse<R> {
        Ellipse::of_valid(self.centre, self.across.map(|axis| axis * self.radius), self.sides)
    }
}

impl<R: Real> Light<R> for Disk<R> {
    #[inline]
    fn integrate_within(&self, ltc: &Ltc<R>, horizon: Horizon) -> R {
        let Some(Facing { side, is_grazing }) = side_of_normal::<R>(self.centre, self.normal, self.sides)
        else {
            return R::ZERO;
        };
        if is_grazing {
            return R::of(self.grazing(side).fraction(&Spaces::wide(ltc), horizon));
        }
        let [u, v] = self.across.map(|axis| axis * self.radius);
        ConeLight::seen(side, self.centre, u, v).fraction(&Spaces::of(ltc), horizon)
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
