//! What the back ends have in common.

use glam::{DMat3, DVec3};
use ltc_core::{AnyLight, InputError, ShadingFrame};

use crate::RenderError;
use crate::emitter::Emitter;
use crate::gbuffer::SurfacePoint;

/// A back end that is ready to shade.
pub(crate) trait Shade {
    /// Where it computes, in words.
    fn device(&self) -> String;

    /// How many points it likes to be given at once.
    fn batch(&self) -> usize;

    /// Radiance towards the eye of each point.
    fn shade(&self, points: &[SurfacePoint]) -> Result<Vec<DVec3>, RenderError>;
}

/// A point's shading frame, with the view direction in it.
pub(crate) struct Local {
    frame: ShadingFrame<f64>,
    position: DVec3,
    /// Unit, z ≥ 0.
    pub wo: DVec3,
}

impl Local {
    pub fn of(point: &SurfacePoint) -> Result<Self, InputError> {
        let frame = ShadingFrame::<f64>::new(point.normal, point.tangent)?;
        let wo = frame.shading_from_world(point.wo);
        let above = DVec3::new(wo.x, wo.y, wo.z.max(0.0));
        Ok(Self { frame, position: point.position, wo: above.normalize_or(DVec3::Z) })
    }

    /// A point of the world, seen from here.
    pub fn point(&self, world: DVec3) -> DVec3 {
        self.frame.shading_from_world(world - self.position)
    }

    /// A direction of the world, seen from here.
    pub fn direction(&self, world: DVec3) -> DVec3 {
        self.frame.shading_from_world(world)
    }

    /// A light, seen from here.
    pub fn light(&self, light: &Emitter) -> AnyLight {
        light.moved(|p| self.point(p), |v| self.direction(v))
    }
}

/// Row-major, as tables have it.
pub(crate) fn matrix(m: &[f64; 9]) -> DMat3 {
    DMat3::from_cols_array(m).transpose()
}

pub(crate) fn threads() -> String {
    format!("CPU, f64, {} threads", rayon::current_num_threads())
}
