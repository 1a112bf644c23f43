//! Line lights: thin cylinders, in closed form.

use super::segment::Segment;
use super::{Horizon, Light};
use crate::{InputError, Ltc, Real, Vector};

/// A thin cylinder from `p0` to `p1` without end caps, by the line approximation of Heitz and Hill 2017
/// ("Linear-Light Shading with Linearly Transformed Cosines", §1.2 to 1.4).
///
/// It emits the same radiance from all of its wall, in all directions outwards; `p0`, `p1` and `radius` are lengths of one unit,
/// whichever. With `ω_t` the line's direction its value is
///
/// `min(1, R ∫ D(ω) 2 ‖ω × ω_t‖ / ‖p‖² dl)` (eq. 1.6, 1.10 and 1.11),
///
/// in closed form (eq. 1.20 to 1.26, rearranged so that nothing cancels). f64 is within 1e-9 of that integral. f32 is within
/// 1e-4 · max(1, cond(M)/100) of f64 where the radius is at most the distance of the nearest point; 7e-6 was seen at
/// cond(M) = 100. Beyond that the error grows with radius over distance.
///
/// # How well it stands for a cylinder
/// It is the limit of a thin one. Largest error against the true wall, for lines with their nearest point in the lobe at distance d, as a
/// fraction of the lobe; "lobe 1/3" is an LTC that is 3 to 1 times narrower than the cosine, at any tilt:
///
/// | R/d | cosine | lobe 1/3 | lobe 1/10 |
/// |---|---|---|---|
/// | 0.01 | 4e-5 | 2e-4 | 5e-4 |
/// | 0.03 | 3e-4 | 1e-3 | 2e-2 |
/// | 0.1 | 4e-3 | 2e-2 | 0.3 |
/// | 0.3 | 4e-2 | 0.3 | 0.6 |
/// | 0.9 | 0.5 | 0.7 | 0.9 |
///
/// That is some 0.4 (R/d)² for Lambert, and useless where the cylinder looks wider than the lobe.
///
/// # Degenerate lights
/// - Radius 0, length 0, both ends on one ray from the shading point (`p0 ∥ p1`), a line exactly through the shading point: 0.
/// - In the surface's horizon or below it: 0. A line that is parallel to the horizon vanishes at once when it meets it.
/// - A shading point closer to the line than `radius` is treated like any other: the integral grows as 1/d, so that the value is 1
///   where the near part is above both horizons. A true cylinder would be dark from inside.
/// - Nearness alone does no harm: a line that passes the shading point at 1e-200 (f32: 1e-30) of its length, with a radius to match,
///   has the value that it should have.
///
/// ```
/// use glam::DVec3;
/// use ltc_core::{Light, Line};
///
/// // A tube 1.2 long and 26 mm thick, 2 above a diffuse floor.
/// let tube = Line::<f64>::new(DVec3::new(-0.6, 0.0, 2.0), DVec3::new(0.6, 0.0, 2.0), 0.013)?;
/// let fraction = tube.irradiance();
/// assert!((fraction - 0.002345).abs() < 1e-6);
/// # Ok::<(), ltc_core::InputError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line<R: Real> {
    p0: R::Vec3,
    p1: R::Vec3,
    radius: R,
}

impl<R: Real> Line<R> {
    /// The line from `p0` to `p1`, relative to the shading point in the shading frame, as thick as `radius` says.
    ///
    /// # Errors
    /// [`InputError::NotFinite`] for a NaN or infinite number, [`InputError::OutOfRange`] for a radius below 0.
    #[inline]
    pub fn new(p0: R::Vec3, p1: R::Vec3, radius: R) -> Result<Self, InputError> {
        if !(p0.is_finite() && p1.is_finite()) {
            return Err(InputError::NotFinite { name: "end of a line" });
        }
        check_extent::<R>("radius", radius)?;
        Ok(Self { p0, p1, radius })
    }

    /// The first end.
    pub fn p0(&self) -> R::Vec3 {
        self.p0
    }

    /// The second end.
    pub fn p1(&self) -> R::Vec3 {
        self.p1
    }

    /// The radius.
    pub fn radius(&self) -> R {
        self.radius
    }

    /// The integral before it is clamped from above; 0 for a degenerate line.
    #[inline]
    pub(super) fn unclamped(&self, ltc: &Ltc<R>, horizon: Horizon) -> R {
        let Some(segment) = Segment::new(self.p0, self.p1) else { return R::ZERO };
        R::of(2.0) * (self.radius * segment.shrink()) * segment.integral(ltc, horizon)
    }
}

/// `Ok` for a finite number that is not negative.
pub(super) fn check_extent<R: Real>(name: &'static str, value: R) -> Result<(), InputError> {
    if !value.is_finite() {
        return Err(InputError::NotFinite { name });
    }
    if value < R::ZERO {
        return Err(InputError::OutOfRange { name, value: value.to_f64(), min: 0.0, max: f64::INFINITY });
    }
    Ok(())
}

impl<R: Real> Light<R> for Line<R> {
    fn integrate_within(&self, ltc: &Ltc<R>, horizon: Horizon) -> R {
        self.unclamped(ltc, horizon).clamped(R::ZERO, R::ONE)
    }
}

/// A point of a line, as [`Line::sample`] draws it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineSample<R: Real> {
    /// Unit direction from the shading point.
    pub wi: R::Vec3,
    /// Distance of the point.
    pub distance: R,
    /// Density of the point per length along the line.
    pub pdf_length: R,
    /// Density of `wi` per radian on the arc that the line spans: one over the arc.
    pub pdf_angle: R,
}

impl<R: Real> Line<R> {
    /// A point of the line, uniform in the angle that the line spans at the shading point (equi-angular), from `u` ∈ [0, 1).
    ///
    /// A line has no solid angle, so that its samples have a density per length or per radian instead. The mean of
    /// `2 · radius · D(wi) / (distance · pdf_angle)` is the line's integral before it is clamped. Horizons are not regarded.
    /// `None` for a line that spans no angle.
    pub fn sample(&self, u: R) -> Option<LineSample<R>> {
        let segment = Segment::new(self.p0, self.p1)?;
        segment.sample(u)
    }

    /// Density per length with which [`Line::sample`] draws the point `p0 + t (p1 − p0)`, t ∈ [0, 1]; 0 off the line.
    pub fn pdf_length(&self, t: R) -> R {
        let on_line = t >= R::ZERO && t <= R::ONE;
        let segment = if on_line { Segment::new(self.p0, self.p1) } else { None };
        segment.map_or(R::ZERO, |segment| segment.pdf_length(t))
    }
}
