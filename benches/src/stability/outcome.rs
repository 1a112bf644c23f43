//! What a sweep found.

use ltc_core::{Real, points::SplitMix64};

use super::{Case, Form, Sweep, oracle};

/// What a shape may be off by, absolutely.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bound {
    /// Of `f32`, where cond(M) ≤ 100; beyond, times cond(M)/100.
    pub f32_at_most: f64,
    /// Of `f64`.
    pub f64_at_most: f64,
}

impl Bound {
    /// The bound that the documents of a shape state.
    pub fn of(form: Form) -> Self {
        let [f32_at_most, f64_at_most] = match form {
            Form::Polygon | Form::Quad => [2e-5, 1e-9],
            Form::Line | Form::Strip => [1e-4, 1e-9],
            Form::Disk | Form::Ellipse | Form::Sphere => [1e-4, 1e-8],
            Form::Tube | Form::Cylinder => [1e-4, 1e-6],
        };
        Self { f32_at_most, f64_at_most }
    }

    /// That of `f32` at this condition number.
    pub fn at(self, condition: f64) -> f64 {
        self.f32_at_most * (condition / 100.0).max(1.0)
    }
}

/// Errors of one shape at one value of a sweep.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outcome {
    /// Largest error of `f32`.
    pub f32_max: f64,
    /// Root mean square error of `f32`.
    pub f32_rms: f64,
    /// Largest error of `f32` as a share of the [`Bound`].
    pub f32_share: f64,
    /// Largest error of `f64`.
    pub f64_max: f64,
    /// Largest value: a sweep that sees no light shows nothing.
    pub brightest: f64,
}

impl Outcome {
    /// Over `count` random cases. An error from any precision, a value that is not in [0, 1], or a NaN counts as infinitely
    /// far off.
    pub fn of(sweep: Sweep, value: f64, form: Form, count: usize) -> Self {
        let mut rng = SplitMix64::new(1 + count as u64);
        let mut outcome = Self::default();
        for _ in 0..count {
            outcome.add(&sweep.case(value, form, &mut rng), Bound::of(form));
        }
        outcome.f32_rms = (outcome.f32_rms / count as f64).sqrt();
        outcome
    }

    fn add(&mut self, case: &Case, bound: Bound) {
        let exact = oracle(case);
        let off = |value: f64| {
            let error = (value - exact).abs();
            if error.is_finite() { error } else { f64::INFINITY }
        };
        let (single, double) = (off(fraction::<f32>(case)), off(fraction::<f64>(case)));
        self.f32_max = self.f32_max.max(single);
        self.f32_rms += single * single;
        self.f32_share = self.f32_share.max(single / bound.at(case.condition()));
        self.f64_max = self.f64_max.max(double);
        self.brightest = self.brightest.max(exact);
    }
}

fn fraction<R: Real>(case: &Case) -> f64 {
    match case.fraction::<R>() {
        Ok(value) if (0.0..=1.0).contains(&value) => value,
        _ => f64::INFINITY,
    }
}
