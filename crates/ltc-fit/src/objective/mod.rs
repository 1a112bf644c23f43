//! What a fit lowers, chosen by name.

use glam::DMat3;

use crate::{FitError, Lobe};

mod kernel;
mod kl;
mod l3;
mod sliced_wasserstein;
mod total_variation;

pub use kl::{KL_FLOOR, kl, kl_gradient, kullback_leibler};
pub use l3::{cube_of_lobe, cube_of_ltc, l3, l3_gradient};
pub use sliced_wasserstein::{
    SlicedWasserstein, WASSERSTEIN_AXES, WASSERSTEIN_LOBE_SAMPLES, WASSERSTEIN_SAMPLES,
};
pub use total_variation::{total_variation, total_variation_gradient};

/// A measure of how far an LTC is from a lobe, with its gradient in closed form.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Objective {
    /// `½∫|p − q|` ([`total_variation`]): the largest share of the light that any light can be wrong by.
    #[default]
    TotalVariation,
    /// [`SlicedWasserstein`], the 2022 paper's.
    SlicedWasserstein,
    /// `∫|p − q|³` ([`l3`]), the 2016 paper's.
    L3,
    /// [`kl`]: Kullback and Leibler's divergence, floored where it is not defined.
    Kl,
}

impl Objective {
    /// All there are.
    pub const ALL: [Self; 4] = [Self::TotalVariation, Self::SlicedWasserstein, Self::L3, Self::Kl];

    /// Its name in specifications.
    pub fn name(self) -> &'static str {
        match self {
            Self::TotalVariation => "total_variation",
            Self::SlicedWasserstein => "sliced_wasserstein",
            Self::L3 => "l3",
            Self::Kl => "kl",
        }
    }

    /// The objective of that name.
    ///
    /// # Errors
    /// [`FitError::Spec`] for an unknown name, with those there are.
    pub fn by_name(name: &str) -> Result<Self, FitError> {
        Self::ALL.into_iter().find(|objective| objective.name() == name).ok_or_else(|| FitError::Spec {
            field: "objective",
            reason: format!("\"{name}\" is not known; there are: {}", Self::ALL.map(Self::name).join(", ")),
        })
    }

    /// The objective with this lobe as its goal.
    pub fn towards(self, lobe: &Lobe) -> Goal<'_> {
        let (kind, unit) = match self {
            Self::TotalVariation => (Kind::TotalVariation, 1.0),
            Self::SlicedWasserstein => {
                let sliced = SlicedWasserstein::new(lobe);
                let spread = sliced.spread();
                (Kind::SlicedWasserstein(sliced), spread)
            }
            Self::L3 => (Kind::L3, cube_of_lobe(lobe)),
            Self::Kl => (Kind::Kl, 1.0),
        };
        let unit = if unit > 0.0 && unit.is_finite() { unit } else { 1.0 };
        Goal { lobe, kind, unit }
    }
}

/// An [`Objective`] for one lobe, with what of it does not depend on `M`.
#[derive(Clone, Debug)]
pub struct Goal<'a> {
    lobe: &'a Lobe,
    kind: Kind,
    unit: f64,
}

#[derive(Clone, Debug)]
enum Kind {
    TotalVariation,
    SlicedWasserstein(SlicedWasserstein),
    L3,
    Kl,
}

impl<'a> Goal<'a> {
    /// What is to be approximated.
    pub fn lobe(&self) -> &'a Lobe {
        self.lobe
    }

    /// The value at `M = target_from_cosine`; never NaN, possibly +∞ for a singular matrix.
    pub fn value(&self, m: DMat3) -> f64 {
        match &self.kind {
            Kind::TotalVariation => total_variation(self.lobe, m),
            Kind::SlicedWasserstein(sliced) => sliced.value(m),
            Kind::L3 => l3(self.lobe, m),
            Kind::Kl => kl(self.lobe, m),
        }
    }

    /// The value, and its derivative by every entry of `M`.
    pub fn value_and_gradient(&self, m: DMat3) -> (f64, DMat3) {
        match &self.kind {
            Kind::TotalVariation => total_variation_gradient(self.lobe, m),
            Kind::SlicedWasserstein(sliced) => sliced.value_and_gradient(m),
            Kind::L3 => l3_gradient(self.lobe, m),
            Kind::Kl => kl_gradient(self.lobe, m),
        }
    }

    pub(crate) fn is_total_variation(&self) -> bool {
        matches!(self.kind, Kind::TotalVariation)
    }

    /// A value that makes a bad fit of this lobe about 1: optimisers divide by it, as L³ of narrow lobes reaches 1e12 and
    /// the Wasserstein distance there 1e-4.
    pub fn unit(&self) -> f64 {
        self.unit
    }
}

#[cfg(test)]
pub(crate) mod testing;

#[cfg(test)]
mod tests {
    use super::*;
    use testing::{lobe, matrix, rotated};

    #[test]
    fn names_lead_back() {
        for objective in Objective::ALL {
            assert_eq!(Objective::by_name(objective.name()).unwrap(), objective);
        }
        let message = Objective::by_name("l2").unwrap_err().to_string();
        assert_eq!(
            message,
            "objective: \"l2\" is not known; there are: total_variation, sliced_wasserstein, l3, kl"
        );
    }

    /// The largest difference between a gradient and difference quotients, of all nine entries, relative to the largest
    /// of the gradient.
    fn mismatch(goal: &Goal<'_>, m: DMat3, gradient: DMat3) -> f64 {
        const H: f64 = 1e-6;
        let step = |i: usize, h: f64| {
            let mut entries = m.to_cols_array();
            entries[i] += h;
            goal.value(DMat3::from_cols_array(&entries))
        };
        let gradient = gradient.to_cols_array();
        let size = gradient.into_iter().fold(0.01_f64, |a, g| a.max(g.abs()));
        (0..9)
            .map(|i| ((step(i, H) - step(i, -H)) / (2.0 * H) - gradient[i]).abs() / size)
            .fold(0.0, f64::max)
    }

    const TOLERANCE: f64 = 2e-4;

    #[test]
    fn gradients_are_difference_quotients() {
        let lobe = lobe(2000);
        for objective in Objective::ALL {
            let goal = objective.towards(&lobe);
            // Where the lobes overlap, and where they hardly do.
            for m in [matrix(), DMat3::IDENTITY, rotated(matrix(), 1.0)] {
                let (value, gradient) = goal.value_and_gradient(m);
                assert!((value - goal.value(m)).abs() < 1e-12 * (1.0 + value));
                let off = mismatch(&goal, m, gradient);
                assert!(off < TOLERANCE, "{}: {off}", objective.name());
            }
        }
    }

    #[test]
    fn a_wrong_gradient_is_seen() {
        // The control of the test above: a hundredth too much of the part that comes from det M.
        let lobe = lobe(2000);
        for objective in Objective::ALL {
            let goal = objective.towards(&lobe);
            let (value, gradient) = goal.value_and_gradient(matrix());
            let wrong = gradient + matrix().inverse().transpose() * (0.01 * value);
            let off = mismatch(&goal, matrix(), wrong);
            assert!(off > TOLERANCE, "{}: {off}", objective.name());
        }
    }
}
