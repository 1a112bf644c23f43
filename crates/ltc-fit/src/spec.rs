//! What to fit and how: every choice that the result depends on.

use core::f64::consts::FRAC_PI_2;

use ltc_table::{Axis, Floors, Mapping, Quantity, check_name};
use serde::{Deserialize, Serialize};

use crate::{
    Brdf, FitError, GgxFamily, Layout, channels::ChannelSettings, entries::EntrySettings, joint::JointSettings,
    measure::MeasureSettings,
};

/// A fit, fully specified: the same specification gives the same digest, whatever the number of threads.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FitSpec {
    /// Name of the table.
    pub name: String,
    /// Name of the BRDF: `ggx`.
    pub brdf: String,
    /// The table's axes: θ, α (isotropic) or θ, φ, α, λ.
    pub axes: Vec<Axis>,
    /// Smallest values that entries are fitted at.
    pub floors: Floors,
    /// What is minimised: `total_variation`.
    pub objective: String,
    /// Each entry by itself.
    pub entries: EntrySettings,
    /// All entries together.
    pub joint: JointSettings,
    /// Magnitude and Fresnel.
    pub channels: ChannelSettings,
    /// How the result is judged.
    pub measure: MeasureSettings,
}

impl FitSpec {
    /// Names of the presets.
    pub const PRESETS: [&'static str; 3] = ["ggx-isotropic", "ggx-anisotropic", "ggx-isotropic-dropin"];

    /// A specification by name.
    ///
    /// # Errors
    /// [`FitError::NoSuchPreset`].
    pub fn preset(name: &str) -> Result<Self, FitError> {
        let layout = if name == "ggx-isotropic-dropin" { Layout::DropIn } else { Layout::Matrix };
        let (axes, steps, learning_rate, channel_queries) = match name {
            "ggx-isotropic" | "ggx-isotropic-dropin" => {
                (ltc_table::drop_in::axes(64).to_vec(), 200, 3e-3, 20_000)
            }
            "ggx-anisotropic" => (anisotropic_axes(), 1500, 6e-3, 60_000),
            _ => {
                let known = Self::PRESETS.join(", ");
                return Err(FitError::NoSuchPreset { name: name.to_owned(), known });
            }
        };
        Ok(Self {
            name: name.to_owned(),
            brdf: GgxFamily.name().to_owned(),
            axes,
            floors: Floors { alpha: 1e-3, lambda: 0.03, theta_max: 89.5_f64.to_radians() },
            objective: "total_variation".to_owned(),
            entries: EntrySettings { samples: 512, iterations: 100 },
            joint: JointSettings { steps, queries: 2048, samples: 256, learning_rate, seed: 3, layout },
            channels: ChannelSettings { samples: 2048, queries: channel_queries, seed: 5 },
            measure: MeasureSettings { queries: 3000, samples: 4096, seed: 77, layout },
        })
    }

    /// The BRDF of that name.
    ///
    /// # Errors
    /// [`FitError::Spec`] for an unknown name.
    pub fn brdf(&self) -> Result<&'static dyn Brdf, FitError> {
        if self.brdf == GgxFamily.name() {
            Ok(&GgxFamily)
        } else {
            Err(FitError::Spec {
                field: "brdf",
                reason: format!("\"{}\" is not known; there is: ggx", self.brdf),
            })
        }
    }

    /// Checks every field.
    ///
    /// # Errors
    /// [`FitError::Spec`], naming the field and what is wrong with it.
    pub fn validate(&self) -> Result<(), FitError> {
        use Quantity::{Alpha, Lambda, Phi, Theta};
        let wrong = |field, reason: String| Err(FitError::Spec { field, reason });
        check_name(&self.name).or_else(|e| wrong("name", e.to_string()))?;
        self.brdf()?;
        if self.objective != "total_variation" {
            return wrong(
                "objective",
                format!("\"{}\" is not known; there is: total_variation", self.objective),
            );
        }
        for axis in &self.axes {
            axis.validate().or_else(|e| wrong("axes", e.to_string()))?;
            if axis.quantity == Phi && axis.domain != [0.0, FRAC_PI_2] {
                return wrong("axes", "phi must span [0, π/2]: the symmetries tie its ends".to_owned());
            }
        }
        let quantities: Vec<_> = self.axes.iter().map(|a| a.quantity).collect();
        if quantities != [Theta, Alpha] && quantities != [Theta, Phi, Alpha, Lambda] {
            return wrong(
                "axes",
                "must be theta, alpha or theta, phi, alpha, lambda in this order".to_owned(),
            );
        }
        self.validate_numbers()
    }

