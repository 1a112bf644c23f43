//! An elliptical cone cut by planes through its apex, and the cosine's integral over it.

use super::angle::azimuth;
use crate::{Real, Vector};

/// Pieces of a boundary at most: a circle cut by a plane has two, each further plane adds two.
const MAX_PIECES: usize = 2 * MAX_PLANES;
/// Two horizons, and one more plane for those who build a shape of parts.
pub(super) const MAX_PLANES: usize = 3;

/// A corner of a region's boundary.
#[derive(Clone, Copy, Debug)]
struct Vertex<R: Real> {
    /// In the coordinates that make the cone's ellipse the unit circle.
    at: [R; 2],
    /// Towards it, in the cone's axes.
    direction: R::Vec3,
    /// [`turn`] of `at`, for those on the circle.
    turn: R,
}

/// What the boundary follows from a corner to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Along {
    /// The ellipse, counter-clockwise.
    Arc,
    /// The great circle of the half-space of this number.
    Chord(usize),
}

#[derive(Clone, Copy, Debug)]
struct Piece<R: Real> {
    start: Vertex<R>,
    along: Along,
}

/// What is left of the cone's ellipse.
enum Boundary<R: Real> {
    Nothing,
    Whole,
    Cut(Pieces<R>),
}

/// Pieces in order, closed.
#[derive(Clone, Copy)]
struct Pieces<R: Real> {
    pieces: [Option<Piece<R>>; MAX_PIECES],
    count: usize,
}

impl<R: Real> Pieces<R> {
    fn new() -> Self {
        Self { pieces: [None; MAX_PIECES], count: 0 }
    }

    /// Beyond the capacity only rounding asks for pieces, of no length.
    fn push(&mut self, start: Vertex<R>, along: Along) {
        if let Some(slot) = self.pieces.get_mut(self.count) {
            *slot = Some(Piece { start, along });
            self.count += 1;
        }
    }

    /// Each piece with its end.
    fn each(&self) -> impl Iterator<Item = (Piece<R>, Vertex<R>)> + '_ {
        (0..self.count).filter_map(|i| {
            let next = if i + 1 == self.count { 0 } else { i + 1 };
            Some((self.pieces[i]?, self.pieces[next]?.start))
        })
    }
}

/// A position on the circle that grows with the angle, by 1 for each quarter, in [0, 4).
fn turn<R: Real>([x, y]: [R; 2]) -> R {
    let ratio = x / (x.abs() + y.abs());
    if y >= R::ZERO { R::ONE - ratio } else { R::of(3.0) + ratio }
}

/// How far counter-clockwise from `from` to `to`, in [0, 4).
fn ahead<R: Real>(from: R, to: R) -> R {
    let d = to - from;
    if d < R::ZERO { d + R::of(4.0) } else { d }
}

/// The region of a cone inside of half-spaces.
pub(super) struct ConeRegion<'a, R: Real> {
    widths: [R; 2],
    /// Normals of the half-spaces in the cone's axes.
    normals: &'a [R::Vec3],
    boundary: Boundary<R>,
}

impl<'a, R: Real> ConeRegion<'a, R> {
    /// Sutherland–Hodgman, plane after plane, so that the boundary is closed however its corners are rounded. `normals` are
    /// unit vectors in the cone's axes, [`MAX_PLANES`] at most.
    pub fn new(widths: [R; 2], normals: &'a [R::Vec3]) -> Self {
        let mut region = Self { widths, normals, boundary: Boundary::Whole };
        for plane in 0..normals.len().min(MAX_PLANES) {
            region.cut(plane);
        }
        region
    }

    /// The half-space as `g₀ x + g₁ y + g₂ ≥ 0` in the coordinates of the circle.
    fn linear(&self, plane: usize) -> [R; 3] {
        let n = self.normals[plane];
        [self.widths[0] * n.x(), self.widths[1] * n.y(), n.z()]
    }

    fn on_circle(&self, at: [R; 2]) -> Vertex<R> {
        let direction = R::Vec3::new(self.widths[0] * at[0], self.widths[1] * at[1], R::ONE);
        Vertex { at, direction, turn: turn(at) }
    }

    /// Where the circle enters the half-space and where it leaves it.
    fn crossings(&self, [gx, gy, gz]: [R; 3], radius: R) -> [Vertex<R>; 2] {
        let (cos, sin) = (-gz / radius, ((radius - gz) * (radius + gz)).max(R::ZERO).sqrt() / radius);
        let (mx, my) = (gx / radius, gy / radius);
        [
            self.on_circle([mx * cos + my * sin, my * cos - mx * sin]),
            self.on_circle([mx * cos - my * sin, my * cos + mx * sin]),
        ]
    }

