//! Where an entry's fit starts: the medians of the lobe.

use glam::{DMat3, DVec3};
use ltc_core::Vector;

use crate::{Lobe, Pattern};

/// A median absolute deviation times this is the scale of a cosine seen in the gnomonic plane: half of a clamped cosine
/// lies within |x/z| < 1/√3 of any plane through its axis.
const COSINE_FROM_MEDIAN_DEVIATION: f64 = 1.732;

/// Smallest slope of a direction against the plane's normal: nearer to the horizon of the plane it is drawn in.
const MIN_COSINE: f64 = 0.02;

/// A first guess of `M`: third column the median direction of the lobe (2016 paper, §3.1), the others orthogonal to it
/// along the axes of its shape in the gnomonic plane, as long as its median absolute deviation along each.
///
/// Medians, not means: the tails of GGX pull the mean off a narrow lobe by more than the lobe's width.
pub fn median_start(lobe: &Lobe, wo: DVec3, pattern: Pattern) -> DMat3 {
    let mut z = DVec3::new(-wo.x, -wo.y, wo.z.max(0.03)).try_unit().unwrap_or(DVec3::Z);
    let mut buffer = Vec::with_capacity(lobe.len());
    for _ in 0..3 {
        let (t, b) = tangents(z);
        let [mt, mb] = [t, b].map(|axis| median(lobe, &mut buffer, |w| gnomonic(w, axis, z)));
        z = pattern.centre(z + t * mt + b * mb);
    }
    let (t, b) = shape_axes(lobe, z, pattern);
    let [wt, wb] = [t, b].map(|axis| {
        let deviation = median(lobe, &mut buffer, |w| gnomonic(w, axis, z).abs());
        (COSINE_FROM_MEDIAN_DEVIATION * deviation).max(1e-7)
    });
    DMat3::from_cols(t * wt, b * wb, z)
}

impl Pattern {
    /// The direction, in the planes of symmetry.
    fn centre(self, z: DVec3) -> DVec3 {
        let centred = match self {
            Self::General => z,
            Self::MirrorY => DVec3::new(z.x, 0.0, z.z),
            Self::MirrorX => DVec3::new(0.0, z.y, z.z),
            Self::Diagonal | Self::Round => DVec3::Z,
        };
        centred.try_unit().unwrap_or(DVec3::Z)
    }
}

/// The axes of the lobe's shape in the gnomonic plane of `z`: eigenvectors of Tyler's shape matrix (1987), which no tail
/// can pull: `Σ ← 2 Σᵢ wᵢ xᵢxᵢᵀ / (xᵢᵀ Σ⁻¹ xᵢ)`. A lobe with a plane of symmetry has its axes in and across it.
fn shape_axes(lobe: &Lobe, z: DVec3, pattern: Pattern) -> (DVec3, DVec3) {
    let (t, b) = tangents(z);
    if pattern != Pattern::General {
        return (t, b);
    }
    let points: Vec<(f64, f64, f64)> = (0..lobe.len())
        .map(|i| (gnomonic(lobe.direction(i), t, z), gnomonic(lobe.direction(i), b, z), lobe.weight[i]))
        .collect();
    let (mut xx, mut xy, mut yy) = (1.0, 0.0, 1.0);
    for _ in 0..30 {
        let determinant: f64 = xx * yy - xy * xy;
        let mut next = (0.0, 0.0, 0.0);
        for (x, y, weight) in &points {
            let square = (yy * x * x - 2.0 * xy * x * y + xx * y * y) / determinant;
            if square > 0.0 {
                let share = weight / square;
                next = (next.0 + share * x * x, next.1 + share * x * y, next.2 + share * y * y);
            }
        }
        let trace = next.0 + next.2;
        // Thin lobes converge to a line; stop while the inverse is still meaningful.
        let flat = next.0 * next.2 - next.1 * next.1 <= 1e-12 * trace * trace;
        if !(trace > 0.0 && trace.is_finite()) || flat {
            break;
        }
        (xx, xy, yy) = (next.0 / trace, next.1 / trace, next.2 / trace);
    }
    let (sin, cos) = (0.5 * (2.0 * xy).atan2(xx - yy)).sin_cos();
    (t * cos + b * sin, b * cos - t * sin)
}

fn gnomonic(w: DVec3, axis: DVec3, z: DVec3) -> f64 {
    w.dot(axis) / w.dot(z).max(MIN_COSINE)
}

/// The tangent nearest to +x, and the one that makes the frame right-handed.
fn tangents(z: DVec3) -> (DVec3, DVec3) {
    let t = (DVec3::X - z * z.x).try_unit().unwrap_or(DVec3::Z);
    (t, z.cross(t))
}

/// Median of a quantity over the lobe, by weight.
fn median(lobe: &Lobe, buffer: &mut Vec<(f64, f64)>, quantity: impl Fn(DVec3) -> f64) -> f64 {
    buffer.clear();
    buffer.extend((0..lobe.len()).map(|i| (quantity(lobe.direction(i)), lobe.weight[i])));
    buffer.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let mut below = 0.0;
    for (value, weight) in buffer.iter() {
        below += weight;
        if below >= 0.5 {
            return *value;
        }
    }
    0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Brdf, DiskPoints, GgxFamily, total_variation};
    use core::f64::consts::FRAC_PI_2;
    use ltc_core::Alpha;

    #[test]
    fn it_is_near_the_lobe_everywhere() {
        let points = DiskPoints::new(512, [0.5, 0.5]);
        let mut lobe = Lobe::default();
        for theta in [0.0, 0.6, 1.2, 1.5, 1.562] {
            for (phi, tilted) in
                [(0.0, Pattern::MirrorY), (0.7, Pattern::General), (FRAC_PI_2, Pattern::MirrorX)]
            {
                let pattern = if theta == 0.0 { Pattern::Diagonal } else { tilted };
                for (ax, ay) in
                    [(0.001, 0.001), (0.003, 0.0001), (0.1, 0.1), (0.5, 0.05), (1.0, 1.0), (1.0, 0.02)]
                {
                    let wo = crate::direction(theta, phi);
                    GgxFamily.sample_lobe(wo, Alpha::new(ax, ay).unwrap(), &points, &mut lobe);
                    let start = median_start(&lobe, wo, pattern);
                    let tv = total_variation(&lobe, start);
                    assert!(start.determinant() > 0.0);
                    assert!(tv < 0.7, "θ {theta} φ {phi} α {ax} {ay}: {tv}");
                }
            }
        }
    }
}