    fn validate_numbers(&self) -> Result<(), FitError> {
        let wrong = |field, reason: String| Err(FitError::Spec { field, reason });
        let floors = &self.floors;
        if !(floors.alpha >= ltc_core::ALPHA_MIN && floors.alpha <= 0.1) {
            return wrong("floors.alpha", format!("is {}, must be in [1e-4, 0.1]", floors.alpha));
        }
        if !(floors.lambda >= 1e-3 && floors.lambda <= 0.5) {
            return wrong("floors.lambda", format!("is {}, must be in [0.001, 0.5]", floors.lambda));
        }
        if !(floors.theta_max >= 1.0 && floors.theta_max < FRAC_PI_2) {
            return wrong("floors.theta_max", format!("is {}, must be in [1, π/2)", floors.theta_max));
        }
        let rate = self.joint.learning_rate;
        if !(rate > 0.0 && rate <= 0.1) {
            return wrong("joint.learning_rate", format!("is {rate}, must be in (0, 0.1]"));
        }
        for (field, value, low, high) in [
            ("entries.samples", self.entries.samples, 64, 1 << 20),
            ("entries.iterations", self.entries.iterations, 1, 10_000),
            ("joint.steps", self.joint.steps, 0, 1 << 20),
            ("joint.queries", self.joint.queries, 16, 1 << 20),
            ("joint.samples", self.joint.samples, 32, 1 << 20),
            ("channels.samples", self.channels.samples, 256, 1 << 20),
            ("channels.queries", self.channels.queries, 0, 1 << 22),
            ("measure.queries", self.measure.queries, 100, 1 << 20),
            ("measure.samples", self.measure.samples, 256, 1 << 20),
        ] {
            if !(low..=high).contains(&value) {
                return wrong(field, format!("is {value}, must be in [{low}, {high}]"));
            }
        }
        if self.measure.seed == self.joint.seed || self.measure.seed == self.channels.seed {
            return wrong(
                "measure.seed",
                "must differ from the seeds of the fit: errors are of unseen queries".into(),
            );
        }
        Ok(())
    }
}

/// 8⁴ nodes, denser towards grazing views and narrow widths, where lobes change fastest. The widths begin above 0: a lobe of
/// width 0 is no lobe, and an entry that stands for one would be fitted to nothing but its neighbours' wishes. Narrower
/// queries get the narrowest lobe there is.
fn anisotropic_axes() -> Vec<Axis> {
    use Quantity::{Alpha, Lambda, Phi, Theta};
    let mut alpha = Axis::full(Alpha, Mapping::Sqrt, 8);
    alpha.domain[0] = 0.005;
    let mut lambda = Axis::full(Lambda, Mapping::Sqrt, 8);
    lambda.domain[0] = 0.03;
    vec![Axis::full(Theta, Mapping::HalfTangent, 8), Axis::full(Phi, Mapping::Linear, 8), alpha, lambda]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn presets_are_valid() {
        for name in FitSpec::PRESETS {
            FitSpec::preset(name).unwrap().validate().unwrap();
        }
        assert!(matches!(FitSpec::preset("ggx"), Err(FitError::NoSuchPreset { .. })));
    }

    #[test]
    fn nonsense_names_its_field() {
        let broken = |change: fn(&mut FitSpec)| {
            let mut spec = FitSpec::preset("ggx-anisotropic").unwrap();
            change(&mut spec);
            spec.validate().unwrap_err().to_string()
        };
        assert!(broken(|s| s.name = "../x".into()).starts_with("name:"));
        assert!(broken(|s| s.brdf = "phong".into()).starts_with("brdf:"));
        assert!(broken(|s| s.floors.alpha = f64::NAN).starts_with("floors.alpha:"));
        assert!(broken(|s| s.joint.samples = 1).starts_with("joint.samples:"));
        assert!(broken(|s| s.measure.seed = s.joint.seed).starts_with("measure.seed:"));
        assert!(broken(|s| s.axes.swap(0, 1)).starts_with("axes:"));
        assert!(broken(|s| s.axes[1].domain = [0.1, 1.0]).starts_with("axes:"));
    }
}
