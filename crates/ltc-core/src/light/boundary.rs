//! Integrals over regions of the sphere as sums along their boundaries.
//!
//! Everything here is computed in `f64`, for `f32` inputs too: their products are then exact, so that the plane of an edge
//! that passes the shading point closely, and the side of the light that is seen, are never lost to rounding.

use core::marker::PhantomData;

use glam::{DMat3, DVec3};

use super::Horizon;
use super::angle::{angle_for, azimuth_for};
use crate::{Matrix, Real, Vector};

/// Sutherland–Hodgman against z ≥ 0, one vertex out at a time.
pub(super) fn clip_to_surface<R: Real>(vertices: &[R::Vec3], mut emit: impl FnMut(R::Vec3)) {
    let Some(&last) = vertices.last() else { return };
    let mut p = last;
    for &q in vertices {
        let (p_in, q_in) = (p.z() >= R::ZERO, q.z() >= R::ZERO);
        if p_in != q_in {
            emit(horizon_point::<R>(p, q));
        }
        if q_in {
            emit(q);
        }
        p = q;
    }
}

/// Where the segment from `p` to `q`, whose ends lie on different sides of z = 0, crosses it.
pub(super) fn horizon_point<R: Real>(p: R::Vec3, q: R::Vec3) -> R::Vec3 {
    let t = p.z() / (p.z() - q.z());
    let x = p + (q - p) * t;
    R::Vec3::new(x.x(), x.y(), R::ZERO)
}

/// `v`, widened.
#[inline]
pub(crate) fn widen<R: Real>(v: R::Vec3) -> DVec3 {
    DVec3::new(v.x().to_f64(), v.y().to_f64(), v.z().to_f64())
}

/// The power of two that brings `x` to about 1, without rounding anything.
#[inline]
pub(super) fn power_of_two_near_reciprocal(x: f64) -> f64 {
    let exponent = (x.to_bits() >> 52) & 0x7ff;
    f64::from_bits(2045_u64.saturating_sub(exponent).max(1) << 52)
}

/// A vertex as a direction: its length means nothing.
#[derive(Clone, Copy)]
struct Corner {
    /// In the shading frame.
    surface: DVec3,
    /// In cosine space.
    cosine: DVec3,
}

impl Corner {
    fn above(self) -> bool {
        self.surface.z >= 0.0
    }

    /// Where the arc from here to `other` crosses the surface's horizon: `|z'| a + |z| b`.
    fn horizon(self, other: Self) -> Self {
        let (s, t) = (other.surface.z.abs(), self.surface.z.abs());
        let point = self.surface * s + other.surface * t;
        Self { surface: DVec3::new(point.x, point.y, 0.0), cosine: self.cosine * s + other.cosine * t }
    }
}

/// Accumulates `∮ sin²θ dφ` in cosine space, where θ > π/2 counts as π/2, along the boundary of a polygon that may first
/// be cut by the surface's horizon.
///
/// By Stokes' theorem this is `2 ∫ max(0, cos θ) dω` over the inside, less 2π when the nadir is inside, up to the sign
/// of the winding. Edges are independent of each other, so nothing need be closed along the horizon of cosine space; along
/// the surface's, an arc joins each exit to the next entry.
pub(super) struct BoundarySum<R: Real> {
    cosine_from_target: DMat3,
    horizon: Horizon,
    ends: Option<(Corner, Corner)>,
    /// The first entry and the last exit, on the surface's horizon.
    first_entry: Option<Corner>,
    last_exit: Option<Corner>,
    sum: f64,
    precision: PhantomData<R>,
}

impl<R: Real> BoundarySum<R> {
    pub fn new(cosine_from_target: R::Mat3, horizon: Horizon) -> Self {
        let [x, y, z] = cosine_from_target.columns().map(widen::<R>);
        let largest = x.abs().max(y.abs()).max(z.abs()).max_element();
        // A scale of the lobe's means nothing, and keeps products in range.
        let scale = power_of_two_near_reciprocal(largest);
        Self {
            cosine_from_target: DMat3::from_cols(x * scale, y * scale, z * scale),
            horizon,
            ends: None,
            first_entry: None,
            last_exit: None,
            sum: 0.0,
            precision: PhantomData,
        }
    }

    pub fn push(&mut self, vertex: R::Vec3) {
        let vertex = widen::<R>(vertex);
        let largest = vertex.abs().max_element();
        // A vertex at the shading point has no direction: leaving it out is the limit of a corner that is cut off.
        if largest <= 0.0 {
            return;
        }
        let surface = vertex * power_of_two_near_reciprocal(largest);
        let corner = Corner { surface, cosine: self.cosine_from_target * surface };
        self.ends = Some(match self.ends {
            None => (corner, corner),
            Some((first, previous)) => {
                self.edge(previous, corner);
                (first, corner)
            }
        });
    }

    pub fn finish(mut self) -> R {
        if let Some((first, last)) = self.ends {
            self.edge(last, first);
        }
        if let (Some(exit), Some(entry)) = (self.last_exit, self.first_entry) {
            self.close(exit, entry);
        }
        R::of(self.sum)
    }

