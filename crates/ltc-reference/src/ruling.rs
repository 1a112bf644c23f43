//! A lobe integrated along a straight segment: what one- and two-dimensional integrals over thin lights are made of.

use std::f64::consts::PI;

use glam::DVec3;

use crate::error::ReferenceError;
use crate::lobe::Lobe;
use crate::quadrature::{Estimate, Tolerance, integrate_1d};

/// So many of the lobe's hints become limits of integration: narrow lobes are found, broad ones not cut to pieces.
const QUANTILES: usize = 16;
/// Limits nearer to each other than this angle are one.
const MIN_PIECE: f64 = 1e-12;
/// A swept surface is cut into so many panels before it is refined.
const PANELS: usize = 8;
/// Tolerance along a segment, as a fraction of that across.
const INNER: f64 = 0.02;

/// What the integrals along many segments need to know of a lobe.
pub(crate) struct Along<'a, L> {
    lobe: &'a L,
    kinks: Vec<DVec3>,
    half_spaces: Vec<DVec3>,
    hints: Vec<DVec3>,
}

impl<'a, L: Lobe> Along<'a, L> {
    pub fn new(lobe: &'a L) -> Self {
        Self { lobe, kinks: lobe.kinks(), half_spaces: lobe.half_spaces(), hints: lobe.hints() }
    }

    /// `∫ D(ω) ‖ω × ω_t‖ / ‖p‖² dl` over the points p from `a` to `b`: the integral of eq. 1.6 without its factor 2.
    ///
    /// With t the angle of ω it is `∫ D(ω(t)) / ‖p‖ dt`: `dl ‖ω × ω_t‖ = ‖p‖ dt`. The interval is cut where the line meets the
    /// lobe's planes, and at some of the angles nearest to the lobe's hints.
    pub fn integrate(&self, a: DVec3, b: DVec3, tolerance: Tolerance) -> Result<Estimate, ReferenceError> {
        let Some(arc) = Arc::new(a, b) else { return Ok(Estimate::default()) };
        let limits = self.limits(&arc);
        let pieces = limits.len() - 1;
        let tolerance = Tolerance { absolute: tolerance.absolute / pieces as f64, ..tolerance };
        let mut total = Estimate::default();
        for pair in limits.windows(2) {
            let middle = arc.direction(0.5 * (pair[0] + pair[1]));
            if self.half_spaces.iter().any(|n| n.dot(middle) <= 0.0) {
                continue;
            }
            let integrand = |t: f64| self.lobe.density(arc.direction(t)) * arc.inverse_distance(t);
            let piece = integrate_1d(integrand, pair[0], pair[1], tolerance)?;
            total.value += piece.value;
            total.error += piece.error;
            total.evaluations += piece.evaluations;
        }
        Ok(total)
    }

    /// Ascending angles between which the integrand is smooth, the first and the last those of the ends.
    fn limits(&self, arc: &Arc) -> Vec<f64> {
        let &Arc { x, y, start, end, .. } = arc;
        let inside = |t: &f64| *t > start + MIN_PIECE && *t < end - MIN_PIECE;
        let mut hints: Vec<f64> =
            self.hints.iter().map(|w| w.dot(y).atan2(w.dot(x))).filter(inside).collect();
        hints.sort_by(f64::total_cmp);
        let step = hints.len().div_ceil(QUANTILES).max(1);
        let mut limits: Vec<f64> = hints.into_iter().step_by(step).collect();
        for n in &self.kinks {
            // n · ω(t) = 0.
            let t = (-n.dot(x)).atan2(n.dot(y));
            limits.extend([t - PI, t, t + PI].iter().filter(|t| inside(t)));
        }
        limits.extend([start, end]);
        limits.sort_by(f64::total_cmp);
        limits.dedup_by(|b, a| *b - *a < MIN_PIECE);
        if limits.len() < 2 {
            limits = vec![start, end];
        }
        limits
    }
}

