//! Elliptical lights: the fraction of a lobe that sees the ellipse, in closed form.

use super::cone_light::ConeLight;
use super::facing::{Facing, side_of_span};
use super::spaces::Spaces;
use super::wide::widened;
use super::{Horizon, Light, LightSample, SampleLight, Sides};
use crate::{InputError, Ltc, Real, Vector};

/// A flat elliptical light `centre + axis_u cos t + axis_v sin t`, given relative to the shading point in the shading frame.
///
/// - **Units**: lengths in any one unit; only their ratios matter. The same radiance in all directions.
/// - **Sides**: the front is the side that `axis_u × axis_v` points to.
/// - **Axes**: any two conjugate half-axes, at right angles or not: every affine image of a disk is such an ellipse.
/// - **Formula**: exact for every lobe. In cosine space the light is another ellipse; over an elliptical cone of half-widths
///   atan A, atan B the vector irradiance lies along the cone's axis and has length `AB/√((1 + A²)(1 + B²))`. The axis is the
///   normal of the confocal ellipsoid through the shading point, which needs one root of a cubic, found without
///   cancellation wherever roots coincide. Where a horizon cuts, Stokes' theorem is applied to the arcs and chords that are
///   left: `½ ∮ (r × dr)·z/|r|²` has an artanh, an arctan and an angle for each arc, an angle for each chord.
/// - **Valid range**: any finite input. An ellipse without area, a shading point in its plane (as far as rounding can tell)
///   or behind a one-sided one give exactly 0.
/// - **Accuracy** (`tests/round`): f64 within 1e-9 of cubature (measured 4e-13) over roughness from 1e-4, grazing to 89.99°, scales
///   from 1e-6 to 1e6, aspects to 1e5, distances to the
///   light's plane from 1e-7; f32 within 2e-5 of f64 of the same input, 1e-4 with its rounding where the
///   light is up to 1e3 times nearer or farther than its size. Both times cond M / 100 above 100. At δ from a light of size s, nearer than
///   that, an f32 costs ε s/δ.
///
/// ```
/// use glam::DVec3;
/// use ltc_core::{Disk, Ellipse, Light as _, Sides};
///
/// let centre = DVec3::new(0.3, 0.2, 1.0);
/// // The front faces down: y × x = −z.
/// let round = Ellipse::<f64>::new(centre, DVec3::Y * 0.5, DVec3::X * 0.5, Sides::One)?;
/// let disk = Disk::<f64>::new(centre, -DVec3::Z, 0.5, Sides::One)?;
/// assert!((round.irradiance() - disk.irradiance()).abs() < 1e-15);
/// # Ok::<(), ltc_core::InputError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Ellipse<R: Real> {
    centre: R::Vec3,
    axes: [R::Vec3; 2],
    sides: Sides,
}

impl<R: Real> Ellipse<R> {
    /// # Errors
    /// [`InputError::NotFinite`] for a NaN or infinite number.
    pub fn new(centre: R::Vec3, axis_u: R::Vec3, axis_v: R::Vec3, sides: Sides) -> Result<Self, InputError> {
        if !(centre.is_finite() && axis_u.is_finite() && axis_v.is_finite()) {
            return Err(InputError::NotFinite { name: "ellipse centre or axis" });
        }
        Ok(Self::of_valid(centre, [axis_u, axis_v], sides))
    }

    pub(super) fn of_valid(centre: R::Vec3, axes: [R::Vec3; 2], sides: Sides) -> Self {
        Self { centre, axes, sides }
    }

    /// Centre and axes over the largest coordinate of all: no square over- or underflows.
    fn scaled(&self) -> Option<(Self, R)> {
        let largest = self.centre.max_abs().max(self.axes[0].max_abs()).max(self.axes[1].max_abs());
        let shrink = R::ONE / largest;
        let light = Self { centre: self.centre * shrink, axes: self.axes.map(|a| a * shrink), ..*self };
        (largest > R::ZERO && shrink.is_finite()).then_some((light, largest))
    }

    /// The side that is seen, if any.
    fn side(&self) -> Option<Facing> {
        side_of_span::<R>(self.centre, self.axes[0], self.axes[1], self.sides)
    }
}

impl<R: Real> Light<R> for Ellipse<R> {
    #[inline]
    fn integrate_within(&self, ltc: &Ltc<R>, horizon: Horizon) -> R {
        let Some(Facing { side, is_grazing }) = self.side() else { return R::ZERO };
        if is_grazing {
            let [centre, u, v] = [self.centre, self.axes[0], self.axes[1]].map(widened::<R>);
            let light = ConeLight::<f64>::seen(side, centre, u, v);
            return R::of(light.fraction(&Spaces::wide(ltc), horizon));
        }
        ConeLight::seen(side, self.centre, self.axes[0], self.axes[1]).fraction(&Spaces::of(ltc), horizon)
    }
}

/// Uniform over the ellipse's area π |axis_u × axis_v|.
impl<R: Real> SampleLight<R> for Ellipse<R> {
    fn sample(&self, u: [R; 2]) -> Option<LightSample<R>> {
        let (light, unit) = self.scaled()?;
        self.side()?;
        let normal = light.axes[0].cross(light.axes[1]);
        let (sin, cos) = (R::of(2.0) * R::PI * u[1]).sin_cos();
        let point = light.centre + (light.axes[0] * cos + light.axes[1] * sin) * u[0].sqrt();
        let sample = LightSample::of_area(point, normal.try_unit()?, R::PI * normal.length())?;
        Some(LightSample { distance: sample.distance * unit, ..sample })
    }

    fn pdf(&self, wi: R::Vec3) -> R {
        self.pdf_if_hit(wi).unwrap_or(R::ZERO)
    }
}

impl<R: Real> Ellipse<R> {
    fn pdf_if_hit(&self, wi: R::Vec3) -> Option<R> {
        let (light, _) = self.scaled()?;
        self.side()?;
        let n = light.axes[0].cross(light.axes[1]);
        let t = n.dot(light.centre) / n.dot(wi);
        if !(t > R::ZERO && t.is_finite()) {
            return None;
        }
        // Coordinates along the half-axes, by the dual basis.
        let offset = wi * t - light.centre;
        let along = [offset.cross(light.axes[1]).dot(n), light.axes[0].cross(offset).dot(n)];
        let [x, y] = along.map(|a| a / n.dot(n));
        let inside = x.squared() + y.squared() <= R::ONE;
        let sample = LightSample::of_area(wi * t, n.try_unit()?, R::PI * n.length())?;
        inside.then_some(sample.pdf)
    }
}
