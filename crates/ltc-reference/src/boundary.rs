//! A second route to an LTC over a polygon: one-dimensional quadrature along the boundary, in cosine space.

use std::f64::consts::PI;

use glam::DVec3;

use crate::error::ReferenceError;
use crate::lobe::LtcLobe;
use crate::polygon::{PolygonOptions, PolygonView};
use crate::quadrature::{Estimate, Tolerance, integrate_1d};
use crate::sphere::clip;

/// What [`crate::integrate_polygon`] gives for an LTC, by another way.
///
/// The polygon is taken to cosine space by `M⁻¹`, clipped at `z > 0` (with `above_horizon` also at the surface's horizon
/// before that), and Stokes turns the integral of `cos θ / π` into one over the boundary:
/// `(1 / 2π) ∮ sin² θ dφ`. Along the edge from a to b, `sin² θ dφ = (a × b)_z / |p(t)|² dt`, which is integrated
/// numerically after the substitution `t = t₀ + (d / L) sinh s` around the edge's point nearest to the origin (distance
/// d, length L).
///
/// # Errors
/// As [`crate::integrate_polygon`].
pub fn integrate_polygon_boundary(
    lobe: &LtcLobe,
    above_horizon: bool,
    vertices: &[DVec3],
    options: PolygonOptions,
) -> Result<Estimate, ReferenceError> {
    let Some(view) = PolygonView::new(vertices, options.two_sided)? else {
        return Ok(Estimate::default());
    };
    let surface = if above_horizon { clip(&view.vertices, DVec3::Z) } else { view.vertices };
    let cosine_space: Vec<DVec3> = surface.iter().map(|&v| lobe.cosine_from_target() * v).collect();
    let polygon = clip(&cosine_space, DVec3::Z);
    let edges = polygon.len().max(1) as f64;
    let tolerance = Tolerance { absolute: options.tolerance.absolute / edges, ..options.tolerance };
    let mut total = Estimate::default();
    for (i, &a) in polygon.iter().enumerate() {
        let edge = edge_integral(a, polygon[(i + 1) % polygon.len()], tolerance)?;
        total.value += edge.value;
        total.error += edge.error;
        total.evaluations += edge.evaluations;
    }
    total.value *= view.sign * lobe.cosine_from_target().determinant().signum();
    Ok(total)
}

/// `(1 / 2π) ∫ sin² θ dφ` along the straight edge from a to b; 0 for an edge in line with the origin.
fn edge_integral(a: DVec3, b: DVec3, tolerance: Tolerance) -> Result<Estimate, ReferenceError> {
    // Only directions matter, and unit vectors make the edge well conditioned.
    let (Some(a), Some(b)) = (a.try_normalize(), b.try_normalize()) else {
        return Ok(Estimate::default());
    };
    let cross = a.cross(b);
    let length = (b - a).length();
    let distance = cross.length() / length;
    if length == 0.0 || distance == 0.0 {
        return Ok(Estimate::default());
    }
    let nearest = -a.dot(b - a) / length;
    let (s0, s1) = ((-nearest / distance).asinh(), ((length - nearest) / distance).asinh());
    let factor = cross.z / (2.0 * PI * length);
    let integrand = |s: f64| {
        let along = distance * s.sinh();
        factor * distance * s.cosh() / (distance * distance + along * along)
    };
    integrate_1d(integrand, s0, s1, tolerance)
}