    fn cut(&mut self, plane: usize) {
        let g = self.linear(plane);
        let radius = (g[0].squared() + g[1].squared()).sqrt();
        // Closer to touching than this only rounding tells.
        let limit = radius * (R::ONE - R::of(4.0) * R::EPSILON);
        if g[2] >= limit {
            return;
        }
        let crossings = if g[2] <= -limit { None } else { Some(self.crossings(g, radius)) };
        self.boundary = match (&self.boundary, crossings) {
            (Boundary::Nothing, _) | (_, None) => Boundary::Nothing,
            (Boundary::Whole, Some([entry, exit])) => {
                let mut pieces = Pieces::new();
                pieces.push(entry, Along::Arc);
                pieces.push(exit, Along::Chord(plane));
                Boundary::Cut(pieces)
            }
            (Boundary::Cut(pieces), Some(crossings)) => {
                let kept = self.cut_pieces(pieces, plane, g, crossings);
                if kept.count == 0 { Boundary::Nothing } else { Boundary::Cut(kept) }
            }
        };
    }

    fn cut_pieces(
        &self,
        pieces: &Pieces<R>,
        plane: usize,
        g: [R; 3],
        crossings: [Vertex<R>; 2],
    ) -> Pieces<R> {
        let mut kept = Pieces::new();
        let value = |v: &Vertex<R>| g[0] * v.at[0] + g[1] * v.at[1] + g[2];
        for (piece, end) in pieces.each() {
            let values = [value(&piece.start), value(&end)];
            match piece.along {
                Along::Arc => cut_arc(&mut kept, plane, [piece.start, end], values, crossings),
                Along::Chord(other) => {
                    let (starts_in, ends_in) = (values[0] >= R::ZERO, values[1] >= R::ZERO);
                    if starts_in {
                        kept.push(piece.start, piece.along);
                    }
                    if starts_in != ends_in {
                        let corner = self.corner([other, plane], [piece.start, end], values);
                        kept.push(corner, if starts_in { Along::Chord(plane) } else { piece.along });
                    }
                }
            }
        }
        kept
    }

    /// Where a chord of one plane crosses another plane: along the planes' common line, which rounding does not move.
    fn corner(&self, [chord, plane]: [usize; 2], [p, q]: [Vertex<R>; 2], [gp, gq]: [R; 2]) -> Vertex<R> {
        let t = gp / (gp - gq);
        let at = [0, 1].map(|i| p.at[i] + (q.at[i] - p.at[i]) * t);
        let common = self.normals[chord].cross(self.normals[plane]);
        let direction = if common.length() <= R::of(64.0) * R::EPSILON {
            R::Vec3::new(self.widths[0] * at[0], self.widths[1] * at[1], R::ONE)
        } else if gp >= R::ZERO {
            common
        } else {
            -common
        };
        Vertex { at, direction, turn: R::ZERO }
    }

    /// `∫ ω·up / π dω` over the region, by Stokes' theorem: half the sum of `∫ (r × dr)·up / |r|²` along the boundary,
    /// over π. `None` for the uncut cone.
    pub fn integral(&self, up: R::Vec3) -> Option<R> {
        let pieces = match &self.boundary {
            Boundary::Nothing => return Some(R::ZERO),
            Boundary::Whole => return None,
            Boundary::Cut(pieces) => pieces,
        };
        let mut sum = R::ZERO;
        for (piece, end) in pieces.each() {
            sum += match piece.along {
                Along::Arc => arc(self.widths, up, piece.start, end),
                Along::Chord(plane) => {
                    let normal = self.normals[plane];
                    angle_around::<R>(normal, piece.start.direction, end.direction) * normal.dot(up)
                }
            };
        }
        Some(sum / (R::of(2.0) * R::PI))
    }
}

