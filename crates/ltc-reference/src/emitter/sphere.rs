//! Spherical lights.

use core::f64::consts::{PI, TAU};

use glam::DVec3;

use super::Emitter;
use crate::error::ReferenceError;
use crate::points::sphere_direction;
use crate::rect_light::LightHit;

/// A sphere that emits outwards and inwards; directions are drawn uniformly over the cap that it fills.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphereEmitter {
    centre: DVec3,
    radius: f64,
}

impl SphereEmitter {
    /// # Errors
    /// [`ReferenceError::NonFiniteInput`].
    pub fn new(centre: DVec3, radius: f64) -> Result<Self, ReferenceError> {
        if centre.is_finite() && radius.is_finite() {
            Ok(Self { centre, radius })
        } else {
            Err(ReferenceError::NonFiniteInput { what: "sphere" })
        }
    }

    fn inside(&self) -> bool {
        self.centre.length() <= self.radius
    }

    /// 1 − cos of the cap's half-width: `s²/(1 + √(1 − s²))`, s its sine.
    fn cap(&self) -> f64 {
        let squared = self.radius * self.radius / self.centre.length_squared();
        squared / (1.0 + (1.0 - squared).max(0.0).sqrt())
    }
}

impl Emitter for SphereEmitter {
    fn faces_origin(&self) -> bool {
        self.radius > 0.0
    }

    fn sample(&self, u: [f64; 2]) -> Option<LightHit> {
        if self.inside() {
            return self.hit(sphere_direction(u));
        }
        let axis = self.centre.try_normalize()?;
        let (x, y) = axis.any_orthonormal_pair();
        let cos = 1.0 - u[0] * self.cap();
        let sin = ((1.0 - cos) * (1.0 + cos)).sqrt();
        let (s, c) = (TAU * u[1]).sin_cos();
        self.hit(axis * cos + (x * c + y * s) * sin)
    }

    fn hit(&self, wi: DVec3) -> Option<LightHit> {
        let along = self.centre.dot(wi);
        let discriminant = self.radius * self.radius - (self.centre - wi * along).length_squared();
        if !(self.faces_origin() && discriminant >= 0.0) {
            return None;
        }
        if self.inside() {
            return Some(LightHit { wi, distance: along + discriminant.sqrt(), pdf: 0.25 / PI });
        }
        let pdf = 1.0 / (TAU * self.cap());
        (along > 0.0).then_some(LightHit { wi, distance: along - discriminant.sqrt(), pdf })
    }
}
