//! Integration over a fan: the directions to an ellipse, in polar coordinates around its centre.

use std::f64::consts::TAU;

use glam::DVec3;

use crate::cubature::integrate_squares;
use crate::error::ReferenceError;
use crate::lobe::Lobe;
use crate::quadrature::{Estimate, Tolerance};

/// Sectors are at most this wide.
const MAX_SECTOR: f64 = TAU / 8.0;

/// Points `origin + s R(t) (u cos t + v sin t)`, s in [0, 1], cut by half-spaces. R(t) is the way from the pole to the unit
/// circle: so the points are an ellipse of half-axes u and v.
pub(crate) struct Fan<'a> {
    /// The pole, in coordinates that make the ellipse the unit circle.
    pub pole: [f64; 2],
    /// The pole.
    pub origin: DVec3,
    pub u: DVec3,
    pub v: DVec3,
    /// Inward normals.
    pub half_spaces: &'a [DVec3],
}

/// A range of t in which the same bounds hold for s, given by smooth functions.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sector {
    start: f64,
    width: f64,
}

/// A change of variable that spreads the decades between a scale and 1 evenly: `x = scale · sinh y`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spread {
    scale: f64,
}

impl Spread {
    /// Mass within about `scale` of 0 and its algebraic tail; nearly no change where the scale is large.
    pub fn new(scale: f64) -> Self {
        Self { scale: scale.clamp(1e-300, 1e3) }
    }

    fn spread(self, x: f64) -> f64 {
        (x / self.scale).asinh()
    }

    /// x, and dx/dy.
    fn gathered(self, y: f64) -> (f64, f64) {
        (self.scale * y.sinh(), self.scale * y.cosh())
    }
}

/// Where `c + a cos t + b sin t` changes its sign.
pub(crate) fn sign_changes(c: f64, a: f64, b: f64) -> Vec<f64> {
    let radius = a.hypot(b);
    if radius <= c.abs() {
        return Vec::new();
    }
    let (middle, half) = (b.atan2(a), (-c / radius).acos());
    vec![middle - half, middle + half]
}

/// The full turn cut at `angles`, into sectors of limited width.
pub(crate) fn sectors_between(angles: Vec<f64>, from: f64, to: f64) -> Vec<Sector> {
    let mut cuts: Vec<f64> = angles.into_iter().map(|t| from + (t - from).rem_euclid(TAU)).collect();
    cuts.retain(|&t| t > from && t < to);
    cuts.extend([from, to]);
    cuts.sort_by(f64::total_cmp);
    let mut sectors = Vec::new();
    for pair in cuts.windows(2) {
        let parts = ((pair[1] - pair[0]) / MAX_SECTOR).ceil();
        let width = (pair[1] - pair[0]) / parts;
        if width > 0.0 {
            sectors.extend((0..parts as usize).map(|i| Sector { start: pair[0] + i as f64 * width, width }));
        }
    }
    sectors
}

/// The part of [0, 1] where every `offset + s · slope ≥ 0`, possibly empty (its end below its start).
pub(crate) fn allowed(constraints: impl Iterator<Item = (f64, f64)>) -> [f64; 2] {
    constraints.fold([0.0, 1.0], |[low, high], (offset, slope)| {
        if slope > 0.0 {
            [low.max(-offset / slope), high]
        } else if slope < 0.0 {
            [low, high.min(-offset / slope)]
        } else if offset >= 0.0 {
            [low, high]
        } else {
            [low, -1.0]
        }
    })
}

/// An integral `∫∫ f(t, s) ds dt` over sectors.
pub(crate) struct Sectors<'a, F, B, S> {
    pub f: F,
    /// The range of s at the angle t.
    pub bounds: B,
    pub sectors: &'a [Sector],
    /// Points (t, s) where the mass of f may be; from the best of them the peak is looked for.
    pub seeds: &'a [[f64; 2]],
    /// How near to t = 0 and, at the angle t, to s = 0 the mass of f may be.
    pub spread_t: Spread,
    pub spread_s: S,
}