/// What a half-space leaves of an arc, given its values at the arc's ends and where the whole circle enters and leaves it.
fn cut_arc<R: Real>(
    kept: &mut Pieces<R>,
    plane: usize,
    [start, end]: [Vertex<R>; 2],
    values: [R; 2],
    [entry, exit]: [Vertex<R>; 2],
) {
    let length = ahead(start.turn, end.turn);
    let (to_entry, to_exit) = (ahead(start.turn, entry.turn), ahead(start.turn, exit.turn));
    match (values[0] >= R::ZERO, values[1] >= R::ZERO) {
        (true, true) => {
            kept.push(start, Along::Arc);
            if to_exit < to_entry && to_entry < length {
                kept.push(exit, Along::Chord(plane));
                kept.push(entry, Along::Arc);
            }
        }
        (true, false) => {
            kept.push(start, Along::Arc);
            kept.push(within(exit, to_exit, [start, end], length), Along::Chord(plane));
        }
        (false, true) => kept.push(within(entry, to_entry, [start, end], length), Along::Arc),
        (false, false) => {
            if to_entry < to_exit && to_exit < length {
                kept.push(entry, Along::Arc);
                kept.push(exit, Along::Chord(plane));
            }
        }
    }
}

/// The vertex, or the nearer end of the arc where rounding has put it beyond.
fn within<R: Real>(vertex: Vertex<R>, ahead: R, [start, end]: [Vertex<R>; 2], length: R) -> Vertex<R> {
    if ahead <= length {
        vertex
    } else if ahead - length < R::of(4.0) - ahead {
        end
    } else {
        start
    }
}

/// Angle from `p` to `q` counter-clockwise around `normal`. No chord of a cone is longer than π: what rounding makes
/// negative near π is taken as such.
fn angle_around<R: Real>(normal: R::Vec3, p: R::Vec3, q: R::Vec3) -> R {
    let angle = azimuth(normal.dot(p.cross(q)), p.dot(q));
    if angle < R::of(-0.5) * R::PI { angle + R::of(2.0) * R::PI } else { angle }
}

/// `∫ (r × dr)·n / |r|²` along `r = (A cos τ, B sin τ, 1)` counter-clockwise from `start` to `end`, in closed form:
///
/// ```text
/// ∫ (−n₁ B cos τ − n₂ A sin τ + n₃ A B) / (1 + A² cos²τ + B² sin²τ) dτ
/// ```
///
/// The first term is an artanh of sin τ, the second an arctan of cos τ, the third an angle. Each is taken as one
/// function of both ends, so that short arcs keep their digits.
fn arc<R: Real>([a, b]: [R; 2], n: R::Vec3, start: Vertex<R>, end: Vertex<R>) -> R {
    let ([w0, u0], [w1, u1]) = (start.at, end.at);
    let (alpha, beta) = ((R::ONE + a.squared()).sqrt(), (R::ONE + b.squared()).sqrt());
    let gap = (a - b) * (a + b);
    let ratio = beta / alpha;
    // k² = (A² − B²)/(1 + A²); 1 − k² = (β/α)².
    let kk = gap / alpha.squared();
    let cosine = artanh_over(kk, (u1 - u0) / (kk * (R::ONE - u0 * u1) + ratio.squared()));
    let qq = gap / beta.squared();
    let sine = arctan_over(qq, w1 - w0, R::ONE + qq * w0 * w1);
    let even = azimuth(ratio * (w0 * u1 - u0 * w1), w0 * w1 + ratio.squared() * u0 * u1);
    let length = ahead(start.turn, end.turn);
    let even = match even < R::ZERO {
        true if length > R::ONE => even + R::of(2.0) * R::PI,
        true => R::ZERO,
        false if length > R::of(3.0) => R::of(2.0) * R::PI,
        false => even,
    };
    n.y() * (a / beta.squared()) * sine - n.x() * (b / alpha.squared()) * cosine
        + n.z() * (a / alpha) * (b / beta) * even
}

/// `artanh(k m) / k` for k² = `kk` in [0, 1), |k m| ≤ 1.
fn artanh_over<R: Real>(kk: R, m: R) -> R {
    let square = kk * m.squared();
    if square < R::of(1e-4) {
        // The next term is x⁸/9: 1e-17.
        let third = R::of(1.0 / 3.0) + square * (R::of(0.2) + square * R::of(1.0 / 7.0));
        return m * (R::ONE + square * third);
    }
    let k = kk.sqrt();
    (k * m.abs()).min(R::ONE - R::EPSILON).atanh() / k * if m < R::ZERO { -R::ONE } else { R::ONE }
}

/// `arctan(q y, x) / q` for q² = `qq` ≥ 0: of two arguments, q y and x.
fn arctan_over<R: Real>(qq: R, y: R, x: R) -> R {
    if qq <= R::TINY {
        return y;
    }
    let q = qq.sqrt();
    azimuth(q * y, x) / q
}
