//! A lobe integrated over a spherical light.

use glam::DVec3;

use crate::error::ReferenceError;
use crate::fan::{Fan, Sectors, Spread};
use crate::lobe::Lobe;
use crate::quadrature::{Estimate, Tolerance};
use crate::sphere::integrate_sphere;

/// `∫ density(w) dw` over the directions from the origin that hit the sphere; over all directions from inside or from the
/// surface. A radius of 0 gives 0.
///
/// Method: the sphere fills a cap of half-width σ, `sin σ = radius / |centre|`. Polar coordinates around its middle,
/// `dw = sin θ dθ dφ`; for each φ the half-spaces of the lobe leave an interval of θ.
///
/// # Errors
/// [`ReferenceError::NonFiniteInput`], [`ReferenceError::NonFiniteIntegrand`], [`ReferenceError::NotConverged`].
pub fn integrate_sphere_light(
    lobe: &impl Lobe,
    centre: DVec3,
    radius: f64,
    tolerance: Tolerance,
) -> Result<Estimate, ReferenceError> {
    if !(centre.is_finite() && radius.is_finite()) {
        return Err(ReferenceError::NonFiniteInput { what: "sphere" });
    }
    if radius <= 0.0 {
        return Ok(Estimate::default());
    }
    let extent = centre.abs().max_element().max(radius);
    let (centre, radius) = (centre / extent, radius / extent);
    let distance = centre.length();
    if distance <= radius {
        return integrate_sphere(|w| lobe.density(w), &lobe.kinks(), &lobe.hints(), tolerance);
    }
    let axis = centre / distance;
    // Of the angle σ, which near π/2 is not to be had from its sine.
    let cosine = ((distance - radius) * (distance + radius)).sqrt() / distance;
    let (sigma, tangent) = ((radius / distance).atan2(cosine), radius / distance / cosine);
    let (x, y) = axis.any_orthonormal_pair();
    // The fan over the cap's plane tangent to the unit sphere: s is tan θ over tan σ.
    let half_spaces = lobe.half_spaces();
    let (u, v) = (x * tangent, y * tangent);
    let fan = Fan { pole: [0.0; 2], origin: axis, u, v, half_spaces: &half_spaces };
    let bounds = |phi: f64| {
        let [low, high] = fan.bounds(phi);
        let high = if high >= 1.0 { sigma } else { (high * tangent).atan() };
        [(low * tangent).atan(), high].map(|theta| theta / sigma)
    };
    let integrand = |phi: f64, s: f64| {
        let (sin, cos) = (s * sigma).sin_cos();
        let w = axis * cos + (x * phi.cos() + y * phi.sin()) * sin;
        lobe.density(w) * sin * sigma
    };
    let seeds: Vec<[f64; 2]> =
        fan.seeds(lobe).into_iter().map(|[phi, s]| [phi, (s * tangent).atan() / sigma]).collect();
    Sectors {
        f: integrand,
        bounds,
        sectors: &fan.sectors(),
        seeds: &seeds,
        spread_t: Spread::new(f64::INFINITY),
        spread_s: |_| Spread::new(f64::INFINITY),
    }
    .integrate(tolerance)
}
