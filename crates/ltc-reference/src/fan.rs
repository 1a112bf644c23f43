//! Integration over a fan: the directions to an ellipse, in polar coordinates around its centre.

use std::f64::consts::TAU;

use glam::DVec3;

use crate::cubature::integrate_squares;
use crate::error::ReferenceError;
use crate::lobe::Lobe;
use crate::quadrature::{Estimate, Tolerance};

/// Sectors are at most this wide.
const MAX_SECTOR: f64 = TAU / 8.0;

/// Points `centre + s (u cos t + v sin t)`, s in [0, 1], cut by half-spaces.
pub(crate) struct Fan<'a> {
    pub centre: DVec3,
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

impl Sector {
    fn angle(&self, x: f64) -> f64 {
        self.start + x * self.width
    }

    /// Where `angle` is in the sector, from 0 to 1.
    fn locate(&self, angle: f64) -> Option<f64> {
        let x = (angle - self.start).rem_euclid(TAU) / self.width;
        (x <= 1.0).then_some(x)
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

/// `∫∫ f(t, s) ds dt` over sectors, s between `bounds(t)`. `seeds` are points (t, s) where the mass of f is.
pub(crate) fn integrate_sectors(
    f: impl Fn(f64, f64) -> f64,
    bounds: impl Fn(f64) -> [f64; 2],
    sectors: &[Sector],
    seeds: &[[f64; 2]],
    tolerance: Tolerance,
) -> Result<Estimate, ReferenceError> {
    let placed: Vec<Vec<[f64; 2]>> = sectors
        .iter()
        .map(|sector| {
            let place = |&[t, s]: &[f64; 2]| {
                let [low, high] = bounds(t);
                let x = sector.locate(t).filter(|_| high > low)?;
                Some([x, ((s - low) / (high - low)).clamp(0.0, 1.0)])
            };
            let mut seeds: Vec<[f64; 2]> = seeds.iter().filter_map(place).collect();
            seeds.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
            seeds.dedup();
            seeds
        })
        .collect();
    let integrand = |piece: usize, x: f64, y: f64| {
        let sector = &sectors[piece];
        let t = sector.angle(x);
        let [low, high] = bounds(t);
        if high <= low {
            return 0.0;
        }
        f(t, low + y * (high - low)) * (high - low) * sector.width
    };
    integrate_squares(integrand, &placed, tolerance)
}

impl Fan<'_> {
    /// Normal of the plane, not of unit length.
    fn normal(&self) -> DVec3 {
        self.u.cross(self.v)
    }

    /// The coordinates (a, b) of the point `centre + a u + b v`.
    pub fn coordinates(&self, point: DVec3) -> [f64; 2] {
        let (n, offset) = (self.normal(), point - self.centre);
        [offset.cross(self.v).dot(n), self.u.cross(offset).dot(n)].map(|x| x / n.length_squared())
    }

    /// Where the ray along `w` hits the plane; far out on the right side where it does not.
    fn hit(&self, w: DVec3) -> [f64; 2] {
        let n = self.normal();
        let t = n.dot(self.centre) / n.dot(w);
        if t > 0.0 && t.is_finite() {
            self.coordinates(w * t)
        } else {
            let [a, b] = self.coordinates(self.centre + w);
            let scale = 1e6 / a.hypot(b).max(1e-300);
            [a * scale, b * scale]
        }
    }

    pub fn point(&self, t: f64, s: f64) -> DVec3 {
        self.centre + s * (self.u * t.cos() + self.v * t.sin())
    }

    /// The range of s at the angle t.
    pub fn bounds(&self, t: f64) -> [f64; 2] {
        let (sin, cos) = t.sin_cos();
        allowed(
            self.half_spaces.iter().map(|n| (n.dot(self.centre), n.dot(self.u) * cos + n.dot(self.v) * sin)),
        )
    }

    /// Cut where the bounds of s change their formula: where a plane crosses the rim, and where two planes meet.
    pub fn sectors(&self) -> Vec<Sector> {
        let mut angles = Vec::new();
        for (i, n) in self.half_spaces.iter().enumerate() {
            angles.extend(sign_changes(n.dot(self.centre), n.dot(self.u), n.dot(self.v)));
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

    /// Points (t, s) where the mass is: where the lobe's hints hit, and around the nearest point to the origin, within
    /// `s_max` and spaced by the distance there.
    pub fn seeds(&self, lobe: &impl Lobe) -> Vec<[f64; 2]> {
        let n = self.normal();
        let foot = n * (n.dot(self.centre) / n.length_squared());
        let [a, b] = self.coordinates(foot);
        let height = foot.length();
        let spread = [height / self.u.length(), height / self.v.length()];
        let near = [[0.0, 0.0], [1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]]
            .map(|[x, y]| [a + x * spread[0], b + y * spread[1]]);
        let hits = lobe.hints().into_iter().map(|w| self.hit(w));
        let polar = |[a, b]: [f64; 2]| [b.atan2(a), a.hypot(b)];
        hits.chain(near).map(polar).filter(|p| p[0].is_finite() && p[1].is_finite()).collect()
    }
}
