//! Uniform directions in a spherical triangle.

use glam::DVec3;

use super::solid_angle::{one_and_cosines, sum_of_units};
use crate::Vector as _;

/// The directions that hit a flat triangle.
///
/// Arvo 1995, "Stratified sampling of spherical triangles", rewritten in half angles, where nothing cancels for small
/// triangles: the part of solid angle E beside the edge AB ends at the angle x from A on AC with
/// `tan(x/2) = sin(E/2) / (tan(c/2) sin(α − E/2))`, c the angle from A to B, α the one at A.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SphericalTriangle {
    pub solid_angle: f64,
    a: DVec3,
    b: DVec3,
    /// Unit tangent at A towards C.
    towards_c: DVec3,
    /// `tan` of half the angles from A to B and from A to C.
    tan_half_ab: f64,
    tan_half_ac: f64,
    /// The angle at A.
    alpha: f64,
}

impl SphericalTriangle {
    /// The triangle of these points, whose doubled area is `area2`, in a plane at `height` above the origin. `None` where
    /// nothing is seen of it.
    pub fn new([a, b, c]: [DVec3; 3], area2: f64, height: f64) -> Option<Self> {
        let [ua, ub, uc] = [a.try_unit()?, b.try_unit()?, c.try_unit()?];
        let lengths = a.length() * b.length() * c.length();
        let solid_angle = 2.0 * (height.abs() * area2 / lengths).atan2(one_and_cosines(ua, ub, uc));
        // From differences, so that distant triangles keep their shape.
        let tangent = |to: DVec3| (to - a) - ua * (to - a).dot(ua);
        let (to_b, to_c) = (tangent(b), tangent(c));
        let tan_half = |tangent: DVec3, length: f64, unit: DVec3| {
            2.0 * tangent.length() / (length * sum_of_units(ua, unit).length_squared())
        };
        let triangle = Self {
            solid_angle,
            a: ua,
            b: ub,
            towards_c: to_c.try_unit()?,
            tan_half_ab: tan_half(to_b, b.length(), ub),
            tan_half_ac: tan_half(to_c, c.length(), uc),
            alpha: to_b.cross(to_c).length().atan2(to_b.dot(to_c)),
        };
        (solid_angle > 0.0 && triangle.tan_half_ab > 0.0 && triangle.tan_half_ac > 0.0).then_some(triangle)
    }

    /// A direction, uniform in solid angle, from `u` ∈ [0, 1)².
    pub fn sample(&self, u: [f64; 2]) -> DVec3 {
        let half = 0.5 * u[0] * self.solid_angle;
        let slope = half.sin() / (self.tan_half_ab * (self.alpha - half).sin());
        // Rounding may go past C, where the quotient has its pole.
        let slope = if (0.0..self.tan_half_ac).contains(&slope) { slope } else { self.tan_half_ac };
        let norm = 1.0 + slope * slope;
        let on_ac = self.a * ((1.0 - slope * slope) / norm) + self.towards_c * (2.0 * slope / norm);
        // From B towards that point, uniform in the cosine: sin²(y/2) is u[1] of its largest value.
        let chord = on_ac - self.b;
        let largest = 0.25 * chord.length_squared();
        let sine_squared = u[1] * largest.min(1.0);
        let sine = 2.0 * (sine_squared * (1.0 - sine_squared)).sqrt();
        let Some(tangent) = (chord + self.b * (2.0 * largest)).try_unit() else { return self.b };
        let w = self.b * (1.0 - 2.0 * sine_squared) + tangent * sine;
        w.try_unit().unwrap_or(self.b)
    }
}
