//! A lobe integrated over a thin rectangle: as a line and as the rectangle it is.

use glam::DVec3;

use crate::error::ReferenceError;
use crate::lobe::Lobe;
use crate::quadrature::{Estimate, Tolerance};
use crate::ruling::{Along, sweep};

/// A rectangle around the middle line from `p0` to `p1`, seen from the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinStrip {
    /// One end of the middle line.
    pub p0: DVec3,
    /// The other end of the middle line.
    pub p1: DVec3,
    /// Width from edge to edge; 0 or less emits nothing.
    pub width: f64,
    /// Normal of the emitting side, at right angles to the line; any length.
    pub normal: DVec3,
    /// Does the back emit, too?
    pub two_sided: bool,
}

/// The strip as the origin sees it.
struct View {
    normal: DVec3,
    across: DVec3,
    /// Distance of the origin from the strip's plane.
    height: f64,
}

impl ThinStrip {
    fn view(&self) -> Result<Option<View>, ReferenceError> {
        if !(self.p0.is_finite() && self.p1.is_finite() && self.normal.is_finite() && self.width.is_finite())
        {
            return Err(ReferenceError::NonFiniteInput { what: "strip" });
        }
        let (Some(along), Some(normal)) = ((self.p1 - self.p0).try_normalize(), self.normal.try_normalize())
        else {
            return Ok(None);
        };
        let front = -normal.dot(self.p0);
        let height = if self.two_sided { front.abs() } else { front };
        let view = View { normal, across: normal.cross(along), height };
        Ok((height > 0.0 && self.width > 0.0).then_some(view))
    }
}

/// The strip as a line (eq. 1.35 with the factor that it should have, and w/2 for the cylinder's R): `w ∫ D(ω_p)
/// |ω_p · ω_n| / ‖p‖² dl`, one-dimensional quadrature, not clamped to 1.
///
/// # Errors
/// As [`crate::integrate_line`].
pub fn integrate_strip_line(
    lobe: &impl Lobe,
    light: &ThinStrip,
    tolerance: Tolerance,
) -> Result<Estimate, ReferenceError> {
    let Some(View { height, .. }) = light.view()? else { return Ok(Estimate::default()) };
    let axis = (light.p1 - light.p0).normalize_or_zero();
    let distance = (light.p0 - axis * light.p0.dot(axis)).length();
    if distance == 0.0 {
        return Ok(Estimate::default());
    }
    let factor = light.width * height / distance;
    let inner = Tolerance { absolute: tolerance.absolute / factor, ..tolerance };
    let base = Along::new(lobe).integrate(light.p0, light.p1, inner)?;
    Ok(Estimate { value: factor * base.value, error: factor * base.error, ..base })
}

/// The strip as the rectangle that it is: two-dimensional quadrature over its surface.
///
/// # Errors
/// As [`crate::integrate_line`].
pub fn integrate_strip_area(
    lobe: &impl Lobe,
    light: &ThinStrip,
    tolerance: Tolerance,
) -> Result<Estimate, ReferenceError> {
    let Some(View { normal, across, height }) = light.view()? else { return Ok(Estimate::default()) };
    let axis = across.cross(normal);
    let along = Along::new(lobe);
    sweep(&along, [-0.5 * light.width, 0.5 * light.width], tolerance, |x| {
        let (a, b) = (light.p0 + across * x, light.p1 + across * x);
        let distance = (a - axis * a.dot(axis)).length();
        (if distance > 0.0 { height / distance } else { 0.0 }, [a, b])
    })
}
