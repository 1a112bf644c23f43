//! Polygonal lights: the fraction of a lobe that sees the polygon, in closed form.

use super::boundary::{BoundarySum, fraction_from_boundary, power_of_two_near_reciprocal, widen};
use super::{Horizon, Light, Sides};
use crate::{InputError, Ltc, Real, Vector};
use glam::DVec3;

/// A flat polygonal light, its vertices given relative to the shading point in the shading frame.
///
/// Any simple polygon of three or more vertices, convex or not. Vertices run counter-clockwise seen from the emitting
/// side. It emits the same radiance in all directions.
///
/// # Precision
/// Both precisions compute in `f64`, where products of `f32` are exact; only the angles of an `f32` light are as short as
/// its result (to 2.4e-9). Against the oracle `f64` is within 1e-9, mostly 1e-13. Against `f64` on the same inputs `f32` is
/// within 2e-5, times cond(M)/100 where that is above 1, over scales of 1e±6, widths of lobes from 1e-4, 89.99° off the
/// normal, aspects of 1e5, 1e-7 of the light's size off its plane, and 1e±3 of its size away (a tenth of that is measured;
/// `tests/polygon_precision.rs`). Rounding the inputs to `f32` costs as much again, more at grazing angles, and near the
/// light's plane all there is: it moves the point to the other side.
///
/// # Continuity
/// A light that sinks below the surface goes out without a jump. A point that crosses the light's plane inside its outline
/// sees half of all directions before and the other half after: of the lobe the two parts that sum to 1. Just in the plane,
/// within 8 ε of `f64`, a light is seen edge-on and dark.
#[derive(Clone, Copy, Debug)]
pub struct Polygon<'a, R: Real> {
    vertices: &'a [R::Vec3],
    sides: Sides,
}

impl<'a, R: Real> Polygon<'a, R> {
    /// # Errors
    /// [`InputError::TooFewVertices`] below three, [`InputError::NotFinite`] for a NaN or infinite coordinate.
    pub fn new(vertices: &'a [R::Vec3], sides: Sides) -> Result<Self, InputError> {
        if vertices.len() < 3 {
            return Err(InputError::TooFewVertices { count: vertices.len() });
        }
        if !vertices.iter().all(|v| v.is_finite()) {
            return Err(InputError::NotFinite { name: "vertex" });
        }
        Ok(Self { vertices, sides })
    }

    /// Four vertices, known to be finite.
    pub(super) fn of_quad(vertices: &'a [R::Vec3; 4], sides: Sides) -> Self {
        Self { vertices, sides }
    }

    /// Its vertices.
    pub fn vertices(&self) -> &'a [R::Vec3] {
        self.vertices
    }

    /// Which sides emit.
    pub fn sides(&self) -> Sides {
        self.sides
    }

    /// Proportional to the distance of the shading point in front of the light's plane (negative: behind it), and exactly
    /// 0 where `f64` rounding decides the side: within 8 ε of the farthest vertex's distance. Also 0 for a light without
    /// area: narrower than the same.
    ///
    /// Newell's vector area, taken about the first vertex so that distant lights keep their digits.
    fn facing(&self) -> f64 {
        let scale = self.vertices.iter().fold(0.0, |m: f64, v| m.max(v.max_abs().to_f64()));
        let shrink = power_of_two_near_reciprocal(scale);
        let first = widen::<R>(self.vertices[0]) * shrink;
        let (mut area, mut extent) = (DVec3::ZERO, 0.0_f64);
        let mut previous = widen::<R>(self.vertices[1]) * shrink - first;
        for vertex in &self.vertices[2..] {
            let next = widen::<R>(*vertex) * shrink - first;
            extent = extent.max(previous.abs().max_element()).max(next.abs().max_element());
            area += previous.cross(next);
            previous = next;
        }
        let (facing, size) = (-area.dot(first), area.length());
        let rounding = 8.0 * f64::EPSILON * scale * shrink;
        if facing.abs() <= rounding * size || size <= rounding * extent { 0.0 } else { facing }
    }

    /// Whether the light is seen, and if so from which side: +1 winds negatively.
    pub(super) fn orientation(&self) -> Option<R> {
        let facing = self.facing();
        let visible = match self.sides {
            Sides::One => facing > 0.0,
            Sides::Two => facing != 0.0,
        };
        visible.then_some(if facing > 0.0 { -R::ONE } else { R::ONE })
    }
}