/// A segment as directions: `ω(t) = x cos t + y sin t` for t from `start` to `end`.
struct Arc {
    x: DVec3,
    y: DVec3,
    start: f64,
    end: f64,
    /// Distance of the line from the origin.
    distance: f64,
    /// Does x point to the line's nearest point? Else y does.
    from_foot: bool,
}

impl Arc {
    /// `None` for a segment that spans no angle.
    fn new(a: DVec3, b: DVec3) -> Option<Self> {
        let tangent = (b - a).try_normalize()?;
        let (l0, l1) = (a.dot(tangent), b.dot(tangent));
        // The foot of the perpendicular, from the nearer end, which loses fewer digits.
        let nearer = if l0.abs() < l1.abs() { a } else { b };
        let foot = nearer - tangent * nearer.dot(tangent);
        let across = foot.try_normalize()?;
        let distance = foot.length();
        if l0 <= 0.0 && l1 >= 0.0 {
            let (start, end) = (l0.atan2(distance), l1.atan2(distance));
            return Some(Self { x: across, y: tangent, start, end, distance, from_foot: true });
        }
        // On one side of the foot angles count from the line's own direction: for a line that all but lies on a ray they are small
        // numbers with all their digits, where those from the foot would be π/2 and little more.
        let outward = tangent * l0.signum();
        let (near, far) = (distance.atan2(l0.abs()), distance.atan2(l1.abs()));
        let (start, end) = (near.min(far), near.max(far));
        Some(Self { x: outward, y: across, start, end, distance, from_foot: false })
    }

    fn direction(&self, t: f64) -> DVec3 {
        self.x * t.cos() + self.y * t.sin()
    }

    /// 1/‖p‖ of the point in direction t.
    fn inverse_distance(&self, t: f64) -> f64 {
        (if self.from_foot { t.cos() } else { t.sin() }) / self.distance
    }
}

/// The integral over a surface that is swept by segments: `∫ weight(s) · integrate(segment(s)) ds` over `[from, to]`. Peaks
/// in s that are narrower than a hundredth of the interval can be missed.
pub(crate) fn sweep<L: Lobe>(
    along: &Along<'_, L>,
    [from, to]: [f64; 2],
    tolerance: Tolerance,
    segment: impl Fn(f64) -> (f64, [DVec3; 2]),
) -> Result<Estimate, ReferenceError> {
    let step = (to - from) / PANELS as f64;
    let tolerance = Tolerance { absolute: tolerance.absolute / PANELS as f64, ..tolerance };
    let mut total = Estimate::default();
    for i in 0..PANELS {
        let start = from + step * i as f64;
        let panel = sweep_panel(along, [start, start + step], tolerance, &segment)?;
        total.value += panel.value;
        total.error += panel.error;
        total.evaluations += panel.evaluations;
    }
    Ok(total)
}

fn sweep_panel<L: Lobe>(
    along: &Along<'_, L>,
    [from, to]: [f64; 2],
    tolerance: Tolerance,
    segment: impl Fn(f64) -> (f64, [DVec3; 2]),
) -> Result<Estimate, ReferenceError> {
    let mut failure = None;
    let mut evaluations = 0;
    let value = integrate_1d(
        |s| {
            let (weight, [a, b]) = segment(s);
            if weight == 0.0 || failure.is_some() {
                return 0.0;
            }
            // Far inside the outer tolerance, so that the outer rule does not chase the inner one's error.
            let absolute = INNER * tolerance.absolute / ((to - from) * weight.abs());
            let inner = Tolerance { absolute, relative: INNER * tolerance.relative, ..tolerance };
            let estimate = along.integrate(a, b, inner).unwrap_or_else(|error| {
                failure = Some(error);
                Estimate::default()
            });
            evaluations += estimate.evaluations;
            weight * estimate.value
        },
        from,
        to,
        tolerance,
    );
    failure.map_or(value, Err).map(|v| Estimate {
        error: v.error + INNER * (tolerance.absolute + tolerance.relative * v.value),
        evaluations,
        ..v
    })
}
