//! Line lights: thin cylinders, in closed form.

use super::segment::Segment;
use super::{Horizon, Light};
use crate::{InputError, Ltc, Real, Vector};

/// A thin cylinder from `p0` to `p1` without end caps, by the line approximation of Heitz and Hill 2017.
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
