//! What to fit and how: every choice that the result depends on.

use core::f64::consts::FRAC_PI_2;

use ltc_table::{Axis, ClosedForm, Floors, Manifest, Mapping, Quantity, check_name};
use serde::{Deserialize, Serialize};

use crate::{
    Brdf, FitError, GgxFamily, Layout, Objective, brdf, channels::ChannelSettings, entries::EntrySettings,
    joint::JointSettings, measure::MeasureSettings, objective::WASSERSTEIN_LOBE_SAMPLES,
};

/// A fit, fully specified: the same specification gives the same digest, whatever the number of threads.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FitSpec {
    /// Name of the table.
    pub name: String,
    /// Name of the BRDF: one of [`brdf::names`], or of one's own ([`crate::fit_with`]).
    pub brdf: String,
    /// The table's axes: θ, α (isotropic) or θ, φ, α, λ.
    pub axes: Vec<Axis>,
    /// Smallest values that entries are fitted at.
    pub floors: Floors,
    /// What is minimised: `total_variation`, `sliced_wasserstein`, `l3` or `kl`. Only the first is refined jointly; the others
    /// need `joint.steps = 0`.
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
    pub const PRESETS: [&'static str; 9] = [
        "ggx-isotropic",
        "ggx-anisotropic",
        "ggx-isotropic-dropin",
        "ggx-anisotropic-closed-form",
        "beckmann-isotropic",
        "beckmann-anisotropic",
        "disney-diffuse",
        "oren-nayar",
        "charlie-sheen",
    ];

    /// How a manifest says that its table was fitted.
    ///
    /// # Errors
    /// [`FitError::Spec`] where it does not say it so that this program understands.
    pub fn of_manifest(manifest: &Manifest) -> Result<Self, FitError> {
        serde_json::from_value(manifest.fit.clone())
            .map_err(|e| FitError::Spec { field: "fit", reason: e.to_string() })
    }

    /// A specification by name.
    ///
    /// # Errors
    /// [`FitError::NoSuchPreset`].
    pub fn preset(name: &str) -> Result<Self, FitError> {
        if let Some(spec) = brdf::preset(name) {
            return Ok(spec);
        }
        let layout = if name == "ggx-isotropic-dropin" { Layout::DropIn } else { Layout::Matrix };
        let (axes, steps, learning_rate, channel_queries, power, closed_form) = match name {
            "ggx-isotropic" | "ggx-isotropic-dropin" => {
                (ltc_table::drop_in::axes(64).to_vec(), 200, 3e-3, 20_000, 2, None)
            }
            "ggx-anisotropic" => (anisotropic_axes(Mapping::GrazingHalfTangent), 1500, 6e-3, 60_000, 4, None),
            // What is hard to interpolate is taken by the form: nodes of theta are where the lobe wants them.
            "ggx-anisotropic-closed-form" => {
                (anisotropic_axes(Mapping::HalfTangent), 1500, 6e-3, 60_000, 4, Some(ClosedForm::GgxSmith))
            }
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
            entries: EntrySettings::new(512, 100),
            joint: JointSettings { steps, queries: 2048, samples: 256, learning_rate, seed: 3, layout },
            channels: ChannelSettings {
                samples: 2048,
                queries: channel_queries,
                seed: 5,
                power,
                closed_form,
            },
            measure: MeasureSettings { queries: 3000, samples: 4096, seed: 77, layout },
        })
    }

    /// The BRDF of that name.
    ///
    /// # Errors
    /// [`FitError::Spec`] for an unknown name.
    pub fn brdf(&self) -> Result<&'static dyn Brdf, FitError> {
        brdf::by_name(&self.brdf).ok_or_else(|| FitError::Spec {
            field: "brdf",
            reason: format!("\"{}\" is not known; there are: {}", self.brdf, brdf::names()),
        })
    }

    /// Checks every field.
    ///
    /// # Errors
    /// [`FitError::Spec`], naming the field and what is wrong with it.
    pub fn validate(&self) -> Result<(), FitError> {
        self.brdf()?;
        self.validate_settings()
    }

    /// Checks every field, and that the BRDF is `brdf`.
    ///
    /// # Errors
    /// [`FitError::Spec`], naming the field and what is wrong with it.
    pub fn validate_with(&self, brdf: &dyn Brdf) -> Result<(), FitError> {
        if self.brdf != brdf.name() {
            let reason = format!("is \"{}\", the BRDF's name is \"{}\"", self.brdf, brdf.name());
            return Err(FitError::Spec { field: "brdf", reason });
        }
        self.validate_settings()
    }

    fn validate_settings(&self) -> Result<(), FitError> {
        use Quantity::{Alpha, Lambda, Phi, Theta};
        let wrong = |field, reason: String| Err(FitError::Spec { field, reason });
        check_name(&self.name).or_else(|e| wrong("name", e.to_string()))?;
        self.validate_method()?;
        const AXES: [&str; 4] = ["axes[0]", "axes[1]", "axes[2]", "axes[3]"];
        for (axis, field) in self.axes.iter().zip(AXES) {
            axis.validate().or_else(|e| wrong(field, e.to_string()))?;
            if axis.quantity == Phi && axis.domain != [0.0, FRAC_PI_2] {
                return wrong(field, "phi must span [0, π/2]: the symmetries tie its ends".to_owned());
            }
        }
        let quantities: Vec<_> = self.axes.iter().map(|a| a.quantity).collect();
        if quantities != [Theta, Alpha] && quantities != [Theta, Phi, Alpha, Lambda] {
            return wrong(
                "axes",
                "must be theta, alpha or theta, phi, alpha, lambda in this order".to_owned(),
            );
        }
        /// An array of matrices of more bytes than this is refused when the table is read.
        const MAX_NODES: u64 = (1 << 30) / 72;
        let nodes = self.axes.iter().fold(1_u64, |n, axis| n.saturating_mul(axis.len as u64));
        if nodes > MAX_NODES {
            return wrong("axes", format!("have {nodes} nodes in all, must have at most {MAX_NODES}"));
        }
        self.validate_layout()?;
        self.validate_closed_form()?;
        self.validate_numbers()
    }

    fn validate_closed_form(&self) -> Result<(), FitError> {
        let Some(form) = self.channels.closed_form else { return Ok(()) };
        let wrong = |reason| {
            Err(FitError::Spec { field: "channels.closed_form", reason: format!("{} {reason}", form.name()) })
        };
        match form {
            ClosedForm::GgxSmith if self.brdf != GgxFamily.name() => {
                wrong(format!("is for the BRDF \"{}\", this is \"{}\"", GgxFamily.name(), self.brdf))
            }
            ClosedForm::GgxSmith if self.axes.len() != 4 => {
                wrong("is for anisotropic tables (theta, phi, alpha, lambda)".to_owned())
            }
            ClosedForm::GgxSmith => Ok(()),
        }
    }

    fn validate_layout(&self) -> Result<(), FitError> {
        let wrong = |field, reason: &str| Err(FitError::Spec { field, reason: reason.to_owned() });
        if self.measure.layout != self.joint.layout {
            return wrong("measure.layout", "must be joint.layout: what is fitted is what is read");
        }
        let drop_in = self.axes == ltc_table::drop_in::axes(self.axes[0].len);
        if self.joint.layout == Layout::DropIn && !drop_in {
            let reason = "of the layout drop_in must be theta (sqrt_one_minus_cos) and alpha (sqrt) over their whole ranges, as many \
                          nodes each";
            return wrong("axes", reason);
        }
        Ok(())
    }

    /// The objective of that name.
    ///
    /// # Errors
    /// [`FitError::Spec`] for an unknown name.
    pub fn objective(&self) -> Result<Objective, FitError> {
        Objective::by_name(&self.objective)
    }

    fn validate_method(&self) -> Result<(), FitError> {
        let wrong = |field, reason: String| Err(FitError::Spec { field, reason });
        let objective = self.objective()?;
        if objective != Objective::TotalVariation && self.joint.steps > 0 {
            let reason = match objective {
                Objective::SlicedWasserstein => "it would take a sort for each axis of each query",
                Objective::L3 => "its mean over lobes of all widths would be that of the narrowest",
                _ => "where it is infinite it is a floor that would be refined",
            };
            let name = objective.name();
            return wrong(
                "objective",
                format!("{name} is not refined jointly ({reason}): set joint.steps to 0"),
            );
        }
        if objective == Objective::SlicedWasserstein && self.entries.samples < WASSERSTEIN_LOBE_SAMPLES {
            let samples = self.entries.samples;
            let reason =
                format!("is {samples}, must be at least {WASSERSTEIN_LOBE_SAMPLES} for sliced_wasserstein");
            return wrong("entries.samples", format!("{reason}: with fewer, thin lobes collapse to lines"));
        }
        if self.entries.optimiser.form().is_some() && self.axes.len() != 2 {
            let name = self.entries.optimiser.name();
            return wrong("entries.optimiser", format!("{name} fits isotropic tables (theta, alpha) only"));
        }
        Ok(())
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
            ("channels.power", self.channels.power as usize, 2, 8),
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
fn anisotropic_axes(theta: Mapping) -> Vec<Axis> {
    use Quantity::{Alpha, Lambda, Phi, Theta};
    let mut alpha = Axis::full(Alpha, Mapping::Sqrt, 8);
    alpha.domain[0] = 0.005;
    let mut lambda = Axis::full(Lambda, Mapping::Sqrt, 8);
    lambda.domain[0] = 0.03;
    vec![Axis::full(Theta, theta, 8), Axis::full(Phi, Mapping::Linear, 8), alpha, lambda]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Optimiser;

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
            let mut spec = FitSpec::preset("ggx-anisotropic-closed-form").unwrap();
            change(&mut spec);
            spec.validate().unwrap_err().to_string()
        };
        assert!(broken(|s| s.name = "../x".into()).starts_with("name:"));
        assert!(broken(|s| s.brdf = "phong".into()).starts_with("brdf:"));
        assert!(
            broken(|s| s.objective = "l2".into()).starts_with("objective: \"l2\" is not known; there are:")
        );
        let sliced = broken(|s| (s.objective, s.joint.steps) = ("sliced_wasserstein".into(), 0));
        assert!(sliced.starts_with("entries.samples: is 512, must be at least 2048 for"), "{sliced}");
        assert!(broken(|s| s.objective = "l3".into()).starts_with("objective: l3 is not refined jointly"));
        assert!(
            broken(|s| s.entries.optimiser = Optimiser::NelderMeadFour).starts_with("entries.optimiser: ")
        );
        assert!(broken(|s| s.floors.alpha = f64::NAN).starts_with("floors.alpha:"));
        assert!(broken(|s| s.joint.samples = 1).starts_with("joint.samples:"));
        assert!(broken(|s| s.measure.seed = s.joint.seed).starts_with("measure.seed:"));
        assert!(broken(|s| s.axes.swap(0, 1)).starts_with("axes:"));
        assert!(
            broken(|s| s.axes.iter_mut().for_each(|a| a.len = 4096)).starts_with("axes: have 2814749767")
        );
        assert!(broken(|s| s.axes[1].domain = [0.1, 1.0]).starts_with("axes[1]:"));
        let other = broken(|s| s.brdf = "beckmann".into());
        assert!(other.starts_with("channels.closed_form: ggx-smith is for the BRDF \"ggx\""), "{other}");
        let flat = broken(|s| s.axes = ltc_table::drop_in::axes(8).to_vec());
        assert!(flat.starts_with("channels.closed_form: ggx-smith is for anisotropic tables"), "{flat}");
        assert!(broken(|s| s.measure.layout = Layout::DropIn).starts_with("measure.layout:"));
        let drop_in = broken(|s| (s.joint.layout, s.measure.layout) = (Layout::DropIn, Layout::DropIn));
        assert!(drop_in.starts_with("axes: of the layout drop_in"), "{drop_in}");
    }
}
