//! The sliced Wasserstein distance between a lobe and an LTC, and its gradient.

use core::f64::consts::TAU;

use glam::{DMat3, DVec3};

use crate::Lobe;

/// The sliced Wasserstein distance to one lobe (KT et al. 2022, eq. 9 and 10), as their Algorithm 3 has it but without
/// its noise: the directions of the cosine, the directions to project onto and the lobe's samples stay the same throughout a fit,
/// so that the distance is a function of `M` that a quasi-Newton method can lower.
///
/// `L(M) = mean over axes a of 1/n Σᵢ |f₍ᵢ₎·a − gᵢ(a)|`, with `f₍ᵢ₎·a` the projections of the n LTC samples `Mωᵢ/‖Mωᵢ‖`
/// in increasing order and `gᵢ(a)` the mean of the lobe's inverse distribution function along `a` over [i/n, (i+1)/n].
/// Its unit is that of directions on the unit sphere: in [0, 2]. The samples of the lobe carry weights where the paper rejects.
///
/// The width of a thin lobe is seen only along the few axes across it: narrow lobes at grazing views may be fitted far too thin.
#[derive(Clone, Debug)]
pub struct SlicedWasserstein {
    axes: Vec<DVec3>,
    cosine: Vec<DVec3>,
    /// `cosine.len()` increasing numbers for each axis.
    quantiles: Vec<f64>,
}

/// Axes that are projected onto by default. The paper draws 64 fresh ones for each step; laid out evenly, half of them do.
pub const WASSERSTEIN_AXES: usize = 32;
/// Samples of the LTC by default. The paper draws 2,048 fresh ones for each step.
pub const WASSERSTEIN_SAMPLES: usize = 1024;
/// Samples of the lobe that a fit needs at least. With 512 of them, or of the LTC, 3 of the 114 narrowest lobes in 1,200 of the standard
/// draw collapse to a line, which hardly changes the distance of a thin lobe; with as many as here 1 does.
pub const WASSERSTEIN_LOBE_SAMPLES: usize = 2048;

/// Point `i` of `n` in the unit square, which lie on a disk or a hemisphere as a sunflower's seeds do: evenly whichever way they are
/// turned.
fn seed(i: usize, n: usize) -> [f64; 2] {
    const GOLDEN_SECTION: f64 = 0.618_033_988_749_894_9;
    [(i as f64 + 0.5) / n as f64, (i as f64 * GOLDEN_SECTION).fract()]
}

impl SlicedWasserstein {
    /// The distance to `lobe` with [`WASSERSTEIN_AXES`] and [`WASSERSTEIN_SAMPLES`].
    pub fn new(lobe: &Lobe) -> Self {
        Self::with_resolution(lobe, WASSERSTEIN_AXES, WASSERSTEIN_SAMPLES)
    }

    /// The distance to `lobe` by so many axes and samples of the LTC, at least one of each.
    pub fn with_resolution(lobe: &Lobe, axes: usize, samples: usize) -> Self {
        let (axes, samples) = (axes.max(1), samples.max(1));
        let axes: Vec<DVec3> = (0..axes).map(|i| axis(seed(i, axes))).collect();
        // Each seed with its opposite: the far samples of a narrow lobe's tail then pull to no side, and the gauge of M
        // matters little.
        let opposite = |i: usize| {
            let [u, v] = seed(i / 2, samples.div_ceil(2));
            [u, 0.5 * (v + (i % 2) as f64)]
        };
        let cosine = (0..samples).map(|i| cosine(opposite(i))).collect();
        let mut quantiles = Vec::with_capacity(axes.len() * samples);
        for axis in &axes {
            stratum_means(lobe, *axis, samples, &mut quantiles);
        }
        Self { axes, cosine, quantiles }
    }

    /// `L(M)`.
    pub fn value(&self, m: DMat3) -> f64 {
        self.evaluate(m, |_, _, _| ())
    }

