//! Strip lights: thin rectangles, in closed form.

use super::line::check_extent;
use super::segment::{self, Segment};
use super::{Horizon, Light, LightSample, SampleLight, Sides};
use crate::{InputError, Ltc, Real, Vector};

/// A thin rectangle whose middle line runs from `p0` to `p1`, as a line (2017 chapter, §1.6, corrected).
///
/// It emits the same radiance in all directions of its front, or of both sides; `p0`, `p1` and `width` are lengths of one unit,
/// whichever. With ω_n its normal and u the unit vector from the shading point to the nearest point of its line, its value is
///
/// `min(1, (w/2) |ω_n·u| I_line) = min(1, w ∫ D(ω) |ω·ω_n| / ‖p‖² dl)`,
///
/// where the chapter's eq. 1.35 has `|ω_n·ω⊥|`, which vanishes for a strip that faces the shading point, and Listing 1.11 counts
/// the width twice. f64 is within 1e-9 of that integral, f32 within 1e-4 · max(1, cond(M)/100) of f64 where half the width is at
/// most the distance. It is the limit of a thin rectangle, with an error like that of [`crate::Line`], R being w/2. For a wide one
/// a [`crate::Polygon`] is exact.
///
/// 0 for no width, no length, a line through the shading point, a strip seen edge-on (to 8 ε), from behind if one-sided, and below
/// the surface's horizon.
///
/// ```
/// use glam::DVec3;
/// use ltc_core::{Light, Sides, Strip};
///
/// let (p0, p1) = (DVec3::new(-0.6, 0.0, 2.0), DVec3::new(0.6, 0.0, 2.0));
/// let strip = Strip::<f64>::new(p0, p1, 0.026, -DVec3::Z, Sides::One)?;
/// assert!((strip.irradiance() - 0.002345).abs() < 1e-6);
/// # Ok::<(), ltc_core::InputError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strip<R: Real> {
    p0: R::Vec3,
    p1: R::Vec3,
    width: R,
    /// Unit vector, at right angles to the line.
    normal: R::Vec3,
    sides: Sides,
}

impl<R: Real> Strip<R> {
    /// The strip around the line from `p0` to `p1`, `width` wide from edge to edge, its front where `normal` points to.
    /// The normal's length is free; its part along the line is dropped.
    ///
    /// # Errors
    /// [`InputError::NotFinite`] for a NaN or infinite number, [`InputError::OutOfRange`] for a width below 0,
    /// [`InputError::Degenerate`] for a normal that is zero or parallel to the line.
    pub fn new(
        p0: R::Vec3,
        p1: R::Vec3,
        width: R,
        normal: R::Vec3,
        sides: Sides,
    ) -> Result<Self, InputError> {
        if !(p0.is_finite() && p1.is_finite()) {
            return Err(InputError::NotFinite { name: "end of a strip" });
        }
        if !normal.is_finite() {
            return Err(InputError::NotFinite { name: "normal of a strip" });
        }
        check_extent::<R>("width", width)?;
        let unit = segment::unit::<R>(normal).ok_or(InputError::Degenerate { name: "normal of a strip" })?;
        // A strip of no length has no direction to be orthogonal to, and no light.
        let normal = match unit_difference::<R>(p0, p1) {
            Some(axis) => {
                let across = unit - axis * unit.dot(axis);
                // What is left of a parallel normal is rounding error, whose direction means nothing.
                let keeps_a_direction = across.length() > R::EPSILON * R::of(16.0);
                segment::unit::<R>(across).filter(|_| keeps_a_direction)
            }
            None => Some(unit),
        };
        let normal = normal.ok_or(InputError::Degenerate { name: "normal of a strip" })?;
        Ok(Self { p0, p1, width, normal, sides })
    }

    /// The first end of the middle line.
    pub fn p0(&self) -> R::Vec3 {
        self.p0
    }

    /// The second end of the middle line.
    pub fn p1(&self) -> R::Vec3 {
        self.p1
    }

    /// The width.
    pub fn width(&self) -> R {
        self.width
    }

    /// Unit normal of the front, at right angles to the line.
    pub fn normal(&self) -> R::Vec3 {
        self.normal
    }

    /// Which sides emit.
    pub fn sides(&self) -> Sides {
        self.sides
    }
}

/// The unit vector from `a` to `b`, whose difference may overflow.
fn unit_difference<R: Real>(a: R::Vec3, b: R::Vec3) -> Option<R::Vec3> {
    segment::unit::<R>(b * R::of(0.5) - a * R::of(0.5))
}

impl<R: Real> Light<R> for Strip<R> {
    fn integrate_within(&self, ltc: &Ltc<R>, horizon: Horizon) -> R {
        let Some(segment) = Segment::new(self.p0, self.p1) else { return R::ZERO };
        let Some(towards_line) = segment.towards_line() else { return R::ZERO };
        // Below 8 ε rounding decides which side is seen: that is edge-on.
        let facing = -self.normal.dot(towards_line);
        let tilt = match self.sides {
            Sides::One => facing,
            Sides::Two => facing.abs(),
        };
        if tilt <= R::of(8.0) * R::EPSILON {
            return R::ZERO;
        }
        let width = self.width * segment.shrink() * tilt;
        (width * segment.integral(ltc, horizon)).clamped(R::ZERO, R::ONE)
    }
}

/// The rectangle that the strip stands for.
struct Rectangle<R: Real> {
    along: R::Vec3,
    across: R::Vec3,
    length: R,
    area: R,
}

impl<R: Real> Strip<R> {
    /// `None` where the shading point sees nothing of it.
    fn rectangle(&self) -> Option<Rectangle<R>> {
        let along = unit_difference::<R>(self.p0, self.p1)?;
        let facing = -self.normal.dot(self.p0);
        let seen = match self.sides {
            Sides::One => facing > R::ZERO,
            Sides::Two => facing != R::ZERO,
        };
        let length = (self.p1 - self.p0).length();
        let area = length * self.width;
        let across = along.cross(self.normal);
        (seen && area > R::ZERO && area.is_finite()).then_some(Rectangle { along, across, length, area })
    }
}

/// Uniform by area on the rectangle.
impl<R: Real> SampleLight<R> for Strip<R> {
    fn sample(&self, u: [R; 2]) -> Option<LightSample<R>> {
        let Rectangle { along, across, length, area } = self.rectangle()?;
        let point = self.p0 + along * (u[0] * length) + across * ((u[1] - R::of(0.5)) * self.width);
        LightSample::of_area(point, self.normal, area)
    }

    fn pdf(&self, wi: R::Vec3) -> R {
        let Some(Rectangle { along, across, length, area }) = self.rectangle() else { return R::ZERO };
        let t = self.normal.dot(self.p0) / self.normal.dot(wi);
        let offset = wi * t - self.p0;
        let (x, y) = (offset.dot(along), offset.dot(across));
        let on_light = t > R::ZERO && x >= R::ZERO && x <= length && y.abs() <= R::of(0.5) * self.width;
        let sample = if on_light { LightSample::of_area(wi * t, self.normal, area) } else { None };
        sample.map_or(R::ZERO, |sample| sample.pdf)
    }
}
