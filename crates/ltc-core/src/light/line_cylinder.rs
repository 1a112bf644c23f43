//! Thin cylinders with end caps, by the line approximation.

use super::line::Line;
use super::segment::unit;
use super::{Horizon, Light, LightSample, SampleLight};
use crate::{InputError, Ltc, Matrix, Real, Vector};

/// A thin closed cylinder from `p0` to `p1`: a [`Line`] and, if asked for, its two end caps as points (2017 chapter, §1.5).
///
/// A cap emits outwards only. It adds `π R² D(ω_p) max(0, ω_p·ω_t) / ‖p‖²` (eq. 1.33 and 1.34, ω_t pointing into the cylinder) to the
/// line, and the sum is clamped to 1. Caps are off by default, as the chapter advises: a narrow lobe sees the point brighten
/// like a bulb. Largest error of a cap in the lobe against the true disk, as a fraction of the lobe (lobes as in [`Line`]):
///
/// | R/d | cosine | lobe 1/3 | lobe 1/10 |
/// |---|---|---|---|
/// | 0.1 | 2e-4 | 5e-3 | 0.2 |
/// | 0.3 | 1e-2 | 0.2 | 0.5 |
///
/// Where the chapter's points would jump as they rise above the surface's horizon, the fraction of the disk that is above it counts.
/// A line that points at the shading point shows its near cap alone; one of no length shows nothing.
///
/// [`SampleLight`] draws from the true cylinder that this approximates: its mean over samples is the truth.
///
/// ```
/// use glam::DVec3;
/// use ltc_core::{Light, LineCylinder};
///
/// let open = LineCylinder::<f64>::new(DVec3::new(0.5, 0.0, 1.0), DVec3::new(2.0, 0.0, 1.5), 0.05)?;
/// assert!(open.with_caps(true).irradiance() > open.irradiance());
/// # Ok::<(), ltc_core::InputError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineCylinder<R: Real> {
    line: Line<R>,
    caps: bool,
}

impl<R: Real> LineCylinder<R> {
    /// The cylinder around the axis from `p0` to `p1`, without caps.
    ///
    /// # Errors
    /// As [`Line::new`].
    pub fn new(p0: R::Vec3, p1: R::Vec3, radius: R) -> Result<Self, InputError> {
        Ok(Self { line: Line::new(p0, p1, radius)?, caps: false })
    }

    /// The same with or without emitting end caps.
    #[must_use]
    pub fn with_caps(self, caps: bool) -> Self {
        Self { caps, ..self }
    }

    /// The lateral surface.
    pub fn line(&self) -> &Line<R> {
        &self.line
    }

    /// Whether the ends emit.
    pub fn caps(&self) -> bool {
        self.caps
    }
}

impl<R: Real> Light<R> for LineCylinder<R> {
    fn integrate_within(&self, ltc: &Ltc<R>, horizon: Horizon) -> R {
        let lateral = self.line.unclamped(ltc, horizon);
        let caps = if self.caps { self.caps_unclamped(ltc, horizon) } else { R::ZERO };
        (lateral + caps).clamped(R::ZERO, R::ONE)
    }
}

impl<R: Real> LineCylinder<R> {
    /// Eq. 1.33 and 1.34, in lengths divided by a power of two.
    fn caps_unclamped(&self, ltc: &Ltc<R>, horizon: Horizon) -> R {
        let (p0, p1) = (self.line.p0(), self.line.p1());
        let scale = p0.max_abs().max(p1.max_abs()).floor_power_of_two();
        if scale <= R::ZERO {
            return R::ZERO;
        }
        let shrink = R::ONE / scale;
        let (p0, p1, radius) = (p0 * shrink, p1 * shrink, self.line.radius() * shrink);
        let Some(axis) = unit::<R>(p1 - p0) else { return R::ZERO };
        cap(p0, axis, radius, ltc, horizon) + cap(p1, -axis, radius, ltc, horizon)
    }
}

/// `π R² D(ω_p) max(0, ω_p·inward) / ‖p‖²` for the cap at `p`, whose emitting side faces against `inward`, times the
/// fraction of the cap that is above the surface's horizon.
///
/// With `q = M⁻¹p` that is `R² q_z max(0, p·inward) / (det M ‖q‖⁴)`: the norms of p cancel.
fn cap<R: Real>(p: R::Vec3, inward: R::Vec3, radius: R, ltc: &Ltc<R>, horizon: Horizon) -> R {
    let facing = p.dot(inward);
    let q = ltc.cosine_from_target().apply(p);
    if facing <= R::ZERO || (horizon.cosine && q.z() <= R::ZERO) {
        return R::ZERO;
    }
    let above = if horizon.surface { fraction_above(p.z(), inward.z(), radius) } else { R::ONE };
    // Ratios of what may be very small or very large, before they are multiplied.
    let distance = q.length();
    let size = radius / distance;
    above * (q.z() / distance) * (size * size) * (facing / distance * ltc.inverse_determinant())
}

/// The fraction of a disk's area above z = 0: its centre at height `z`, the z of its unit normal, its radius.
///
/// The chapter's caps are points and would appear all at once as they rise. So they come up as the disks do, and
/// nothing jumps.
fn fraction_above<R: Real>(z: R, normal_z: R, radius: R) -> R {
    let reach = radius * (R::ONE - normal_z * normal_z).max(R::ZERO).sqrt();
    if z >= reach {
        return R::ONE;
    }
    if z <= -reach {
        return R::ZERO;
    }
    let x = z / reach;
    let y = ((R::ONE - x) * (R::ONE + x)).sqrt();
    R::of(0.5) + (x.atan2(y) + x * y) / R::PI
}

