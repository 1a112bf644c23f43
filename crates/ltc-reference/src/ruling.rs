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
    /// With `l = d tan θ`, d the distance of the line from the origin, it is `∫ D(ω(θ)) cos θ / d dθ`. The interval is
    /// cut where the line meets the lobe's planes, and at some of the angles nearest to the lobe's hints.
    pub fn integrate(&self, a: DVec3, b: DVec3, tolerance: Tolerance) -> Result<Estimate, ReferenceError> {
        let Some(tangent) = (b - a).try_normalize() else { return Ok(Estimate::default()) };
        let (l0, l1) = (a.dot(tangent), b.dot(tangent));
        // The foot of the perpendicular, from the nearer end, which loses fewer digits.
        let nearer = if l0.abs() < l1.abs() { a } else { b };
        let foot = nearer - tangent * nearer.dot(tangent);
        let Some(across) = foot.try_normalize() else { return Ok(Estimate::default()) };
        let distance = foot.length();
        let direction = |theta: f64| across * theta.cos() + tangent * theta.sin();
        let limits = self.limits(l0.atan2(distance), l1.atan2(distance), across, tangent);
        let pieces = limits.len() - 1;
        let tolerance = Tolerance { absolute: tolerance.absolute / pieces as f64, ..tolerance };
        let mut total = Estimate::default();
        for pair in limits.windows(2) {
            let middle = direction(0.5 * (pair[0] + pair[1]));
            if self.half_spaces.iter().any(|n| n.dot(middle) <= 0.0) {
                continue;
            }
            let integrand = |theta: f64| self.lobe.density(direction(theta)) * theta.cos() / distance;
            let piece = integrate_1d(integrand, pair[0], pair[1], tolerance)?;
            total.value += piece.value;
            total.error += piece.error;
            total.evaluations += piece.evaluations;
        }
        Ok(total)
    }

    /// Ascending angles from `start` to `end` between which the integrand is smooth.
    fn limits(&self, start: f64, end: f64, across: DVec3, tangent: DVec3) -> Vec<f64> {
        let inside = |theta: &f64| *theta > start + MIN_PIECE && *theta < end - MIN_PIECE;
        let mut hints: Vec<f64> =
            self.hints.iter().map(|w| w.dot(tangent).atan2(w.dot(across))).filter(inside).collect();
        hints.sort_by(f64::total_cmp);
        let step = hints.len().div_ceil(QUANTILES).max(1);
        let mut limits: Vec<f64> = hints.into_iter().step_by(step).collect();
        for n in &self.kinks {
            // n · ω(θ) = 0.
            let theta = (-n.dot(across)).atan2(n.dot(tangent));
            limits.extend([theta - PI, theta, theta + PI].iter().filter(|t| inside(t)));
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
