//! Sampling polygons.

use core::marker::PhantomData;

use glam::{DVec2, DVec3};

use super::boundary::widen;
use super::plane::Plane;
use super::spherical_triangle::SphericalTriangle;
use super::triangulate::{contains, doubled_area, triangulate};
use super::{LightSample, Polygon, SampleLight};
use crate::{InputError, Real, Vector};

/// Draws directions towards a simple polygon, convex or not, uniformly over its area or over its solid angle.
///
/// The polygon is cut into triangles once, which costs up to O(n³) for n vertices. Horizons do not cut it: directions below
/// the surface are drawn, too. Densities are exact in both ways; that of solid angle is constant over the light.
///
/// ```
/// use glam::DVec3;
/// use ltc_core::{Ltc, Polygon, PolygonSampler, SampleLight, Sides, points::r2};
///
/// // The irradiance of an L-shaped light, by 4096 samples.
/// let light = [(0., 0.), (0., 2.), (1., 2.), (1., 1.), (2., 1.), (2., 0.)].map(|(x, y)| DVec3::new(x, y, 1.0));
/// let light = Polygon::new(&light, Sides::One)?;
/// let sampler = PolygonSampler::by_solid_angle(&light)?;
/// let lambert = Ltc::<f64>::cosine();
/// let samples = (0..4096).filter_map(|i| sampler.sample(r2(i, [0.5, 0.5])));
/// let estimate: f64 = samples.map(|s| lambert.density(s.wi) / s.pdf).sum::<f64>() / 4096.0;
/// assert!((estimate - lambert.integrate_polygon(&light, Default::default())).abs() < 1e-3);
/// # Ok::<(), ltc_core::InputError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PolygonSampler<R: Real> {
    plane: Plane,
    /// Axes of the plane's coordinates.
    axes: [DVec3; 2],
    /// `None` where the polygon is seen edge-on or from behind: nothing is drawn.
    measure: Option<Measure>,
    pieces: Vec<Piece>,
    /// Area in scaled coordinates, or solid angle.
    total: f64,
    precision: PhantomData<R>,
}

/// What samples are uniform in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Measure {
    Area,
    SolidAngle,
}

/// A triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Piece {
    corners: [DVec3; 3],
    /// In the plane's coordinates.
    flat: [DVec2; 3],
    /// Where the triangle is spanned by directions.
    spherical: Option<SphericalTriangle>,
    /// Its part of the total.
    share: f64,
}

impl<R: Real> PolygonSampler<R> {
    /// Uniform over the polygon's area: `pdf = d²/(A |cos θ|)`, unbounded towards grazing directions.
    ///
    /// # Errors
    /// [`InputError::Degenerate`] for a polygon without area or with edges that cross.
    pub fn by_area(polygon: &Polygon<'_, R>) -> Result<Self, InputError> {
        Self::new(polygon, Measure::Area)
    }

    /// Uniform over the polygon's solid angle Ω: `pdf = 1/Ω`.
    ///
    /// # Errors
    /// [`InputError::Degenerate`] for a polygon without area or with edges that cross.
    pub fn by_solid_angle(polygon: &Polygon<'_, R>) -> Result<Self, InputError> {
        Self::new(polygon, Measure::SolidAngle)
    }

    fn new(polygon: &Polygon<'_, R>, measure: Measure) -> Result<Self, InputError> {
        let plane = Plane::of(polygon).ok_or(InputError::Degenerate { name: "polygon" })?;
        let (x, y) = plane.normal.any_orthonormal_pair();
        let vertices: Vec<DVec3> = polygon.vertices().iter().map(|&v| widen::<R>(v) * plane.shrink).collect();
        // About the first vertex, so that distant lights keep their digits.
        let flat: Vec<DVec2> =
            vertices.iter().map(|v| *v - vertices[0]).map(|v| DVec2::new(v.dot(x), v.dot(y))).collect();
        let crossing = InputError::Degenerate { name: "polygon whose edges cross" };
        let triangles = triangulate(&flat).ok_or(crossing)?;
        let pieces: Vec<Piece> = triangles
            .into_iter()
            .filter_map(|t| Piece::new(t.map(|i| vertices[i]), t.map(|i| flat[i]), plane.height, measure))
            .collect();
        let total: f64 = pieces.iter().map(|piece| piece.share).sum();
        let seen = plane.shows(polygon.sides()) && total > 0.0;
        let measure = seen.then_some(measure);
        let origin = plane.normal * plane.height - vertices[0];
        let offset = DVec2::new(origin.dot(x), origin.dot(y));
        let pieces = pieces.into_iter().map(|piece| Piece { flat: piece.flat.map(|p| p - offset), ..piece });
        Ok(Self { plane, axes: [x, y], measure, pieces: pieces.collect(), total, precision: PhantomData })
    }

