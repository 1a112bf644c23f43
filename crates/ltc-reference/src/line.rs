//! A lobe integrated over lines and thin cylinders: the defining integrals of Heitz and Hill 2017, by quadrature.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;

use crate::error::ReferenceError;
use crate::lobe::Lobe;
use crate::quadrature::{Estimate, Tolerance};
use crate::ruling::{Along, sweep};

/// A cylinder around the axis from `p0` to `p1`, seen from the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinCylinder {
    /// One end of the axis.
    pub p0: DVec3,
    /// The other end of the axis.
    pub p1: DVec3,
    /// Radius; 0 or less emits nothing.
    pub radius: f64,
}

impl ThinCylinder {
    /// `None` for what has no surface.
    fn check(&self) -> Result<Option<DVec3>, ReferenceError> {
        if !(self.p0.is_finite() && self.p1.is_finite() && self.radius.is_finite()) {
            return Err(ReferenceError::NonFiniteInput { what: "cylinder" });
        }
        Ok((self.p1 - self.p0).try_normalize().filter(|_| self.radius > 0.0))
    }
}

/// `R · I_line` (eq. 1.6 and 1.10): the line integral that stands for a thin cylinder's wall, not clamped to 1.
///
/// `I_line = ∫ D(ω_p) 2 ‖ω_p × ω_t‖ / ‖p‖² dl`, one-dimensional quadrature. 0 for a line on a ray from the origin.
///
/// # Errors
/// [`ReferenceError::NonFiniteInput`], [`ReferenceError::NonFiniteIntegrand`], [`ReferenceError::NotConverged`].
pub fn integrate_line(
    lobe: &impl Lobe,
    light: &ThinCylinder,
    tolerance: Tolerance,
) -> Result<Estimate, ReferenceError> {
    if light.check()?.is_none() {
        return Ok(Estimate::default());
    }
    let factor = 2.0 * light.radius;
    let inner = Tolerance { absolute: tolerance.absolute / factor, ..tolerance };
    let base = Along::new(lobe).integrate(light.p0, light.p1, inner)?;
    Ok(Estimate { value: factor * base.value, error: factor * base.error, ..base })
}

/// The wall of a true cylinder (eq. 1.2 with `max(0, −ω_p · ω_n)` for `|−ω_p · ω_n|`, which would count its far side, too):
/// two-dimensional quadrature over its surface. 0 from inside.
///
/// # Errors
/// As [`integrate_line`].
pub fn integrate_cylinder_wall(
    lobe: &impl Lobe,
    light: &ThinCylinder,
    tolerance: Tolerance,
) -> Result<Estimate, ReferenceError> {
    let Some(axis) = light.check()? else { return Ok(Estimate::default()) };
    let foot = light.p0 - axis * light.p0.dot(axis);
    let distance = foot.length();
    if distance <= light.radius {
        return Ok(Estimate::default());
    }
    let towards_origin = -foot / distance;
    let side = axis.cross(towards_origin);
    let along = Along::new(lobe);
    // Rulings whose normal is up to this angle from the direction to the origin show their front.
    let half_arc = (light.radius / distance).acos();
    sweep(&along, [-half_arc, half_arc], tolerance, |phi| {
        let normal = towards_origin * phi.cos() + side * phi.sin();
        let offset = light.radius * normal;
        // −p·ω_n and the ruling's own distance, both constant along it.
        let front = (distance * phi.cos() - light.radius).max(0.0);
        let ruling = (foot + offset).length();
        (light.radius * front / ruling, [light.p0 + offset, light.p1 + offset])
    })
}

/// One end cap of a cylinder, a disk at `centre` that emits against `inward` (eq. 1.29, with `max(0, ω_p · ω_t)` for
/// `|ω_p · ω_t|`: it is one-sided): two-dimensional quadrature over its surface.
///
/// # Errors
/// As [`integrate_line`].
pub fn integrate_cap(
    lobe: &impl Lobe,
    centre: DVec3,
    inward: DVec3,
    radius: f64,
    tolerance: Tolerance,
) -> Result<Estimate, ReferenceError> {
    if !(centre.is_finite() && inward.is_finite() && radius.is_finite()) {
        return Err(ReferenceError::NonFiniteInput { what: "end cap" });
    }
    let Some(axis) = inward.try_normalize() else { return Ok(Estimate::default()) };
    let height = centre.dot(axis);
    if height <= 0.0 || radius <= 0.0 {
        return Ok(Estimate::default());
    }
    let (e1, e2) = axis.any_orthonormal_pair();
    let along = Along::new(lobe);
    // Parallel chords at x = R sin ψ.
    sweep(&along, [-FRAC_PI_2, FRAC_PI_2], tolerance, |psi| {
        let middle = centre + e1 * (radius * psi.sin());
        let half = e2 * (radius * psi.cos());
        let chord = (middle - e2 * middle.dot(e2)).length();
        (radius * psi.cos() * height / chord, [middle - half, middle + half])
    })
}

/// Eq. 1.33: a cap as a point, `π R² D(ω_p) max(0, ω_p · ω_t) / ‖p‖²`.
pub fn point_cap(lobe: &impl Lobe, centre: DVec3, inward: DVec3, radius: f64) -> f64 {
    let (Some(w), Some(axis)) = (centre.try_normalize(), inward.try_normalize()) else { return 0.0 };
    PI * radius * radius * lobe.density(w) * w.dot(axis).max(0.0) / centre.length_squared()
}
