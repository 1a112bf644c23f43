//! The transformed polygon on the sphere: its solid angle and its axial boundary term.
//!
//! In f64 for f32 as well: what f32 loses in the transformation of a thin lobe exceeds all other errors by far.

use core::f64::consts::PI;

use glam::{DMat3, DVec3};

use super::{Base, LinearlyTransformed};
use crate::light::{Plane, half_triangle, sum_of_units, widen};
use crate::{Horizon, Matrix, Polygon, Real, Vector};

/// What the closed forms of the bases are made of, for the polygon in the base's space, wound positively.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Region {
    /// In sr.
    pub solid_angle: f64,
    /// `Σ (a + b)_z (a × b)_z / (1 + a·b)` over the edges from a to b, unit vectors.
    pub axial_boundary: f64,
}

impl Region {
    /// The region of `polygon` cut by the horizons asked for; nothing where the polygon is not to be seen.
    pub fn of<R: Real, B: Base<R>>(
        distribution: &LinearlyTransformed<R, B>,
        polygon: &Polygon<'_, R>,
        horizon: Horizon,
    ) -> Self {
        let Some(plane) = Plane::seen(polygon) else { return Self::default() };
        // The adjugate of M: the inverse up to a scale above 0, which directions do not feel.
        let [x, y, z] = distribution.target_from_base().columns().map(widen::<R>);
        let rows = [y.cross(z), z.cross(x), x.cross(y)];
        // The base's horizon, z = 0 there, is a plane through the origin of the lobe's space.
        let base_up = rows[2];
        let surface_up = horizon.surface.then_some(DVec3::Z);
        let foot = on_plane(&plane, plane.normal.with_z(0.0));
        let mut surface = Clip { foot, ..Clip::new(surface_up) };
        let corner = on_plane(&plane, DVec3::Z.cross(base_up));
        let mut base = Clip { corner, ..Clip::new(base_up.try_unit().filter(|_| horizon.cosine)) };
        let mut fan = Fan::new(DMat3::from_cols(rows[0], rows[1], rows[2]).transpose());
        for &vertex in polygon.vertices() {
            surface.push(widen::<R>(vertex) * plane.shrink, Cut::Not, &mut |v, cut| {
                base.push(v, cut, &mut |v, cut| fan.push(v, cut));
            });
        }
        surface.finish(&mut |v, cut| base.push(v, cut, &mut |v, cut| fan.push(v, cut)));
        base.finish(&mut |v, cut| fan.push(v, cut));
        // Wound counter-clockwise seen from the shading point is clockwise seen from outside of the sphere.
        fan.finish(if plane.height < 0.0 { -1.0 } else { 1.0 })
    }
}

/// Where the line `along` through the origin meets the plane, if it does.
fn on_plane(plane: &Plane, along: DVec3) -> Option<DVec3> {
    let along = along.try_unit()?;
    Some(along * (plane.height / plane.normal.dot(along))).filter(|point| point.is_finite())
}

/// How a vertex came about.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Cut {
    /// It is one of the polygon.
    Not,
    /// By an edge that goes below.
    Leaving,
    /// By an edge that comes up; the edge to this vertex runs along the horizon.
    Entering,
}

/// Sutherland–Hodgman against the plane through the origin with this inward normal, one vertex at a time. A non-convex
/// polygon that falls apart stays one, its parts joined by edges that are run through both ways.
///
/// Just above the light's plane an edge along a horizon passes so near to the origin that its ends do not tell where:
/// points of it that are known otherwise are then put in.
#[derive(Default)]
struct Clip {
    /// `None`: everything passes.
    inward: Option<DVec3>,
    /// The point nearest to the origin of the edges that this clip makes.
    foot: Option<DVec3>,
    /// Where the edges that an earlier clip made cross this one.
    corner: Option<DVec3>,
    first: Option<Clipped>,
    previous: Option<Clipped>,
}

