//! A lobe integrated over an elliptical light.

use glam::DVec3;

use crate::error::ReferenceError;
use crate::fan::{Fan, Sectors, Spread};
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
/// Method: polar coordinates on the light itself, around the foot of the origin's perpendicular or else the centre. With
/// `p = pole + s R(t) (axis_u cos t + axis_v sin t)`, R the way to the rim, the solid angle is
/// `|det(centre, axis_u, axis_v)| s R² / |p|³ ds dt`. For each t the half-spaces of the lobe leave an interval of s; the turn is
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
    let normal = u.cross(v);
    let volume = normal.dot(centre).abs();
    // With the pole at the foot of the perpendicular, points near it do not lose their distance to rounding.
    let foot = normal * (normal.dot(centre) / normal.length_squared());
    let offset = foot - centre;
    let pole =
        [offset.cross(v).dot(normal), u.cross(offset).dot(normal)].map(|x| x / normal.length_squared());
    let inside = pole[0].hypot(pole[1]) < 0.99;
    let (pole, origin) = if inside { (pole, foot) } else { ([0.0; 2], centre) };
    let fan = Fan { pole, origin, u, v, half_spaces };
    let integrand = |t: f64, s: f64| {
        let (p, way) = fan.point(t, s);
        let length = p.length();
        if length == 0.0 {
            return 0.0;
        }
        lobe.density(p / length) * volume * way * fan.reach(t) / (length * length * length)
    };
    Sectors {
        f: integrand,
        bounds: |t| fan.bounds(t),
        sectors: &fan.sectors(),
        seeds: &fan.seeds(lobe),
        spread_t: Spread::new(f64::INFINITY),
        spread_s: |t| fan.spread(t),
    }
    .integrate(options.tolerance)
}