impl<F, B, S> Sectors<'_, F, B, S>
where
    F: Fn(f64, f64) -> f64,
    B: Fn(f64) -> [f64; 2],
    S: Fn(f64) -> Spread,
{
    pub fn integrate(&self, tolerance: Tolerance) -> Result<Estimate, ReferenceError> {
        let placed: Vec<Vec<[f64; 2]>> = self
            .sectors
            .iter()
            .map(|sector| {
                let place = |seed: &[f64; 2]| self.place(sector, *seed);
                let mut seeds: Vec<[f64; 2]> = self.seeds.iter().filter_map(place).collect();
                seeds.extend(peak_seeds(|[x, y]| self.value(sector, x, y).abs(), &seeds));
                seeds.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
                seeds.dedup();
                seeds
            })
            .collect();
        integrate_squares(|piece, x, y| self.value(&self.sectors[piece], x, y), &placed, tolerance)
    }

    /// The angle at x in [0, 1], and its derivative.
    fn angle(&self, sector: &Sector, x: f64) -> (f64, f64) {
        let ends = [sector.start, sector.start + sector.width].map(|t| self.spread_t.spread(t));
        let (t, slope) = self.spread_t.gathered(ends[0] + x * (ends[1] - ends[0]));
        (t, slope * (ends[1] - ends[0]))
    }

    /// The integrand on the unit square.
    fn value(&self, sector: &Sector, x: f64, y: f64) -> f64 {
        let (t, dt) = self.angle(sector, x);
        let [low, high] = (self.bounds)(t);
        if high <= low {
            return 0.0;
        }
        let spread = (self.spread_s)(t);
        let ends = [low, high].map(|s| spread.spread(s));
        let (s, ds) = spread.gathered(ends[0] + y * (ends[1] - ends[0]));
        (self.f)(t, s) * dt * ds * (ends[1] - ends[0])
    }

    /// Where a point (t, s) is in the unit square of a sector; on its border where its s is out of bounds.
    fn place(&self, sector: &Sector, [t, s]: [f64; 2]) -> Option<[f64; 2]> {
        let ahead = (t - sector.start).rem_euclid(TAU);
        let [low, high] = (self.bounds)(t);
        if ahead > sector.width || high <= low {
            return None;
        }
        let within = |spread: Spread, x: f64, low: f64, high: f64| {
            let [x, low, high] = [x, low, high].map(|x| spread.spread(x));
            ((x - low) / (high - low)).clamp(0.0, 1.0)
        };
        let t = sector.start + ahead;
        Some([
            within(self.spread_t, t, sector.start, sector.start + sector.width),
            within((self.spread_s)(t), s, low, high),
        ])
    }
}

/// Points on and around the highest peaks of `f` in the unit square that are found by climbing from the best of `starts` and
/// from the middle. A lobe whose hints all miss a light still has a peak on it, and that can be narrow.
fn peak_seeds(f: impl Fn([f64; 2]) -> f64, starts: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut starts: Vec<(f64, [f64; 2])> = starts.iter().map(|&p| (f(p), p)).collect();
    starts.sort_by(|a, b| b.0.total_cmp(&a.0));
    starts.truncate(2);
    starts.push((f([0.5, 0.5]), [0.5, 0.5]));
    let mut seeds = Vec::new();
    for (value, start) in starts {
        let (peak, at) = climb(&f, value, start);
        if peak <= 0.0 {
            continue;
        }
        seeds.push(at);
        for axis in [0, 1] {
            for sign in [-1.0, 1.0] {
                seeds.push(half_height(&f, peak, at, axis, sign));
            }
        }
    }
    seeds
}

/// Compass search for a maximum, by steps that are halved.
fn climb(f: &impl Fn([f64; 2]) -> f64, value: f64, start: [f64; 2]) -> (f64, [f64; 2]) {
    let (mut value, mut at) = (value, start);
    let mut step = 0.25;
    let mut budget = 400;
    while step > 1e-11 && budget > 0 {
        let mut moved = false;
        for [dx, dy] in [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]] {
            let next = [(at[0] + dx * step).clamp(0.0, 1.0), (at[1] + dy * step).clamp(0.0, 1.0)];
            let there = f(next);
            budget -= 1;
            if there > value {
                (value, at, moved) = (there, next, true);
            }
        }
        step *= if moved { 1.0 } else { 0.5 };
    }
    (value, at)
}

/// How far from a peak along an axis the function has fallen to a half, or the border.
fn half_height(f: &impl Fn([f64; 2]) -> f64, peak: f64, at: [f64; 2], axis: usize, sign: f64) -> [f64; 2] {
    let mut width = 1e-11;
    loop {
        let mut point = at;
        point[axis] = (at[axis] + sign * width).clamp(0.0, 1.0);
        if width > 1.0 || f(point) < 0.5 * peak {
            return point;
        }
        width *= 2.0;
    }
}

