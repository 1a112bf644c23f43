//! Samples of the lobe that an LTC is fitted to.

use glam::DVec3;

/// Number of samples that the kernels take at a time; arrays are padded to it with samples of weight 0.
pub(crate) const LANES: usize = 4;

/// Weighted samples of one normalised, cosine-weighted BRDF lobe `p`.
///
/// Arrays of equal length, padded to a multiple of the lanes that the kernels take. With `pdf` the density the samples were drawn from, N their number:
/// `weight = (p/pdf) / Σ(p/pdf)` and `inverse = 1 / (N pdf)`, so that `∫ max(0, p − q) ≈ Σ max(0, weight − q · inverse)`.
#[derive(Clone, Debug, Default)]
pub struct Lobe {
    /// Directions, x.
    pub x: Vec<f64>,
    /// Directions, y.
    pub y: Vec<f64>,
    /// Directions, z.
    pub z: Vec<f64>,
    /// Share of the lobe that the sample stands for; they sum to 1.
    pub weight: Vec<f64>,
    /// `1 / (N pdf)`, solid angle that the sample stands for.
    pub inverse: Vec<f64>,
    /// `n = ∫ ρ cos` at F = 1.
    pub magnitude: f64,
    /// `f = ∫ (1 − ωo·ωh)^5 ρ cos`.
    pub fresnel: f64,
}

impl Lobe {
    /// Direction `i`.
    pub fn direction(&self, i: usize) -> DVec3 {
        DVec3::new(self.x[i], self.y[i], self.z[i])
    }

    /// Number of entries, padding included.
    pub fn len(&self) -> usize {
        self.x.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.x.is_empty()
    }

    pub(crate) fn clear(&mut self) {
        for array in [&mut self.x, &mut self.y, &mut self.z, &mut self.weight, &mut self.inverse] {
            array.clear();
        }
        self.magnitude = 0.0;
        self.fresnel = 0.0;
    }

    pub(crate) fn push(&mut self, wi: DVec3, weight: f64, inverse: f64) {
        self.x.push(wi.x);
        self.y.push(wi.y);
        self.z.push(wi.z);
        self.weight.push(weight);
        self.inverse.push(inverse);
    }

    /// Whether the samples found no energy, or less than a normal number can hold.
    pub(crate) fn is_dark(&self) -> bool {
        self.weight.iter().sum::<f64>() < f64::MIN_POSITIVE
    }

    /// Gives the samples the weights of the clamped cosine, and magnitude 0.
    pub(crate) fn become_cosine(&mut self) {
        for i in 0..self.len() {
            self.weight[i] = self.z[i] * self.inverse[i];
        }
        self.finish(1);
        (self.magnitude, self.fresnel) = (0.0, 0.0);
    }

    /// Gives the samples of another lobe, drawn with `n` points, the weights of a BRDF `value` (times cosine) and the Fresnel term
    /// of its weight `fresnel`.
    pub(crate) fn reweigh(&mut self, n: usize, value: impl Fn(DVec3) -> f64, fresnel: impl Fn(DVec3) -> f64) {
        self.fresnel = 0.0;
        for i in 0..self.len() {
            let wi = self.direction(i);
            let weight = value(wi) * self.inverse[i] * n as f64;
            self.weight[i] = if weight > 0.0 && weight.is_finite() { weight } else { 0.0 };
            self.fresnel += self.weight[i] * fresnel(wi);
        }
        if self.is_dark() {
            self.become_cosine();
        } else {
            self.finish(n);
        }
    }

    /// Scales the weights to sum 1 and pads the arrays.
    pub(crate) fn finish(&mut self, n: usize) {
        let sum: f64 = self.weight.iter().sum();
        if sum > 0.0 {
            for weight in &mut self.weight {
                *weight /= sum;
            }
        }
        self.magnitude = sum / n as f64;
        self.fresnel /= n as f64;
        while !self.len().is_multiple_of(LANES) || self.is_empty() {
            self.push(DVec3::Z, 0.0, 0.0);
        }
    }
}