    /// `L(M)` and its derivative by every entry of `M`.
    pub fn value_and_gradient(&self, m: DMat3) -> (f64, DMat3) {
        // Where each sample is pulled from, along all axes.
        let mut pull = vec![DVec3::ZERO; self.cosine.len()];
        let value = self.evaluate(m, |axis, sample, difference| {
            if difference != 0.0 {
                pull[sample] += axis * difference.signum();
            }
        });
        let mut gradient = DMat3::ZERO;
        for (wo, pull) in self.cosine.iter().zip(pull) {
            let moved = m * *wo;
            let length = moved.length();
            if length > 0.0 {
                let f = moved / length;
                let by_moved = (pull - f * f.dot(pull)) / length;
                gradient += DMat3::from_cols(by_moved * wo.x, by_moved * wo.y, by_moved * wo.z);
            }
        }
        (value, gradient * (1.0 / (self.axes.len() * self.cosine.len()) as f64))
    }

    /// How far the lobe's samples lie from their median along each axis, on average: the distance of a point from the lobe.
    pub fn spread(&self) -> f64 {
        let n = self.cosine.len();
        let along = |quantiles: &[f64]| quantiles.iter().map(|g| (g - quantiles[n / 2]).abs()).sum::<f64>();
        self.quantiles.chunks(n).map(along).sum::<f64>() / self.quantiles.len() as f64
    }

    /// The projections on axis `a` (of [`SlicedWasserstein::axes`]), both in increasing order: of the LTC's samples, and
    /// what they are compared with. Figure 5 of the paper.
    pub fn projections(&self, m: DMat3, a: usize) -> (Vec<f64>, Vec<f64>) {
        let n = self.cosine.len();
        let mut of_ltc: Vec<f64> = self.cosine.iter().map(|w| direction(m, *w).dot(self.axes[a])).collect();
        of_ltc.sort_unstable_by(f64::total_cmp);
        (of_ltc, self.quantiles[a * n..(a + 1) * n].to_vec())
    }

    /// What is projected onto.
    pub fn axes(&self) -> &[DVec3] {
        &self.axes
    }

    /// The value; tells `each` the axis, the index of the sample and `f·a − g` for every pair.
    fn evaluate(&self, m: DMat3, mut each: impl FnMut(DVec3, usize, f64)) -> f64 {
        let n = self.cosine.len();
        let samples: Vec<DVec3> = self.cosine.iter().map(|w| direction(m, *w)).collect();
        let mut order: Vec<(f64, u32)> = Vec::with_capacity(n);
        let mut sum = 0.0;
        for (axis, quantiles) in self.axes.iter().zip(self.quantiles.chunks(n)) {
            order.clear();
            order.extend((0..).zip(&samples).map(|(i, f)| (f.dot(*axis), i)));
            order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
            for ((f, i), g) in order.iter().zip(quantiles) {
                sum += (f - g).abs();
                each(*axis, *i as usize, f - g);
            }
        }
        sum / self.quantiles.len() as f64
    }
}

/// `Mω/‖Mω‖`; the direction itself where that is none.
fn direction(m: DMat3, w: DVec3) -> DVec3 {
    (m * w).try_normalize().unwrap_or(w)
}

/// A uniform direction of the upper hemisphere: opposite axes give the same distance.
fn axis([u, v]: [f64; 2]) -> DVec3 {
    crate::direction(u.acos(), TAU * v)
}

fn cosine([u, v]: [f64; 2]) -> DVec3 {
    crate::direction(u.sqrt().asin(), TAU * v)
}

