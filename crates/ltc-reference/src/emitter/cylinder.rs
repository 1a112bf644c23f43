//! Cylindrical lights.

use core::f64::consts::{PI, TAU};

use glam::DVec3;

use super::Emitter;
use crate::error::ReferenceError;
use crate::points::sphere_direction;
use crate::rect_light::LightHit;

/// A round cylinder whose outside emits: its mantle and, if it has them, its caps. With caps the origin sees it in every
/// direction from inside; without, its inside is dark.
///
/// Points are drawn uniformly over what of the surface faces the origin: as the cylinder is convex, all of that is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CylinderEmitter {
    /// The first end.
    foot: DVec3,
    /// Unit vector along the axis.
    axis: DVec3,
    /// Unit vectors across: towards the origin, and axis × that.
    near: DVec3,
    side: DVec3,
    length: f64,
    radius: f64,
    /// Half of the arc of the mantle that faces the origin; 0 from within its continuation.
    half_arc: f64,
    /// The height of the cap that faces the origin, if one does.
    cap: Option<f64>,
    inside: bool,
}

impl CylinderEmitter {
    /// `None` for one without extent.
    ///
    /// # Errors
    /// [`ReferenceError::NonFiniteInput`].
    pub fn new(p0: DVec3, p1: DVec3, radius: f64, caps: bool) -> Result<Option<Self>, ReferenceError> {
        if !(p0.is_finite() && p1.is_finite() && radius.is_finite()) {
            return Err(ReferenceError::NonFiniteInput { what: "cylinder" });
        }
        let length = (p1 - p0).length();
        let Some(axis) = (p1 - p0).try_normalize().filter(|_| radius > 0.0) else { return Ok(None) };
        let height = -p0.dot(axis);
        let across = -p0 - axis * height;
        let distance = across.length();
        let near = across.try_normalize().unwrap_or_else(|| axis.any_orthonormal_vector());
        let half_arc = if distance > radius { (radius / distance).acos() } else { 0.0 };
        let cap = match height {
            h if h < 0.0 => Some(0.0),
            h if h > length => Some(length),
            _ => None,
        };
        let inside = distance <= radius && cap.is_none();
        let side = axis.cross(near);
        let cap = cap.filter(|_| caps);
        let inside = inside && caps;
        Ok(Some(Self { foot: p0, axis, near, side, length, radius, half_arc, cap, inside }))
    }

    fn mantle_area(&self) -> f64 {
        2.0 * self.half_arc * self.radius * self.length
    }

    fn cap_area(&self) -> f64 {
        if self.cap.is_some() { PI * self.radius * self.radius } else { 0.0 }
    }

    fn hit_at(&self, point: DVec3, normal: DVec3) -> Option<LightHit> {
        let distance = point.length();
        let wi = point.try_normalize()?;
        let cosine = -normal.dot(wi);
        let pdf = distance * distance / ((self.mantle_area() + self.cap_area()) * cosine);
        (cosine > 0.0 && pdf.is_finite()).then_some(LightHit { wi, distance, pdf })
    }

    fn mantle_hit(&self, wi: DVec3) -> Option<LightHit> {
        // Across the axis, |t w − c| = r; the nearer root is where the mantle's outside is met.
        let flat = |v: DVec3| v - self.axis * v.dot(self.axis);
        let (w, c) = (flat(wi), flat(self.foot));
        let (a, b) = (w.length_squared(), w.dot(c));
        let discriminant = b * b - a * (c.length_squared() - self.radius * self.radius);
        if self.half_arc <= 0.0 || discriminant < 0.0 || a <= 0.0 {
            return None;
        }
        let t = (b - discriminant.sqrt()) / a;
        let point = wi * t;
        let height = (point - self.foot).dot(self.axis);
        if !(t > 0.0 && (0.0..=self.length).contains(&height)) {
            return None;
        }
        self.hit_at(point, (w * t - c) / self.radius)
    }

    fn cap_hit(&self, wi: DVec3) -> Option<LightHit> {
        let height = self.cap?;
        let centre = self.foot + self.axis * height;
        let t = centre.dot(self.axis) / wi.dot(self.axis);
        let point = wi * t;
        let met = t > 0.0 && (point - centre).length() <= self.radius;
        if met { self.hit_at(point, self.cap_normal(height)) } else { None }
    }

    fn cap_normal(&self, height: f64) -> DVec3 {
        if height > 0.0 { self.axis } else { -self.axis }
    }
}

impl Emitter for CylinderEmitter {
    fn faces_origin(&self) -> bool {
        self.inside || self.half_arc > 0.0 || self.cap.is_some()
    }

    fn sample(&self, u: [f64; 2]) -> Option<LightHit> {
        if self.inside {
            return self.hit(sphere_direction(u));
        }
        let (mantle, cap) = (self.mantle_area(), self.cap_area());
        let at = u[0] * (mantle + cap);
        if at < mantle {
            let (sin, cos) = ((2.0 * u[1] - 1.0) * self.half_arc).sin_cos();
            let normal = self.near * cos + self.side * sin;
            let height = self.length * (at / mantle);
            return self.hit_at(self.foot + self.axis * height + normal * self.radius, normal);
        }
        let height = self.cap?;
        let (sin, cos) = (TAU * u[1]).sin_cos();
        let offset = (self.near * cos + self.side * sin) * (self.radius * ((at - mantle) / cap).sqrt());
        self.hit_at(self.foot + self.axis * height + offset, self.cap_normal(height))
    }

    fn hit(&self, wi: DVec3) -> Option<LightHit> {
        if self.inside {
            // How far it is does not matter to who sees nothing between.
            return Some(LightHit { wi, distance: self.radius, pdf: 0.25 / PI });
        }
        self.mantle_hit(wi).or_else(|| self.cap_hit(wi))
    }
}