/// A vertex as a clip got it.
#[derive(Clone, Copy)]
struct Clipped {
    vertex: DVec3,
    height: f64,
    along_horizon: bool,
}

impl Clip {
    fn new(inward: Option<DVec3>) -> Self {
        Self { inward, ..Self::default() }
    }

    fn push(&mut self, vertex: DVec3, cut: Cut, emit: &mut impl FnMut(DVec3, Cut)) {
        let Some(inward) = self.inward else { return emit(vertex, Cut::Not) };
        let next = Clipped { vertex, height: inward.dot(vertex), along_horizon: cut == Cut::Entering };
        self.cross(next, emit);
        if next.height >= 0.0 {
            emit(vertex, Cut::Not);
        }
        self.first = self.first.or(Some(next));
        self.previous = Some(next);
    }

    /// Emits where the edge from the previous vertex to `next` crosses the plane.
    fn cross(&self, next: Clipped, emit: &mut impl FnMut(DVec3, Cut)) {
        let Some(previous) = self.previous else { return };
        let cut = match (previous.height >= 0.0, next.height >= 0.0) {
            (true, false) => Cut::Leaving,
            (false, true) => Cut::Entering,
            _ => return,
        };
        if let Some(foot) = self.foot.filter(|_| cut == Cut::Entering) {
            emit(foot, Cut::Entering);
        }
        let (p, q) = (previous.vertex, next.vertex);
        let between = p + (q - p) * (previous.height / (previous.height - next.height));
        emit(self.corner.filter(|_| next.along_horizon).unwrap_or(between), cut);
    }

    fn finish(&self, emit: &mut impl FnMut(DVec3, Cut)) {
        if let Some(first) = self.first {
            self.cross(first, emit);
        }
    }
}

/// Sums over the signed fan of triangles from the first vertex, and over the edges, of unit vectors in the base's space.
struct Fan {
    base_from_target: DMat3,
    ends: Option<(DVec3, DVec3)>,
    half_solid_angle: f64,
    axial_boundary: f64,
}

impl Fan {
    fn new(base_from_target: DMat3) -> Self {
        Self { base_from_target, ends: None, half_solid_angle: 0.0, axial_boundary: 0.0 }
    }

    fn push(&mut self, target: DVec3, cut: Cut) {
        let moved = self.base_from_target * target;
        // What lies on the base's horizon lies there exactly.
        let moved = if cut == Cut::Not { moved } else { moved.with_z(0.0) };
        let Some(direction) = moved.try_unit() else { return };
        self.ends = Some(match self.ends {
            None => (direction, direction),
            Some((first, previous)) => {
                self.half_solid_angle += half_triangle(first, previous, direction);
                self.axial_boundary += axial_edge(previous, direction);
                (first, direction)
            }
        });
    }

    fn finish(self, orientation: f64) -> Region {
        let closing = self.ends.map_or(0.0, |(first, last)| axial_edge(last, first));
        let half = orientation * self.half_solid_angle;
        // The sum is known up to 4π: a triangle of nearly 2π may count as one of nearly −2π. A flat polygon spans at
        // most 2π, so that there is no doubt which it is.
        let wrapped = if half < -0.5 * PI { half + 2.0 * PI } else { half };
        Region { solid_angle: 2.0 * wrapped, axial_boundary: orientation * (self.axial_boundary + closing) }
    }
}

/// `(a + b)_z (a × b)_z / (1 + a·b)`, with `1 + a·b = |a + b|²/2`; at most 1 in magnitude, 0 for antipodal ends.
fn axial_edge(a: DVec3, b: DVec3) -> f64 {
    let sum = sum_of_units(a, b);
    // a × b without cancellation: the difference of close ends is exact, and so is the sum of nearly opposite ones.
    let cross = a.cross(if a.dot(b) > 0.0 { b - a } else { sum });
    let squared = sum.length_squared();
    if squared > 0.0 { 2.0 * (sum.z / squared) * cross.z } else { 0.0 }
}
