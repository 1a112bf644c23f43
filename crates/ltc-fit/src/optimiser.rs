//! How an entry's objective is lowered, chosen by name.

use serde::{Deserialize, Serialize};

use crate::form::Form;

/// The method that each entry is fitted by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Optimiser {
    /// BFGS in coordinates relative to the lobe's own width, from its medians.
    #[default]
    QuasiNewton,
    /// Nelder and Mead's simplex in the same coordinates, from the same start.
    NelderMead,
    /// The simplex in [`Form::XShear`], along the blog's path. This and the next three are for isotropic tables.
    NelderMeadXShear,
    /// The simplex in [`Form::XyShear`].
    NelderMeadXyShear,
    /// The simplex in [`Form::ZShear`].
    NelderMeadZShear,
    /// The simplex in [`Form::Four`].
    NelderMeadFour,
}

impl Optimiser {
    /// All there are.
    pub const ALL: [Self; 6] = [
        Self::QuasiNewton,
        Self::NelderMead,
        Self::NelderMeadXShear,
        Self::NelderMeadXyShear,
        Self::NelderMeadZShear,
        Self::NelderMeadFour,
    ];

    /// The restricted form of `M` that it works in, if it does: a table is then fitted along [`crate::path`].
    pub fn form(self) -> Option<Form> {
        match self {
            Self::QuasiNewton | Self::NelderMead => None,
            Self::NelderMeadXShear => Some(Form::XShear),
            Self::NelderMeadXyShear => Some(Form::XyShear),
            Self::NelderMeadZShear => Some(Form::ZShear),
            Self::NelderMeadFour => Some(Form::Four),
        }
    }

    /// Its name in specifications.
    pub fn name(self) -> &'static str {
        match self {
            Self::QuasiNewton => "quasi_newton",
            Self::NelderMead => "nelder_mead",
            Self::NelderMeadXShear => "nelder_mead_x_shear",
            Self::NelderMeadXyShear => "nelder_mead_xy_shear",
            Self::NelderMeadZShear => "nelder_mead_z_shear",
            Self::NelderMeadFour => "nelder_mead_four",
        }
    }

    /// Whether it is the default, which specifications leave out.
    pub(crate) fn is_default(&self) -> bool {
        *self == Self::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_specifications() {
        for optimiser in Optimiser::ALL {
            let json = serde_json::to_string(&optimiser).unwrap();
            assert_eq!(json, format!("\"{}\"", optimiser.name()));
            assert_eq!(serde_json::from_str::<Optimiser>(&json).unwrap(), optimiser);
        }
        let message = serde_json::from_str::<Optimiser>("\"simplex\"").unwrap_err().to_string();
        assert!(message.contains("simplex") && message.contains("nelder_mead_x_shear"), "{message}");
    }
}
