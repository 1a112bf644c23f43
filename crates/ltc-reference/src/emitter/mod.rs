//! Lights as sampled by the path tracer: each gives directions and says where a direction meets it.

mod cylinder;
mod flat;
mod sphere;

pub use cylinder::CylinderEmitter;
pub use flat::{EllipseEmitter, PolygonEmitter};
pub use sphere::SphereEmitter;

use crate::rect_light::{LightHit, RectLight};

/// A light of constant radiance, seen from the origin of the shading frame.
pub trait Emitter {
    /// Whether it can send anything to the origin.
    fn faces_origin(&self) -> bool;

    /// A direction towards the light from `u` ∈ [0, 1)², with the density that [`Emitter::hit`] has for it; `None` where this
    /// one leads nowhere.
    fn sample(&self, u: [f64; 2]) -> Option<LightHit>;

    /// Where the unit direction `wi` meets an emitting side, if it does.
    fn hit(&self, wi: glam::DVec3) -> Option<LightHit>;
}

impl Emitter for RectLight {
    fn faces_origin(&self) -> bool {
        Self::faces_origin(self)
    }

    fn sample(&self, u: [f64; 2]) -> Option<LightHit> {
        Self::sample(self, u)
    }

    fn hit(&self, wi: glam::DVec3) -> Option<LightHit> {
        Self::hit(self, wi)
    }
}
