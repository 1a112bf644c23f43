//! A lobe integrated over a cylindrical light.

use std::f64::consts::PI;

use glam::DVec3;

use crate::ellipse::integrate_cut_ellipse;
use crate::error::ReferenceError;
use crate::fan::{allowed, integrate_sectors, sectors_between, sign_changes};
use crate::lobe::Lobe;
use crate::polygon::PolygonOptions;
use crate::quadrature::{Estimate, Tolerance};
use crate::sphere::integrate_sphere;

/// A round cylinder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CylinderShape {
    /// The middles of its ends.
    pub ends: [DVec3; 2],
    /// Its radius.
    pub radius: f64,
    /// Whether it is a closed solid. Without caps the outside of the mantle alone counts.
    pub caps: bool,
}

/// `∫ density(w) dw` over the directions from the origin that hit the outside of the cylinder first.
///
/// From inside a closed cylinder or from its surface that is every direction; from inside a tube none. A radius of 0 or
/// equal ends give 0.
///
/// Method: the visible part of the mantle, `p = end₀ + s (end₁ − end₀) + r m(t)`, has the solid angle
/// `r L (−m·p) / |p|³ ds dt`; for each t the half-spaces of the lobe leave an interval of s. The end that faces the origin
/// is integrated as an ellipse.
///
/// # Errors
/// [`ReferenceError::NonFiniteInput`], [`ReferenceError::NonFiniteIntegrand`], [`ReferenceError::NotConverged`].
pub fn integrate_cylinder(
    lobe: &impl Lobe,
    shape: CylinderShape,
    tolerance: Tolerance,
) -> Result<Estimate, ReferenceError> {
    let CylinderShape { ends, radius, caps } = shape;
    if !(ends.iter().all(|p| p.is_finite()) && radius.is_finite()) {
        return Err(ReferenceError::NonFiniteInput { what: "cylinder" });
    }
    let extent = ends.iter().fold(radius, |m, p| m.max(p.abs().max_element()));
    let shape = CylinderShape { ends: ends.map(|p| p / extent), radius: radius / extent, caps };
    let Some(axis) = (ends[1] - ends[0]).try_normalize().filter(|_| radius > 0.0) else {
        return Ok(Estimate::default());
    };
    let tolerance = Tolerance { absolute: 0.5 * tolerance.absolute, ..tolerance };
    let heights = shape.ends.map(|p| p.dot(axis));
    let distance = axis.cross(shape.ends[0]).length();
    let facing = [heights[0] > 0.0, heights[1] < 0.0];
    let mut total = Estimate::default();
    if distance <= shape.radius && !facing.contains(&true) {
        if caps {
            total = integrate_sphere(|w| lobe.density(w), &lobe.kinks(), &lobe.hints(), tolerance)?;
        }
        return Ok(total);
    }
    if distance > shape.radius {
        total = integrate_mantle(lobe, &shape, axis, tolerance)?;
    }
    for (end, faces) in shape.ends.into_iter().zip(facing) {
        if caps && faces {
            let (x, y) = axis.any_orthonormal_pair();
            let ellipse = [end, x * shape.radius, y * shape.radius];
            let options = PolygonOptions { two_sided: true, tolerance };
            let cap = integrate_cut_ellipse(lobe, ellipse, &lobe.half_spaces(), options)?;
            total.value += cap.value;
            total.error += cap.error;
            total.evaluations += cap.evaluations;
        }
    }
    Ok(total)
}

/// The mantle, seen from outside its infinite continuation.
fn integrate_mantle(
    lobe: &impl Lobe,
    shape: &CylinderShape,
    axis: DVec3,
    tolerance: Tolerance,
) -> Result<Estimate, ReferenceError> {
    let (start, radius) = (shape.ends[0], shape.radius);
    let along = shape.ends[1] - start;
    let x = (start - axis * start.dot(axis)).normalize_or(DVec3::X);
    let y = axis.cross(x);
    let distance = x.dot(start);
    let outward = |t: f64| x * t.cos() + y * t.sin();
    let point = |t: f64, s: f64| start + along * s + radius * outward(t);
    let half_spaces = lobe.half_spaces();
    let bounds = |t: f64| {
        let foot = start + radius * outward(t);
        allowed(half_spaces.iter().map(|n| (n.dot(foot), n.dot(along))))
    };
    // Seen where −m·p > 0: cos t < −r/D.
    let half = PI - (-radius / distance).acos();
    let mut angles = Vec::new();
    for (i, n) in half_spaces.iter().enumerate() {
        for end in shape.ends {
            angles.extend(sign_changes(n.dot(end), radius * n.dot(x), radius * n.dot(y)));
        }
        for m in &half_spaces[..i] {
            let common = n.cross(*m);
            angles.extend([common, -common].iter().filter_map(|&w| hit(w, x, y, distance, radius)));
        }
    }
    let sectors = sectors_between(angles, PI - half, PI + half);
    let length = along.length();
    let place = |w: DVec3| {
        let t = hit(w, x, y, distance, radius).unwrap_or(if w.dot(y) > 0.0 { PI - half } else { PI + half });
        // Where the ray is nearest to the generator at t, measured in the axis' plane.
        let foot = start + radius * outward(t);
        let flat = w - axis * w.dot(axis);
        let reach = flat.dot(foot) / flat.length_squared();
        [t, (reach * w.dot(axis) - start.dot(axis)) / length]
    };
    let mut seeds: Vec<[f64; 2]> = lobe.hints().into_iter().map(place).collect();
    let (gap, nearest) = (distance - radius, -start.dot(axis) / length);
    let spread = [(gap / radius).min(half), gap / length];
    seeds.extend(
        [[0.0, 0.0], [1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]]
            .map(|[a, b]| [PI + 0.5 * a * spread[0], nearest.clamp(0.0, 1.0) + 0.5 * b * spread[1]]),
    );
    seeds.retain(|p| p.iter().all(|x| x.is_finite()));
    let integrand = |t: f64, s: f64| {
        let p = point(t, s);
        let (r, facing) = (p.length(), -outward(t).dot(p));
        if r == 0.0 { 0.0 } else { lobe.density(p / r) * radius * length * facing.max(0.0) / (r * r * r) }
    };
    integrate_sectors(integrand, bounds, &sectors, &seeds, tolerance)
}

/// The angle at which the ray along `w` enters the infinite mantle around `distance · x`.
fn hit(w: DVec3, x: DVec3, y: DVec3, distance: f64, radius: f64) -> Option<f64> {
    let (ahead, aside) = (w.dot(x), w.dot(y));
    let flat = ahead * ahead + aside * aside;
    let root = flat * radius * radius - (distance * aside).powi(2);
    if root < 0.0 || ahead <= 0.0 {
        return None;
    }
    let t = (distance * ahead - root.sqrt()) / flat;
    Some((t * aside).atan2(t * ahead - distance))
}
