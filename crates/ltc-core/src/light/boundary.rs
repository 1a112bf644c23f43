//! Integrals over regions of the sphere as sums along their boundaries.

use super::Horizon;
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

/// Accumulates `∮ sin²θ dφ` in cosine space, where θ > π/2 counts as π/2, along the boundary of a polygon.
///
/// By Stokes' theorem this is `2 ∫ max(0, cos θ) dω` over the inside, less 2π when the nadir is inside, up to the sign
/// of the winding. Edges are independent of each other, so nothing need be closed along the horizon.
pub(super) struct BoundarySum<R: Real> {
    cosine_from_target: R::Mat3,
    /// Whether the horizon of cosine space cuts.
    cut: bool,
    ends: Option<(R::Vec3, R::Vec3)>,
    sum: R,
}

impl<R: Real> BoundarySum<R> {
    pub fn new(cosine_from_target: R::Mat3, horizon: Horizon) -> Self {
        Self { cosine_from_target, cut: horizon.cosine, ends: None, sum: R::ZERO }
    }

    pub fn push(&mut self, vertex: R::Vec3) {
        // A vertex at the shading point has no direction: leaving it out is the limit of a corner that is cut off.
        let Some(v) = self.cosine_from_target.apply(vertex).try_unit() else { return };
        self.ends = Some(match self.ends {
            None => (v, v),
            Some((first, previous)) => {
                self.sum += self.edge(previous, v);
                (first, v)
            }
        });
    }

    fn edge(&self, a: R::Vec3, b: R::Vec3) -> R {
        if self.cut { edge::<R>(a, b) } else { edge_above::<R>(a, b) }
    }

    pub fn finish(self) -> R {
        self.ends.map_or(R::ZERO, |(first, last)| self.sum + self.edge(last, first))
    }
}

/// `∫ sin²θ dφ` along the great circle from `a` to `b`, its part below the horizon dropped onto the horizon.
fn edge<R: Real>(a: R::Vec3, b: R::Vec3) -> R {
    match (a.z() >= R::ZERO, b.z() >= R::ZERO) {
        (true, true) => edge_above::<R>(a, b),
        (false, false) => azimuth::<R>(a, b),
        (true, false) => {
            let x = horizon_point::<R>(a, b);
            edge_above::<R>(a, x) + azimuth::<R>(x, b)
        }
        (false, true) => {
            let x = horizon_point::<R>(a, b);
            azimuth::<R>(a, x) + edge_above::<R>(x, b)
        }
    }
}

/// `∫ sin²θ dφ = angle(a, b) · (a×b).z / |a×b|` (2016 paper, eq. 11, with the angle by atan2, which neither cancels for
/// short edges nor for edges near π). Equal and antipodal ends, which span no plane, give 0.
fn edge_above<R: Real>(a: R::Vec3, b: R::Vec3) -> R {
    let normal = a.cross(b);
    let sine = normal.length();
    if sine <= R::TINY { R::ZERO } else { sine.atan2(a.dot(b)) * (normal.z() / sine) }
}

/// Azimuth from `a` to `b`, in (−π, π].
fn azimuth<R: Real>(a: R::Vec3, b: R::Vec3) -> R {
    (a.x() * b.y() - a.y() * b.x()).atan2(a.x() * b.x() + a.y() * b.y())
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
