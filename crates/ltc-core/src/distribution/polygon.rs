//! The transformed polygon on the sphere: its solid angle and its axial boundary term.

use super::{Base, LinearlyTransformed};
use crate::light::Plane;
use crate::{Horizon, Matrix, Polygon, Real, Vector};

/// What the closed forms of the bases are made of, for the polygon in the base's space, wound positively.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Region<R> {
    /// In sr.
    pub solid_angle: R,
    /// `Σ (a + b)_z (a × b)_z / (1 + a·b)` over the edges from a to b, unit vectors.
    pub axial_boundary: R,
}

impl<R: Real> Region<R> {
    /// The region of `polygon` cut by the horizons asked for; nothing where the polygon is not to be seen.
    pub fn of<B: Base<R>>(
        distribution: &LinearlyTransformed<R, B>,
        polygon: &Polygon<'_, R>,
        horizon: Horizon,
    ) -> Self {
        let nothing = Self { solid_angle: R::ZERO, axial_boundary: R::ZERO };
        let Some(plane) = Plane::seen(polygon) else { return nothing };
        let up = R::Vec3::new(R::ZERO, R::ZERO, R::ONE);
        // The base's horizon, z = 0 there, is a plane through the origin of the lobe's space.
        let [_, _, base_up] = distribution.base_from_target().transposed().columns();
        let mut surface = Clip::<R>::new(if horizon.surface { Some(up) } else { None });
        let mut base = Clip::<R>::new(if horizon.cosine { base_up.try_unit() } else { None });
        let mut fan = Fan::new(distribution, plane);
        for &vertex in polygon.vertices() {
            surface.push(vertex * plane.shrink, &mut |v| base.push(v, &mut |v| fan.push(v)));
        }
        surface.finish(&mut |v| base.push(v, &mut |v| fan.push(v)));
        base.finish(&mut |v| fan.push(v));
        fan.finish()
    }
}

/// Sutherland–Hodgman against the plane through the origin with this inward normal, one vertex at a time. A non-convex
/// polygon that falls apart stays one, its parts joined by edges that are run through both ways.
struct Clip<R: Real> {
    inward: Option<R::Vec3>,
    first: Option<(R::Vec3, R)>,
    previous: Option<(R::Vec3, R)>,
}

impl<R: Real> Clip<R> {
    /// Without a normal everything passes.
    fn new(inward: Option<R::Vec3>) -> Self {
        Self { inward, first: None, previous: None }
    }

    fn push(&mut self, vertex: R::Vec3, emit: &mut impl FnMut(R::Vec3)) {
        let Some(inward) = self.inward else { return emit(vertex) };
        let height = inward.dot(vertex);
        self.cross((vertex, height), emit);
        if height >= R::ZERO {
            emit(vertex);
        }
        self.first = self.first.or(Some((vertex, height)));
        self.previous = Some((vertex, height));
    }

    /// Emits where the edge from the previous vertex to `next` crosses the plane.
    fn cross(&self, next: (R::Vec3, R), emit: &mut impl FnMut(R::Vec3)) {
        if let Some((p, dp)) = self.previous
            && (dp >= R::ZERO) != (next.1 >= R::ZERO)
        {
            emit(p + (next.0 - p) * (dp / (dp - next.1)));
        }
    }

    fn finish(&mut self, emit: &mut impl FnMut(R::Vec3)) {
        if let Some(first) = self.first {
            self.cross(first, emit);
        }
    }
}

/// A vertex, in the lobe's space and as direction and distance in the base's.
#[derive(Clone, Copy)]
struct Corner<R: Real> {
    target: R::Vec3,
    direction: R::Vec3,
    distance: R,
}

/// Sums over the signed fan of triangles from the first vertex, and over the edges.
struct Fan<R: Real> {
    base_from_target: R::Mat3,
    plane: Plane<R>,
    /// `h |M⁻¹|`: the triple product of three vertices in the base's space per unit of their triangle's doubled area.
    height: R,
    ends: Option<(Corner<R>, Corner<R>)>,
    half_solid_angle: R,
    axial_boundary: R,
}

impl<R: Real> Fan<R> {
    fn new<B: Base<R>>(distribution: &LinearlyTransformed<R, B>, plane: Plane<R>) -> Self {
        Self {
            base_from_target: distribution.base_from_target(),
            plane,
            height: plane.height.abs() * distribution.inverse_determinant(),
            ends: None,
            half_solid_angle: R::ZERO,
            axial_boundary: R::ZERO,
        }
    }

    fn push(&mut self, target: R::Vec3) {
        let moved = self.base_from_target.apply(target);
        let Some(direction) = moved.try_unit() else { return };
        let corner = Corner { target, direction, distance: moved.dot(direction) };
        self.ends = Some(match self.ends {
            None => (corner, corner),
            Some((first, previous)) => {
                self.half_solid_angle += self.half_triangle(first, previous, corner);
                self.axial_boundary += axial_edge::<R>(previous.direction, corner.direction);
                (first, corner)
            }
        });
    }

    /// Half the signed solid angle of a triangle, `atan2(det(a, b, c), 1 + a·b + b·c + c·a)` for unit vectors
    /// (Van Oosterom and Strackee 1983).
    ///
    /// The determinant is not taken from the unit vectors, where it cancels for small and for grazing triangles, but as the
    /// height of the plane times the triangle's area in it: its sign is then right for all triangles of the fan, or
    /// for none.
    fn half_triangle(&self, a: Corner<R>, b: Corner<R>, c: Corner<R>) -> R {
        let ab = (b.target - a.target) * (R::ONE / b.distance);
        let ac = (c.target - a.target) * (R::ONE / c.distance);
        let determinant = ab.cross(ac).dot(self.plane.normal) * (self.height / a.distance);
        let cosines =
            a.direction.dot(b.direction) + b.direction.dot(c.direction) + c.direction.dot(a.direction);
        determinant.atan2(R::ONE + cosines)
    }

    fn finish(self) -> Region<R> {
        let closing =
            self.ends.map_or(R::ZERO, |(first, last)| axial_edge::<R>(last.direction, first.direction));
        // Wound counter-clockwise seen from the shading point is clockwise seen from outside of the sphere.
        let orientation = if self.plane.height < R::ZERO { -R::ONE } else { R::ONE };
        Region {
            solid_angle: R::of(2.0) * self.half_solid_angle,
            axial_boundary: orientation * (self.axial_boundary + closing),
        }
    }
}

/// `(a + b)_z (a × b)_z / (1 + a·b)`, with `1 + a·b = |a + b|²/2`; at most 1 in magnitude, 0 for antipodal ends.
fn axial_edge<R: Real>(a: R::Vec3, b: R::Vec3) -> R {
    let sum = a + b;
    // a × b without cancellation: the difference of close ends is exact, and so is the sum of nearly opposite ones.
    let cross = a.cross(if a.dot(b) > R::ZERO { b - a } else { sum });
    let squared = sum.dot(sum);
    if squared > R::ZERO { R::of(2.0) * (sum.z() / squared) * cross.z() } else { R::ZERO }
}
