//! Flat lights that are no parallelograms.

use core::f64::consts::TAU;

use glam::DVec3;

use super::Emitter;
use crate::error::ReferenceError;
use crate::rect_light::{LightHit, RectLight};

/// An ellipse `centre + axis_u cos t + axis_v sin t`, any two conjugate half-axes; its front is where `axis_u × axis_v` points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EllipseEmitter {
    centre: DVec3,
    axes: [DVec3; 2],
    /// `axis_u × axis_v`: π times its length is the area.
    normal: DVec3,
    two_sided: bool,
}

impl EllipseEmitter {
    /// # Errors
    /// [`ReferenceError::NonFiniteInput`].
    pub fn new(centre: DVec3, axis_u: DVec3, axis_v: DVec3, two_sided: bool) -> Result<Self, ReferenceError> {
        if !(centre.is_finite() && axis_u.is_finite() && axis_v.is_finite()) {
            return Err(ReferenceError::NonFiniteInput { what: "ellipse" });
        }
        Ok(Self { centre, axes: [axis_u, axis_v], normal: axis_u.cross(axis_v), two_sided })
    }

    /// Uniform over the area: `pdf = r² / (A |cos θ_light|)`.
    fn hit_at(&self, point: DVec3) -> Option<LightHit> {
        let distance = point.length();
        let wi = point.try_normalize()?;
        let pdf = distance * distance / (0.5 * TAU * self.normal.dot(wi).abs());
        pdf.is_finite().then_some(LightHit { wi, distance, pdf })
    }
}

impl Emitter for EllipseEmitter {
    fn faces_origin(&self) -> bool {
        let behind = self.normal.dot(self.centre);
        behind < 0.0 || (self.two_sided && behind > 0.0)
    }

    fn sample(&self, u: [f64; 2]) -> Option<LightHit> {
        let (sin, cos) = (TAU * u[1]).sin_cos();
        let point = self.centre + (self.axes[0] * cos + self.axes[1] * sin) * u[0].sqrt();
        if self.faces_origin() { self.hit_at(point) } else { None }
    }

    fn hit(&self, wi: DVec3) -> Option<LightHit> {
        let distance = self.normal.dot(self.centre) / self.normal.dot(wi);
        if !(self.faces_origin() && distance > 0.0 && distance.is_finite()) {
            return None;
        }
        let offset = wi * distance - self.centre;
        let squared = self.normal.length_squared();
        let x = offset.cross(self.axes[1]).dot(self.normal) / squared;
        let y = self.axes[0].cross(offset).dot(self.normal) / squared;
        if x * x + y * y <= 1.0 { self.hit_at(wi * distance) } else { None }
    }
}

/// A flat polygon of any simple outline, counter-clockwise seen from its front. Samples are drawn on a rectangle around it; those
/// outside lead nowhere.
#[derive(Clone, Debug, PartialEq)]
pub struct PolygonEmitter {
    around: RectLight,
    origin: DVec3,
    /// Orthonormal, in the plane.
    axes: [DVec3; 2],
    outline: Vec<[f64; 2]>,
}

impl PolygonEmitter {
    /// `None` for one without area.
    ///
    /// # Errors
    /// [`ReferenceError::NonFiniteInput`].
    pub fn new(vertices: &[DVec3], two_sided: bool) -> Result<Option<Self>, ReferenceError> {
        if !vertices.iter().all(|v| v.is_finite()) {
            return Err(ReferenceError::NonFiniteInput { what: "polygon" });
        }
        let Some(&origin) = vertices.first() else { return Ok(None) };
        let area: DVec3 = vertices.windows(2).map(|e| (e[0] - origin).cross(e[1] - origin)).sum();
        let Some(normal) = area.try_normalize() else { return Ok(None) };
        // Along the longest edge: the rectangle around a thin one is thin.
        let edges = (0..vertices.len()).map(|i| vertices[(i + 1) % vertices.len()] - vertices[i]);
        let longest = edges.fold(DVec3::ZERO, |a, b| if b.length() > a.length() { b } else { a });
        let Some(x) = longest.try_normalize() else { return Ok(None) };
        let y = normal.cross(x);
        let outline: Vec<_> = vertices.iter().map(|v| [(*v - origin).dot(x), (*v - origin).dot(y)]).collect();
        let bound = |axis: usize, pick: fn(f64, f64) -> f64, start: f64| {
            outline.iter().map(|p| p[axis]).fold(start, pick)
        };
        let low = [0, 1].map(|axis| bound(axis, f64::min, f64::INFINITY));
        let high = [0, 1].map(|axis| bound(axis, f64::max, f64::NEG_INFINITY));
        let at = |u: f64, v: f64| origin + x * u + y * v;
        let corners = [at(low[0], low[1]), at(high[0], low[1]), at(high[0], high[1]), at(low[0], high[1])];
        let around = RectLight::new(corners, two_sided)?;
        Ok(Some(Self { around, origin, axes: [x, y], outline }))
    }

    /// By the parity of edges crossed.
    fn contains(&self, point: DVec3) -> bool {
        let [x, y] = self.axes.map(|axis| (point - self.origin).dot(axis));
        let mut inside = false;
        for (i, b) in self.outline.iter().enumerate() {
            let a = self.outline[(i + self.outline.len() - 1) % self.outline.len()];
            let crosses = (a[1] > y) != (b[1] > y);
            if crosses && x < a[0] + (b[0] - a[0]) * (y - a[1]) / (b[1] - a[1]) {
                inside = !inside;
            }
        }
        inside
    }

    fn within(&self, hit: Option<LightHit>) -> Option<LightHit> {
        hit.filter(|hit| self.contains(hit.wi * hit.distance))
    }
}

impl Emitter for PolygonEmitter {
    fn faces_origin(&self) -> bool {
        self.around.faces_origin()
    }

    fn sample(&self, u: [f64; 2]) -> Option<LightHit> {
        self.within(self.around.sample(u))
    }

    fn hit(&self, wi: DVec3) -> Option<LightHit> {
        self.within(self.around.hit(wi))
    }
}
