//! Densities that lobes of unknown shape are sampled with.

use core::f64::consts::{PI, TAU};

use glam::DVec3;
use ltc_core::{Alpha, Ggx};

/// Share of the visible normals of GGX in [`mixture`]; the cosine and the hemisphere have half of the rest each.
const VISIBLE_NORMALS: f64 = 0.5;
const COSINE: f64 = 0.25;
const HEMISPHERE: f64 = 1.0 - VISIBLE_NORMALS - COSINE;

/// A direction for `u` ∈ [0, 1)² by visible normals of GGX of these widths (½), by the cosine (¼) or anywhere above the
/// horizon (¼): narrow lobes around the mirror direction, broad ones, and those that graze the surface.
pub fn mixture(wo: DVec3, alpha: Alpha, u: [f64; 2]) -> DVec3 {
    let [first, second] = u;
    if first < VISIBLE_NORMALS {
        return Ggx::<f64>::new(alpha).sample(wo, [first / VISIBLE_NORMALS, second]);
    }
    let rest = first - VISIBLE_NORMALS;
    if rest < COSINE {
        cosine([rest / COSINE, second])
    } else {
        hemisphere([(rest - COSINE) / HEMISPHERE, second])
    }
}

/// The density of [`mixture`] in 1/sr; 0 below the horizon (where only the visible normals lead).
pub fn mixture_pdf(wo: DVec3, wi: DVec3, alpha: Alpha) -> f64 {
    if wi.z <= 0.0 {
        return 0.0;
    }
    VISIBLE_NORMALS * Ggx::<f64>::new(alpha).pdf(wo, wi) + COSINE * cosine_pdf(wi) + HEMISPHERE / TAU
}

/// A direction by the cosine (½) or anywhere above the horizon (½), for `u` ∈ [0, 1)²: for diffuse lobes, which may rise
/// towards the horizon.
pub fn broad(u: [f64; 2]) -> DVec3 {
    let [first, second] = u;
    if first < 0.5 { cosine([2.0 * first, second]) } else { hemisphere([2.0 * first - 1.0, second]) }
}

/// The density of [`broad`] in 1/sr; 0 below the horizon.
pub fn broad_pdf(wi: DVec3) -> f64 {
    if wi.z > 0.0 { 0.5 * (cosine_pdf(wi) + 1.0 / TAU) } else { 0.0 }
}

/// A direction of density [`cosine_pdf`] for `u` ∈ [0, 1)².
pub fn cosine(u: [f64; 2]) -> DVec3 {
    around_normal((1.0 - u[0]).max(0.0).sqrt(), u[0].max(0.0).sqrt(), u[1])
}

/// `max(0, cos θ) / π` in 1/sr.
pub fn cosine_pdf(wi: DVec3) -> f64 {
    wi.z.max(0.0) / PI
}

/// A direction anywhere above the horizon, density 1/2π, for `u` ∈ [0, 1)².
pub fn hemisphere(u: [f64; 2]) -> DVec3 {
    let z = 1.0 - u[0];
    around_normal(z, ((1.0 - z) * (1.0 + z)).max(0.0).sqrt(), u[1])
}

fn around_normal(cos: f64, sin: f64, turn: f64) -> DVec3 {
    let (sin_phi, cos_phi) = (TAU * turn).sin_cos();
    DVec3::new(sin * cos_phi, sin * sin_phi, cos)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::direction;
    use ltc_core::points::r2;

    /// Shares of samples in bins of the hemisphere against the integral of the density over each.
    fn largest_difference(pdf: impl Fn(DVec3) -> f64, sample: impl Fn([f64; 2]) -> DVec3) -> f64 {
        const BINS: usize = 6;
        const FINE: usize = 60;
        const SAMPLES: usize = 1 << 16;
        let mut shares = [[0.0; BINS]; BINS];
        for i in 0..SAMPLES {
            let w = sample(r2(i, [0.5, 0.5]));
            if w.z > 0.0 {
                let turn = (w.y.atan2(w.x) / TAU + 1.0).fract();
                shares[(w.z * BINS as f64).min(5.0) as usize][(turn * BINS as f64) as usize] +=
                    1.0 / SAMPLES as f64;
            }
        }
        let mut largest = 0.0_f64;
        for (row, shares) in shares.iter().enumerate() {
            for (column, share) in shares.iter().enumerate() {
                let mut mass = 0.0;
                for i in 0..FINE * FINE {
                    let place =
                        |k: usize, bin: usize| (bin as f64 + (k as f64 + 0.5) / FINE as f64) / BINS as f64;
                    let (z, turn) = (place(i / FINE, row), place(i % FINE, column));
                    mass += pdf(around_normal(z, (1.0 - z * z).sqrt(), turn));
                }
                mass *= TAU / (BINS * BINS * FINE * FINE) as f64;
                largest = largest.max((mass - share).abs());
            }
        }
        largest
    }

    #[test]
    fn samples_have_the_density_that_they_say() {
        for (theta, alpha) in [(0.0, 0.5), (0.9, 0.3), (1.5, 1.0)] {
            let (wo, alpha) = (direction(theta, 0.4), Alpha::isotropic(alpha).unwrap());
            let difference = largest_difference(|wi| mixture_pdf(wo, wi, alpha), |u| mixture(wo, alpha, u));
            assert!(difference < 2e-3, "{theta} {alpha:?}: {difference}");
        }
        assert!(largest_difference(cosine_pdf, cosine) < 1e-3);
        assert!(largest_difference(broad_pdf, broad) < 1e-3);
        assert!(largest_difference(|_| 1.0 / TAU, hemisphere) < 1e-3);
        // The control: the one's samples with the other's density.
        assert!(largest_difference(cosine_pdf, hemisphere) > 0.02);
    }

    #[test]
    fn corners_of_the_square_are_directions() {
        let (wo, alpha) = (direction(1.2, 0.0), Alpha::isotropic(0.2).unwrap());
        for a in [0.0, 0.499_999_999, 0.5, 0.75, 1.0 - 1e-16] {
            for b in [0.0, 0.5, 1.0 - 1e-16] {
                let w = mixture(wo, alpha, [a, b]);
                assert!((w.length() - 1.0).abs() < 1e-9, "{a} {b}: {w}");
                assert!(mixture_pdf(wo, w, alpha) >= 0.0);
            }
        }
    }
}