impl<R: Real> Light<R> for Polygon<'_, R> {
    /// Exact (2016 paper, eq. 3 and 11) and free of leaks: what lies below the surface's horizon (z ≤ 0 in the shading
    /// frame) is cut away before the vertices go to cosine space, what lies below the horizon there afterwards. Zero
    /// for a degenerate light, for a shading point in the light's plane, and for one behind a one-sided light.
    fn integrate_within(&self, ltc: &Ltc<R>, horizon: Horizon) -> R {
        let Some(orientation) = self.orientation() else { return R::ZERO };
        let mut sum = BoundarySum::new(ltc.cosine_from_target(), horizon);
        self.vertices.iter().for_each(|v| sum.push(*v));
        let sum = orientation * sum.finish();
        if horizon.cosine {
            fraction_from_boundary(sum)
        } else {
            // Signed: nothing jumps at the nadir.
            (sum / (R::of(2.0) * R::PI)).clamped(R::ZERO, R::ONE)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Matrix as _;
    use crate::testing::{r2, random};
    use glam::{DMat3, DVec3, Vec3};

    fn fraction(vertices: &[DVec3], ltc: &Ltc<f64>) -> f64 {
        Polygon::new(vertices, Sides::One).unwrap().integrate(ltc)
    }

    /// A square of half-width `h` at height `z`, centred above (x, y), emitting downwards.
    fn ceiling(x: f64, y: f64, z: f64, h: f64) -> [DVec3; 4] {
        [(-h, -h), (-h, h), (h, h), (h, -h)].map(|(a, b)| DVec3::new(x + a, y + b, z))
    }

    #[test]
    fn form_factor_of_a_parallel_square_is_the_textbook_one() {
        // Differential element below the corner of a parallel rectangle a × b at distance c.
        let corner = |a: f64, b: f64| {
            let (x, y) = ((1.0 + a * a).sqrt(), (1.0 + b * b).sqrt());
            (a / x * (b / x).atan() + b / y * (a / y).atan()) / core::f64::consts::TAU
        };
        for h in [1e-3, 0.1, 1.0, 10.0, 1e3] {
            let value = fraction(&ceiling(0.0, 0.0, 1.0, h), &Ltc::cosine());
            assert!((value - 4.0 * corner(h, h)).abs() < 1e-14, "{h}: {value}");
        }
    }

    #[test]
    fn sides_and_winding() {
        let mut light = ceiling(0.2, 0.1, 1.0, 0.5);
        let front = fraction(&light, &Ltc::cosine());
        assert!(front > 0.1);
        light.reverse();
        assert_eq!(fraction(&light, &Ltc::cosine()), 0.0);
        let two = Polygon::<f64>::new(&light, Sides::Two).unwrap().irradiance();
        assert!((two - front).abs() < 1e-15);
    }

    #[test]
    fn matches_a_count_of_samples_above_both_horizons() {
        let mut rng = random(7);
        let n = 1 << 15;
        for case in 0..60 {
            let mut numbers = [0.0; 9];
            numbers.fill_with(|| rng() * 2.0 - 1.0);
            let Ok(ltc) = Ltc::<f64>::new(DMat3::from_row_array(numbers)) else { continue };
            let centre = DVec3::new(rng() * 4.0 - 2.0, rng() * 4.0 - 2.0, rng() * 4.0 - 2.0);
            let (u, v) =
                (DVec3::new(rng(), rng(), rng()) * 2.0 - 1.0, DVec3::new(rng(), rng(), rng()) * 2.0 - 1.0);
            let quad = [centre - u - v, centre + u - v, centre + u + v, centre - u + v];
            let inside = |w: DVec3| {
                let normal = u.cross(v);
                let t = normal.dot(centre) / normal.dot(w);
                let p = w * t - centre;
                let gram = [u.dot(u), u.dot(v), v.dot(v)];
                let det = gram[0] * gram[2] - gram[1] * gram[1];
                let a = (gram[2] * p.dot(u) - gram[1] * p.dot(v)) / det;
                let b = (gram[0] * p.dot(v) - gram[1] * p.dot(u)) / det;
                t > 0.0 && a.abs() < 1.0 && b.abs() < 1.0 && w.z > 0.0
            };
            let count = (0..n).filter(|i| inside(ltc.sample(r2(*i)))).count() as f64 / n as f64;
            let exact = Polygon::new(&quad, Sides::Two).unwrap().integrate(&ltc);
            assert!((exact - count).abs() < 6e-3, "case {case}: {exact} {count}");
        }
    }

    #[test]
    fn a_light_below_the_horizon_adds_exactly_nothing() {
        let mut rng = random(3);
        for _ in 0..2000 {
            let mut numbers = [0.0; 9];
            numbers.fill_with(|| rng() * 2.0 - 1.0);
            let Ok(ltc) = Ltc::<f64>::new(DMat3::from_row_array(numbers)) else { continue };
            let quad = [0; 4].map(|_| DVec3::new(rng() - 0.5, rng() - 0.5, -rng() - 1e-12));
            assert_eq!(Polygon::new(&quad, Sides::Two).unwrap().integrate(&ltc), 0.0);
        }
    }

    #[test]
    fn a_light_around_the_nadir_of_cosine_space() {
        // The lobe points down (its own horizon cuts the light), the light surrounds its nadir.
        let down = Ltc::<f64>::new(DMat3::from_diagonal(DVec3::new(1.0, -1.0, -1.0))).unwrap();
        assert_eq!(fraction(&ceiling(0.0, 0.0, 1.0, 1.0), &down), 0.0);
        let tilted = Ltc::<f64>::new(DMat3::from_rotation_x(2.0)).unwrap();
        let vast = fraction(&ceiling(0.0, 0.0, 1.0, 1e7), &tilted);
        // The part of the tilted cosine that is above the surface: (1 + cos 2)/2.
        assert!((vast - (1.0 + 2.0_f64.cos()) / 2.0).abs() < 1e-6, "{vast}");
    }

    #[test]
    fn degenerate_lights_are_dark() {
        let ltc = Ltc::<f64>::cosine();
        let p = DVec3::new(0.3, 0.2, 1.0);
        for quad in [
            [p; 4],
            [DVec3::ZERO; 4],
            [p, p * 2.0, p * 3.0, p * 4.0],
            [
                DVec3::new(-1.0, 0.0, 0.5),
                DVec3::new(1.0, 0.0, 0.5),
                DVec3::new(1.0, 0.0, -0.5),
                DVec3::new(-1.0, 0.0, -0.5),
            ],
        ] {
            assert_eq!(Polygon::new(&quad, Sides::Two).unwrap().integrate(&ltc), 0.0, "{quad:?}");
        }
        assert!(Polygon::<f64>::new(&[p, p], Sides::One).is_err());
        assert!(Polygon::<f64>::new(&[p, p, DVec3::NAN], Sides::One).is_err());
    }

    /// A point in the light's plane sees it edge-on. What rounding makes of its side must not show.
    #[test]
    fn a_point_in_the_plane_of_a_tilted_light_is_dark() {
        let mut rng = random(42);
        let mut r = || rng() * 2.0 - 1.0;
        for case in 0..20_000 {
            let Some(u) = DVec3::new(r(), r(), r()).try_unit() else { continue };
            let Some(v) = u.cross(DVec3::new(r(), r(), r())).try_unit() else { continue };
            // Inside, on an edge, on a vertex, on the line of an edge, elsewhere in the plane.
            let (a, b) = (r(), r());
            let centre =
                [u * a + v * b, u + v * b, u + v, u * (3.0 * a) + v, u * (3.0 * a) + v * (3.0 * b)][case % 5];
            let quad = [centre - u - v, centre + u - v, centre + u + v, centre - u + v];
            let rotation = DMat3::from_rotation_x(3.0 * a) * DMat3::from_diagonal(DVec3::new(0.3, 0.2, 1.0));
            let ltc = Ltc::<f64>::new(rotation).unwrap();
            let value = Polygon::new(&quad, Sides::Two).unwrap().integrate(&ltc);
            assert_eq!(value, 0.0, "case {case}: {quad:?}");
        }
    }

    #[test]
    fn single_precision_keeps_up_at_extreme_scales() {
        let light = ceiling(0.1, -0.2, 1.0, 0.5);
        let exact = fraction(&light, &Ltc::cosine());
        for scale in [1e-30_f32, 1e-6, 1.0, 1e6, 1e30] {
            let scaled = light.map(|v| v.as_vec3() * scale);
            let value = Polygon::<f32>::new(&scaled, Sides::One).unwrap().irradiance();
            assert!((f64::from(value) - exact).abs() < 1e-6, "{scale}: {value} {exact}");
        }
        let far = [Vec3::new(1e37, 0.0, 1e37); 3];
        assert_eq!(Polygon::<f32>::new(&far, Sides::Two).unwrap().irradiance(), 0.0);
    }
}
