//! A lobe integrated over an elliptical light.

use glam::DVec3;

use crate::error::ReferenceError;
use crate::fan::{Fan, integrate_sectors};
use crate::lobe::Lobe;
use crate::polygon::PolygonOptions;
use crate::quadrature::Estimate;

/// Below this fraction of the extent the origin counts as lying in the plane.
const IN_PLANE: f64 = 1e-14;

/// `∫ density(w) dw` over the directions from the origin that hit the ellipse `centre + axis_u cos t + axis_v sin t`.
///
/// The axes are any two conjugate half-axes; the emitting side is the one that `axis_u × axis_v` points to. Seen from behind, a
/// one-sided ellipse gives 0, as does one without area or with the origin in its plane (to 1e-14 of its extent).
///
/// Method: polar coordinates on the light itself. With `p = centre + s (axis_u cos t + axis_v sin t)` the solid angle is
/// `|det(centre, axis_u, axis_v)| s / |p|³ ds dt`. For each t the half-spaces of the lobe leave an interval of s; the turn is
/// cut where that interval changes its formula, so that the cubature sees smooth integrands alone.
///
/// # Errors
/// [`ReferenceError::NonFiniteInput`], [`ReferenceError::NonFiniteIntegrand`], [`ReferenceError::NotConverged`].
pub fn integrate_ellipse(
    lobe: &impl Lobe,
    centre: DVec3,
    axis_u: DVec3,
    axis_v: DVec3,
    options: PolygonOptions,
) -> Result<Estimate, ReferenceError> {
    let vectors = [centre, axis_u, axis_v];
    if !vectors.iter().all(|v| v.is_finite()) {
        return Err(ReferenceError::NonFiniteInput { what: "ellipse" });
    }
    let extent = vectors.iter().fold(0.0f64, |m, v| m.max(v.abs().max_element()));
    if extent == 0.0 {
        return Ok(Estimate::default());
    }
    let [centre, u, v] = vectors.map(|v| v / extent);
    let Some(normal) = u.cross(v).try_normalize() else { return Ok(Estimate::default()) };
    let behind = normal.dot(centre);
    if behind.abs() <= IN_PLANE || (behind > 0.0 && !options.two_sided) {
        return Ok(Estimate::default());
    }
    integrate_cut_ellipse(lobe, [centre, u, v], &lobe.half_spaces(), options)
}

/// The same, cut by any half-spaces, from either side and however near the plane is.
pub(crate) fn integrate_cut_ellipse(
    lobe: &impl Lobe,
    [centre, u, v]: [DVec3; 3],
    half_spaces: &[DVec3],
    options: PolygonOptions,
) -> Result<Estimate, ReferenceError> {
    let fan = Fan { centre, u, v, half_spaces };
    let volume = u.cross(v).dot(centre).abs();
    let integrand = |t: f64, s: f64| {
        let p = fan.point(t, s);
        let length = p.length();
        if length == 0.0 { 0.0 } else { lobe.density(p / length) * volume * s / (length * length * length) }
    };
    integrate_sectors(integrand, |t| fan.bounds(t), &fan.sectors(), &fan.seeds(lobe), options.tolerance)
}
