//! A rectangular light seen from the origin of the shading frame.

use glam::DVec3;

use crate::error::ReferenceError;

/// Corners may miss a parallelogram by this fraction of its perimeter: room for scenes stored as f32.
const PARALLELOGRAM_SLACK: f64 = 1e-4;

/// A rectangle (or parallelogram) that emits the same radiance in all directions of its front.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RectLight {
    corner: DVec3,
    edge_u: DVec3,
    edge_v: DVec3,
    normal: DVec3,
    /// `dual_u · edge_u = 1`, `dual_u · edge_v = 0`, both in the light's plane.
    dual_u: DVec3,
    dual_v: DVec3,
    area: f64,
    two_sided: bool,
}

/// A direction from the origin that meets a [`RectLight`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightHit {
    /// Unit direction towards the light.
    pub wi: DVec3,
    /// Distance along it.
    pub distance: f64,
    /// Density of `wi`, per steradian, when points are drawn uniformly on the light's area.
    pub pdf: f64,
}

impl RectLight {
    /// The light with these corners, counter-clockwise seen from its front.
    ///
    /// A light without area is valid and is never hit.
    ///
    /// # Errors
    /// [`ReferenceError::NonFiniteInput`]; [`ReferenceError::NotAParallelogram`] when `c0 + c2` misses `c1 + c3` by
    /// more than 1e-4 of the perimeter.
    pub fn new(corners: [DVec3; 4], two_sided: bool) -> Result<Self, ReferenceError> {
        let [c0, c1, c2, c3] = corners;
        let (edge_u, edge_v) = (c1 - c0, c3 - c0);
        let gap = (c0 + c2 - c1 - c3).length();
        let perimeter = 2.0 * (edge_u.length() + edge_v.length());
        if !(gap.is_finite() && perimeter.is_finite()) {
            return Err(ReferenceError::NonFiniteInput { what: "corner of a light" });
        }
        if gap > PARALLELOGRAM_SLACK * perimeter {
            return Err(ReferenceError::NotAParallelogram { gap });
        }
        let cross = edge_u.cross(edge_v);
        let area = cross.length();
        let normal = cross.try_normalize().unwrap_or(DVec3::ZERO);
        let (across_u, across_v) = (edge_v.cross(normal), normal.cross(edge_u));
        let dual =
            |across: DVec3, edge: DVec3| if area > 0.0 { across / across.dot(edge) } else { DVec3::ZERO };
        let (dual_u, dual_v) = (dual(across_u, edge_u), dual(across_v, edge_v));
        Ok(Self { corner: c0, edge_u, edge_v, normal, dual_u, dual_v, area, two_sided })
    }

    /// The corners, counter-clockwise seen from the front.
    pub fn corners(&self) -> [DVec3; 4] {
        let Self { corner, edge_u, edge_v, .. } = *self;
        [corner, corner + edge_u, corner + edge_u + edge_v, corner + edge_v]
    }

    /// Area in squared scene units.
    pub fn area(&self) -> f64 {
        self.area
    }

    /// Does the light send anything to the origin?
    pub fn faces_origin(&self) -> bool {
        let behind = self.normal.dot(self.corner);
        self.area > 0.0 && (behind < 0.0 || (self.two_sided && behind > 0.0))
    }

    /// The light's point at (u, v) ∈ [0, 1)², drawn uniformly by area; `None` if it does not shine at the origin.
    pub fn sample(&self, u: [f64; 2]) -> Option<LightHit> {
        if !self.faces_origin() {
            return None;
        }
        let point = self.corner + u[0] * self.edge_u + u[1] * self.edge_v;
        let distance = point.length();
        let wi = point.try_normalize()?;
        self.hit_at(wi, distance)
    }

    /// Where the unit direction `wi` meets the light, if it does and if the light shines at the origin.
    pub fn hit(&self, wi: DVec3) -> Option<LightHit> {
        if !self.faces_origin() {
            return None;
        }
        let distance = self.normal.dot(self.corner) / self.normal.dot(wi);
        if !(distance > 0.0 && distance.is_finite()) {
            return None;
        }
        let offset = distance * wi - self.corner;
        let inside = |x: f64| (0.0..=1.0).contains(&x);
        if inside(self.dual_u.dot(offset)) && inside(self.dual_v.dot(offset)) {
            self.hit_at(wi, distance)
        } else {
            None
        }
    }

    /// `pdf = r² / (A |cos θ_light|)`.
    fn hit_at(&self, wi: DVec3, distance: f64) -> Option<LightHit> {
        let pdf = distance * distance / (self.area * self.normal.dot(wi).abs());
        pdf.is_finite().then_some(LightHit { wi, distance, pdf })
    }
}