/// What of a true cylinder's surface the shading point can see, for samples of it.
struct Visible<R: Real> {
    axis: R::Vec3,
    length: R,
    radius: R,
    /// Unit vectors across the axis: `back` points from the shading point to the axis, or anywhere if it is on it.
    back: R::Vec3,
    side: R::Vec3,
    /// Distance of the shading point from the axis.
    distance: R,
    /// The lit lateral points are those at angles up to this from `−back`; 0 from inside.
    half_arc: R,
    /// The cap that faces the shading point: its centre.
    cap: Option<R::Vec3>,
}

impl<R: Real> LineCylinder<R> {
    fn visible(&self) -> Option<Visible<R>> {
        let (p0, p1, radius) = (self.line.p0(), self.line.p1(), self.line.radius());
        let axis = (p1 - p0).try_unit()?;
        let (l0, l1) = (p0.dot(axis), p1.dot(axis));
        let foot = p0 - axis * l0;
        let back = foot.try_unit().unwrap_or_else(|| across::<R>(axis));
        let distance = foot.length();
        let cosine = radius / distance;
        let half_arc = if cosine < R::ONE {
            ((R::ONE - cosine) * (R::ONE + cosine)).sqrt().atan2(cosine)
        } else {
            R::ZERO
        };
        let cap = match (l0 > R::ZERO, l1 < R::ZERO) {
            _ if !self.caps => None,
            (true, _) => Some(p0),
            (_, true) => Some(p1),
            _ => None,
        };
        let side = axis.cross(back);
        (radius > R::ZERO).then_some(Visible {
            axis,
            length: l1 - l0,
            radius,
            back,
            side,
            distance,
            half_arc,
            cap,
        })
    }
}

/// A unit vector across a unit vector.
fn across<R: Real>(axis: R::Vec3) -> R::Vec3 {
    let (x, z) = (R::Vec3::new(R::ONE, R::ZERO, R::ZERO), R::Vec3::new(R::ZERO, R::ZERO, R::ONE));
    axis.cross(if axis.x().abs() < R::of(0.6) { x } else { z }).try_unit().unwrap_or(x)
}

impl<R: Real> Visible<R> {
    fn lateral_area(&self) -> R {
        R::of(2.0) * self.half_arc * self.radius * self.length
    }

    fn area(&self) -> R {
        let cap = if self.cap.is_some() { R::PI * self.radius * self.radius } else { R::ZERO };
        self.lateral_area() + cap
    }

    /// Where the ray along the unit vector `wi` first meets the visible surface, and the normal there.
    fn hit(&self, start: R::Vec3, wi: R::Vec3) -> Option<(R::Vec3, R::Vec3)> {
        if let Some(centre) = self.cap {
            let t = centre.dot(self.axis) / wi.dot(self.axis);
            let offset = wi * t - centre;
            if t > R::ZERO && offset.length() <= self.radius {
                return Some((wi * t, self.axis));
            }
        }
        let across = wi - self.axis * wi.dot(self.axis);
        let (a, b) = (across.dot(across), across.dot(self.back) * self.distance);
        let c = (self.distance - self.radius) * (self.distance + self.radius);
        let discriminant = b * b - a * c;
        if c <= R::ZERO || b <= R::ZERO || discriminant <= R::ZERO {
            return None;
        }
        let point = wi * (c / (b + discriminant.sqrt()));
        let along = (point - start).dot(self.axis);
        let radial = point - self.axis * point.dot(self.axis) - self.back * self.distance;
        (along >= R::ZERO && along <= self.length).then_some((point, radial.try_unit()?))
    }
}

/// Uniform by area on the part of the true cylinder's surface that faces the shading point: its lateral side and, with caps,
/// the cap that is seen. From inside the cylinder nothing is seen.
impl<R: Real> SampleLight<R> for LineCylinder<R> {
    fn sample(&self, u: [R; 2]) -> Option<LightSample<R>> {
        let visible = self.visible()?;
        let (area, lateral) = (visible.area(), visible.lateral_area());
        let pick = u[0] * area;
        if let Some(centre) = visible.cap.filter(|_| pick >= lateral) {
            let fraction = ((pick - lateral) / (area - lateral)).clamped(R::ZERO, R::ONE);
            let (sin, cos) = (R::of(2.0) * R::PI * u[1]).sin_cos();
            let offset = visible.back * cos + visible.side * sin;
            let point = centre + offset * (visible.radius * fraction.sqrt());
            return LightSample::of_area(point, visible.axis, area);
        }
        let angle = visible.half_arc * (R::of(2.0) * (pick / lateral) - R::ONE);
        let (sin, cos) = angle.sin_cos();
        let normal = visible.side * sin - visible.back * cos;
        let point = self.line.p0() + visible.axis * (visible.length * u[1]) + normal * visible.radius;
        LightSample::of_area(point, normal, area)
    }

    fn pdf(&self, wi: R::Vec3) -> R {
        let sample = self.visible().and_then(|visible| {
            let (point, normal) = visible.hit(self.line.p0(), wi)?;
            LightSample::of_area(point, normal, visible.area())
        });
        sample.map_or(R::ZERO, |sample| sample.pdf)
    }
}