impl Fan<'_> {
    /// Normal of the plane, not of unit length.
    fn normal(&self) -> DVec3 {
        self.u.cross(self.v)
    }

    /// R(t)
    pub fn reach(&self, t: f64) -> f64 {
        let (sin, cos) = t.sin_cos();
        let [a, b] = self.pole;
        let (along, across) = (a * cos + b * sin, a * sin - b * cos);
        let half_chord = ((1.0 - across) * (1.0 + across)).max(0.0).sqrt();
        if along > 0.0 { (1.0 - a * a - b * b).max(0.0) / (half_chord + along) } else { half_chord - along }
    }

    /// Where the ray along `w` hits the plane, from the pole; far out on the right side where it does not.
    fn hit(&self, w: DVec3) -> [f64; 2] {
        let n = self.normal();
        let coordinates = |offset: DVec3| {
            [offset.cross(self.v).dot(n), self.u.cross(offset).dot(n)].map(|x| x / n.length_squared())
        };
        let t = n.dot(self.origin) / n.dot(w);
        if t > 0.0 && t.is_finite() {
            coordinates(w * t - self.origin)
        } else {
            let [a, b] = coordinates(w);
            let scale = 1e6 / a.hypot(b).max(1e-300);
            [a * scale, b * scale]
        }
    }

    /// The point, and the way to it from the pole in the coordinates.
    pub fn point(&self, t: f64, s: f64) -> (DVec3, f64) {
        let way = s * self.reach(t);
        (self.origin + way * (self.u * t.cos() + self.v * t.sin()), way)
    }

    /// The range of s at the angle t.
    pub fn bounds(&self, t: f64) -> [f64; 2] {
        let (sin, cos) = t.sin_cos();
        let reach = self.reach(t);
        let slope = |n: &DVec3| (n.dot(self.u) * cos + n.dot(self.v) * sin) * reach;
        allowed(self.half_spaces.iter().map(|n| (n.dot(self.origin), slope(n))))
    }

    /// Where along s the distance of the origin from the pole matters.
    pub fn spread(&self, t: f64) -> Spread {
        let along = (self.u * t.cos() + self.v * t.sin()).length() * self.reach(t);
        Spread::new(self.origin.length() / along)
    }

    /// Cut where the bounds of s change their formula: where a plane crosses the rim, and where two planes meet.
    pub fn sectors(&self) -> Vec<Sector> {
        let [a, b] = self.pole;
        let mut angles = Vec::new();
        for (i, n) in self.half_spaces.iter().enumerate() {
            let (nu, nv) = (n.dot(self.u), n.dot(self.v));
            let at_centre = n.dot(self.origin) - a * nu - b * nv;
            let rim = sign_changes(at_centre, nu, nv);
            angles.extend(rim.into_iter().map(|t| (t.sin() - b).atan2(t.cos() - a)));
            for m in &self.half_spaces[..i] {
                let common = n.cross(*m);
                angles.extend([common, -common].map(|w| {
                    let [a, b] = self.hit(w);
                    b.atan2(a)
                }));
            }
        }
        angles.retain(|t| t.is_finite());
        sectors_between(angles, 0.0, TAU)
    }

    /// Points (t, s) where the mass may be: where the lobe's hints hit, and around the nearest point to the origin, spaced by
    /// the distance there.
    pub fn seeds(&self, lobe: &impl Lobe) -> Vec<[f64; 2]> {
        let n = self.normal();
        let height = n.dot(self.origin).abs() / n.length();
        let [a, b] = self.hit(n * n.dot(self.origin).signum());
        let spread = [height / self.u.length(), height / self.v.length()];
        let near = [[0.0, 0.0], [1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]]
            .map(|[x, y]| [a + x * spread[0], b + y * spread[1]]);
        let hits = lobe.hints().into_iter().map(|w| self.hit(w));
        let polar = |[a, b]: [f64; 2]| {
            let t = b.atan2(a);
            [t, a.hypot(b) / self.reach(t)]
        };
        hits.chain(near).map(polar).filter(|p| p[0].is_finite() && p[1].is_finite()).collect()
    }
}