/// Appends the means of the inverse distribution function along `axis` over [i/n, (i+1)/n], i from 0 to n − 1.
fn stratum_means(lobe: &Lobe, axis: DVec3, n: usize, means: &mut Vec<f64>) {
    let mut sorted: Vec<(f64, f64)> = (0..lobe.len())
        .filter(|i| lobe.weight[*i] > 0.0)
        .map(|i| (lobe.direction(i).dot(axis), lobe.weight[i]))
        .collect();
    sorted.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let total: f64 = sorted.iter().map(|(_, weight)| weight).sum();
    let mut samples = sorted.iter().map(|(x, weight)| (*x, weight / total)).peekable();
    // What is left of the sample that the last stratum ended in.
    let (mut x, mut left) = samples.next().unwrap_or((axis.z, 1.0));
    for _ in 0..n {
        let (mut room, mut sum) = (1.0 / n as f64, 0.0);
        while left < room && samples.peek().is_some() {
            sum += x * left;
            room -= left;
            (x, left) = samples.next().unwrap_or((x, 0.0));
        }
        sum += x * room;
        left -= room;
        means.push(sum * n as f64);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::objective::testing::{lobe, lobe_of, matrix, rotated};

    #[test]
    fn strata_keep_the_mean_and_the_order() {
        let lobe = lobe(1000);
        let axis = DVec3::new(0.6, 0.0, 0.8);
        let mut means = Vec::new();
        stratum_means(&lobe, axis, 37, &mut means);
        let mean: f64 = (0..lobe.len()).map(|i| lobe.weight[i] * lobe.direction(i).dot(axis)).sum();
        assert!((means.iter().sum::<f64>() / 37.0 - mean).abs() < 1e-12);
        assert!(means.is_sorted());
    }

    #[test]
    fn it_is_zero_for_the_lobe_itself_and_grows_with_the_turn() {
        let ltc = matrix();
        let sliced = SlicedWasserstein::new(&lobe_of(ltc, 4096));
        let own = sliced.value(ltc);
        assert!(own < 4e-3, "{own}");
        // Far beyond where densities overlap it still grows: nothing like a null gradient.
        let turned: Vec<f64> = [0.0, 0.1, 0.4, 0.8, 1.6, 3.0]
            .map(|angle| sliced.value(DMat3::from_rotation_y(angle) * ltc))
            .to_vec();
        assert!(turned.is_sorted(), "{turned:?}");
        assert!(turned[5] > 0.5, "{turned:?}");
    }

    /// A narrow lobe moved by a small angle moves by that angle, times the mean |cos| of axes against the way.
    #[test]
    fn a_small_move_of_a_narrow_lobe_costs_half_its_length() {
        let narrow =
            |angle: f64| DMat3::from_rotation_y(angle) * DMat3::from_diagonal(DVec3::new(1e-4, 1e-4, 1.0));
        let sliced = SlicedWasserstein::with_resolution(&lobe_of(narrow(0.3), 1024), 4096, 64);
        let moved = sliced.value(narrow(0.31));
        assert!((moved / 0.005 - 1.0).abs() < 0.02, "{moved}");
    }

    #[test]
    fn resolution_matters_little() {
        let lobe = lobe(4096);
        let fine = SlicedWasserstein::with_resolution(&lobe, 1024, 4096);
        let usual = SlicedWasserstein::new(&lobe);
        for m in [matrix(), DMat3::IDENTITY, rotated(matrix(), 0.5)] {
            let (a, b) = (fine.value(m), usual.value(m));
            assert!((a / b - 1.0).abs() < 0.02, "{a} {b}");
        }
    }

    #[test]
    fn degenerate_matrices_and_lobes_have_a_value() {
        let sliced = SlicedWasserstein::with_resolution(&lobe(256), 8, 32);
        for m in
            [DMat3::ZERO, DMat3::from_diagonal(DVec3::Z), DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0))]
        {
            let (value, gradient) = sliced.value_and_gradient(m);
            assert!(value.is_finite() && gradient.is_finite(), "{m}: {value} {gradient}");
        }
        let empty = SlicedWasserstein::with_resolution(&Lobe::default(), 0, 0);
        assert!(empty.value(matrix()).is_finite());
    }
}
