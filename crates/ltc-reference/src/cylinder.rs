//! A lobe integrated over a cylindrical light.

use glam::DVec3;

use crate::ellipse::integrate_cut_ellipse;
use crate::error::ReferenceError;
use crate::fan::{Sector, Sectors, Spread, allowed, sectors_between, sign_changes};
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
struct Mantle<'a> {
    /// Along the axis, towards it, and at right angles to both.
    axis: DVec3,
    x: DVec3,
    y: DVec3,
    radius: f64,
    /// Distance of the axis, less the radius.
    gap: f64,
    half_spaces: &'a [DVec3],
}

/// The part of a mantle between two heights along the axis.
struct Ring<'a> {
    mantle: &'a Mantle<'a>,
    from: f64,
    to: f64,
}

fn integrate_mantle(
    lobe: &impl Lobe,
    shape: &CylinderShape,
    axis: DVec3,
    tolerance: Tolerance,
) -> Result<Estimate, ReferenceError> {
    let start = shape.ends[0];
    let flat = start - axis * start.dot(axis);
    let x = flat.normalize_or(DVec3::X);
    let half_spaces = lobe.half_spaces();
    let (radius, gap) = (shape.radius, flat.length() - shape.radius);
    let mantle = Mantle { axis, x, y: axis.cross(x), radius, gap, half_spaces: &half_spaces };
    let [low, high] = shape.ends.map(|p| p.dot(axis));
    // Each part starts where it is nearest to the origin: heights near there do not lose their digits.
    let rings = match (low >= 0.0, high <= 0.0) {
        (true, _) => vec![[low, high]],
        (_, true) => vec![[high, low]],
        _ => vec![[0.0, low], [0.0, high]],
    };
    let tolerance = Tolerance { absolute: tolerance.absolute / rings.len() as f64, ..tolerance };
    let mut total = Estimate::default();
    for [from, to] in rings {
        let part = Ring { mantle: &mantle, from, to }.integrate(lobe, tolerance)?;
        total.value += part.value;
        total.error += part.error;
        total.evaluations += part.evaluations;
    }
    Ok(total)
}

impl Mantle<'_> {
    /// The point at height 0 there: from the origin, without cancellation near t = 0.
    fn foot(&self, t: f64) -> DVec3 {
        let sink = 2.0 * (0.5 * t).sin().powi(2);
        self.x * (self.gap + self.radius * sink) + self.y * (self.radius * t.sin())
    }

    /// How far the plane tangent at t is from the origin.
    fn facing(&self, t: f64) -> f64 {
        self.gap - (self.gap + self.radius) * 2.0 * (0.5 * t).sin().powi(2)
    }

    /// The mantle is seen for |t| up to this: where `cos t = radius / distance`.
    fn half_angle(&self) -> f64 {
        (self.gap * (self.gap + 2.0 * self.radius)).sqrt().atan2(self.radius)
    }

    /// The angle at which the ray along `w` enters the infinite mantle.
    fn hit(&self, w: DVec3) -> Option<f64> {
        let (ahead, aside, distance) = (w.dot(self.x), w.dot(self.y), self.gap + self.radius);
        let flat = ahead * ahead + aside * aside;
        let root = flat * self.radius * self.radius - (distance * aside).powi(2);
        if root < 0.0 || ahead <= 0.0 {
            return None;
        }
        let reach = (distance * ahead - root.sqrt()) / flat;
        Some((reach * aside).atan2(distance - reach * ahead))
    }
}

impl Ring<'_> {
    fn length(&self) -> f64 {
        self.to - self.from
    }

    fn integrate(&self, lobe: &impl Lobe, tolerance: Tolerance) -> Result<Estimate, ReferenceError> {
        let Mantle { axis, radius, half_spaces, .. } = *self.mantle;
        let integrand = |t: f64, s: f64| {
            let p = self.mantle.foot(t) + axis * (self.from + s * self.length());
            let (r, facing) = (p.length(), self.mantle.facing(t).max(0.0));
            let area = radius * self.length().abs();
            if r == 0.0 { 0.0 } else { lobe.density(p / r) * area * facing / (r * r * r) }
        };
        let bounds = |t: f64| {
            let foot = self.mantle.foot(t) + axis * self.from;
            allowed(half_spaces.iter().map(|n| (n.dot(foot), n.dot(axis) * self.length())))
        };
        let nearest = self.mantle.gap.hypot(self.from);
        Sectors {
            f: integrand,
            bounds,
            sectors: &self.sectors(),
            seeds: &self.seeds(lobe),
            spread_t: Spread::new(nearest / radius),
            spread_s: |_| Spread::new(nearest / self.length().abs()),
        }
        .integrate(tolerance)
    }

    /// Cut where a plane crosses an end circle, and where two planes meet on the mantle.
    fn sectors(&self) -> Vec<Sector> {
        let Mantle { axis, x, y, radius, gap, half_spaces } = *self.mantle;
        let mut angles = Vec::new();
        for (i, n) in half_spaces.iter().enumerate() {
            for height in [self.from, self.to] {
                let centre = n.dot(x) * (gap + radius) + n.dot(axis) * height;
                angles.extend(sign_changes(centre, -radius * n.dot(x), radius * n.dot(y)));
            }
            for m in &half_spaces[..i] {
                let common = n.cross(*m);
                angles.extend([common, -common].iter().filter_map(|&w| self.mantle.hit(w)));
            }
        }
        let half = self.mantle.half_angle();
        sectors_between(angles, -half, half)
    }

    /// Where the lobe's hints hit or pass by, and around the nearest point, spaced by the distance there.
    fn seeds(&self, lobe: &impl Lobe) -> Vec<[f64; 2]> {
        let Mantle { axis, y, radius, gap, .. } = *self.mantle;
        let half = self.mantle.half_angle();
        let place = |w: DVec3| {
            let t = self.mantle.hit(w).unwrap_or(half.copysign(w.dot(y)));
            let flat = w - axis * w.dot(axis);
            let reach = flat.dot(self.mantle.foot(t)) / flat.length_squared();
            [t, (reach * w.dot(axis) - self.from) / self.length()]
        };
        let near = [[0.0, 0.0], [1.0, 0.0], [-1.0, 0.0], [0.0, 1.0]];
        let spread = [0.5 * (gap / radius).min(half), 0.5 * gap / self.length().abs()];
        let mut seeds: Vec<[f64; 2]> = lobe.hints().into_iter().map(place).collect();
        seeds.extend(near.map(|[a, b]| [a * spread[0], b * spread[1]]));
        seeds.retain(|p| p.iter().all(|x| x.is_finite()));
        seeds
    }
}