    /// The edge from `a` to `b`, cut by the surface's horizon.
    fn edge(&mut self, a: Corner, b: Corner) {
        let whole = !self.horizon.surface;
        if !whole && !a.above() && !b.above() {
            return;
        }
        let normal = self.normal(a, b);
        if whole || (a.above() && b.above()) {
            self.arc(a.cosine, b.cosine, normal);
        } else if a.above() {
            let exit = a.horizon(b);
            self.arc(a.cosine, exit.cosine, normal * a.surface.z);
            self.last_exit = Some(exit);
        } else {
            let entry = a.horizon(b);
            match self.last_exit.take() {
                Some(exit) => self.close(exit, entry),
                None => self.first_entry = Some(entry),
            }
            self.arc(entry.cosine, b.cosine, normal * b.surface.z);
        }
    }

    /// The arc from `exit` to `entry` along the surface's horizon.
    fn close(&mut self, exit: Corner, entry: Corner) {
        let turn = exit.surface.x * entry.surface.y - exit.surface.y * entry.surface.x;
        let horizon = self.cosine_from_target.x_axis.cross(self.cosine_from_target.y_axis);
        self.arc(exit.cosine, entry.cosine, horizon * turn);
    }

    /// Cross product in cosine space of an edge's ends.
    fn normal(&self, a: Corner, b: Corner) -> DVec3 {
        let normal = a.cosine.cross(b.cosine);
        let (squared, dot) = (normal.length_squared(), a.cosine.dot(b.cosine));
        if dot >= 0.0 || squared > 1e-8 * a.cosine.length_squared() * b.cosine.length_squared() {
            return normal;
        }
        // Near π the plane of the edge hangs on digits that the product above has lost.
        let exact = exact_cross(a.surface, b.surface);
        let [x, y, z] = self.cosine_from_target.columns();
        y.cross(z) * exact.x + z.cross(x) * exact.y + x.cross(y) * exact.z
    }

    /// `∫ sin²θ dφ` along the great circle from `a` to `b`, whose cross product is `normal`, its part below the horizon
    /// dropped onto the horizon.
    fn arc(&mut self, a: DVec3, b: DVec3, normal: DVec3) {
        let length = normal.length();
        // Equal and antipodal ends, which span no plane, give 0.
        if length < f64::MIN_POSITIVE {
            return;
        }
        let slope = normal.z / length;
        let (a_in, b_in) = (!self.horizon.cosine || a.z >= 0.0, !self.horizon.cosine || b.z >= 0.0);
        self.sum += match (a_in, b_in) {
            (true, true) => angle_for::<R>(length, a.dot(b)) * slope,
            (false, false) => azimuth_for::<R>(normal.z, a.x * b.x + a.y * b.y),
            (true, false) => {
                let (to_a, to_b) = horizon_cosines(a, b, normal, length);
                angle_for::<R>(a.z * length, to_a) * slope + azimuth_for::<R>(-b.z * normal.z, to_b)
            }
            (false, true) => {
                let (to_b, to_a) = horizon_cosines(b, a, -normal, length);
                azimuth_for::<R>(-a.z * normal.z, to_a) + angle_for::<R>(b.z * length, to_b) * slope
            }
        };
    }
}

/// Scalar products of `a`, above, and `b`, below, whose cross product is `normal`, with the point `h = |b_z| a + |a_z| b` between them on the horizon.
///
/// `h` is also parallel to `normal × ẑ`; of both forms the one that does not cancel is taken: the first where the arc is
/// flat, the second where it is steep.
fn horizon_cosines(a: DVec3, b: DVec3, normal: DVec3, length: f64) -> (f64, f64) {
    if normal.x * normal.x + normal.y * normal.y > 0.01 * length * length {
        return (a.x * normal.y - a.y * normal.x, b.x * normal.y - b.y * normal.x);
    }
    let cosine = a.dot(b);
    (a.z * cosine - b.z * a.length_squared(), a.z * b.length_squared() - b.z * cosine)
}

/// `a × b`, each component to its own last digits (Kahan's difference of products).
fn exact_cross(a: DVec3, b: DVec3) -> DVec3 {
    let difference = |p: f64, q: f64, r: f64, s: f64| {
        let rs = r * s;
        p.mul_add(q, -rs) + (-r).mul_add(s, rs)
    };
    DVec3::new(difference(a.y, b.z, a.z, b.y), difference(a.z, b.x, a.x, b.z), difference(a.x, b.y, a.y, b.x))
}

/// The integral over the inside, as a fraction, from the boundary sum of a polygon that winds positively.
///
/// A flat polygon with the nadir inside covers at most half of the cosine, so its sum over 2π is in [−1, −½]; without
/// it, it is in [0, 1]. Which of both is never in doubt, however much either is rounded.
pub(super) fn fraction_from_boundary<R: Real>(sum: R) -> R {
    let turns = sum / (R::of(2.0) * R::PI);
    let wrapped = if turns < R::of(-0.25) { turns + R::ONE } else { turns };
    wrapped.clamped(R::ZERO, R::ONE)
}