    /// The light's area in the vertices' units squared, at most [`f64::MAX`], or its solid angle in sr; 0 where it is not to
    /// be seen.
    pub fn total(&self) -> f64 {
        match self.measure {
            None => 0.0,
            Some(Measure::Area) => (self.total / self.plane.shrink / self.plane.shrink).min(f64::MAX),
            Some(Measure::SolidAngle) => self.total,
        }
    }

    /// Where the direction `wi` meets the light's plane, relative to the foot of the shading point, and how far away.
    fn hit(&self, wi: DVec3) -> Option<(DVec2, f64)> {
        let distance = self.plane.height / self.plane.normal.dot(wi);
        let point = DVec2::new(wi.dot(self.axes[0]), wi.dot(self.axes[1])) * distance;
        (distance > 0.0 && point.is_finite()).then_some((point, distance))
    }

    /// Density per solid angle of a point of the light at `distance`, in scaled coordinates.
    fn density(&self, distance: f64) -> f64 {
        match self.measure {
            None => 0.0,
            // |cos θ| = h / d.
            Some(Measure::Area) => distance.powi(3) / (self.total * self.plane.height.abs()),
            Some(Measure::SolidAngle) => 1.0 / self.total,
        }
    }
}

impl Piece {
    /// `None` for a triangle that adds nothing.
    fn new(corners: [DVec3; 3], flat: [DVec2; 3], height: f64, measure: Measure) -> Option<Self> {
        let area2 = doubled_area(flat);
        let spherical = match measure {
            Measure::Area => None,
            Measure::SolidAngle => Some(SphericalTriangle::new(corners, area2, height)?),
        };
        let share = spherical.map_or(0.5 * area2, |s| s.solid_angle);
        (share > 0.0).then_some(Self { corners, flat, spherical, share })
    }

    /// A direction that hits the triangle.
    fn sample(&self, u: [f64; 2]) -> Option<DVec3> {
        if let Some(spherical) = self.spherical {
            return Some(spherical.sample(u));
        }
        let [a, b, c] = self.corners;
        let s = u[0].sqrt();
        (a + ((b - a) * (1.0 - u[1]) + (c - a) * u[1]) * s).try_unit()
    }
}

impl<R: Real> SampleLight<R> for PolygonSampler<R> {
    fn sample(&self, u: [R; 2]) -> Option<LightSample<R>> {
        self.measure?;
        let mut left = u[0].to_f64().clamp(0.0, 1.0) * self.total;
        let mut chosen = (self.pieces.first()?, 0.0);
        // What is left of u[0] beside the shares before draws within the triangle: stratified points stay so.
        for piece in &self.pieces {
            chosen = (piece, (left / piece.share).clamp(0.0, 1.0 - f64::EPSILON));
            if left < piece.share {
                break;
            }
            left -= piece.share;
        }
        let (piece, rescaled) = chosen;
        let wi = piece.sample([rescaled, u[1].to_f64().clamp(0.0, 1.0)])?;
        let (_, distance) = self.hit(wi)?;
        let wi = R::Vec3::new(R::of(wi.x), R::of(wi.y), R::of(wi.z));
        let (pdf, distance) = (R::of(self.density(distance)), R::of(distance / self.plane.shrink));
        (pdf.is_finite() && distance.is_finite()).then_some(LightSample { wi, distance, pdf })
    }

    fn pdf(&self, wi: R::Vec3) -> R {
        let Some((point, distance)) = self.hit(widen::<R>(wi)) else { return R::ZERO };
        let on_light = self.pieces.iter().any(|piece| contains(piece.flat, point));
        let density = if on_light { R::of(self.density(distance)) } else { R::ZERO };
        if density.is_finite() { density } else { R::ZERO }
    }
}

/// Uniform over the area, for one sample or two: every call cuts the polygon anew. [`PolygonSampler`] does so once. Nothing
/// is drawn of a polygon without area or with edges that cross.
impl<R: Real> SampleLight<R> for Polygon<'_, R> {
    fn sample(&self, u: [R; 2]) -> Option<LightSample<R>> {
        PolygonSampler::by_area(self).ok()?.sample(u)
    }

    fn pdf(&self, wi: R::Vec3) -> R {
        PolygonSampler::by_area(self).map_or(R::ZERO, |sampler| sampler.pdf(wi))
    }
}
