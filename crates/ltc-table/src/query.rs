//! Questions to a table, folded into the part of the domain that it stores.

use core::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DMat3, DVec3};
use ltc_core::{Alpha, InputError, check_range};
use serde::{Deserialize, Serialize};

/// A view direction and GGX widths.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Query {
    /// Polar angle of the view direction, radians, in [0, π/2].
    pub theta: f64,
    /// Azimuth of the view direction from the tangent, radians; any finite number.
    #[serde(default)]
    pub phi: f64,
    /// GGX width along the tangent, in [0, 1].
    pub alpha_x: f64,
    /// GGX width along the bitangent, in [0, 1].
    pub alpha_y: f64,
}

/// A query reflected into φ ∈ [0, π/2] and α_x ≥ α_y, and what leads back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Folded {
    /// Polar angle.
    pub theta: f64,
    /// Folded azimuth, in [0, π/2].
    pub phi: f64,
    /// The larger width.
    pub alpha: f64,
    /// Smaller width over larger, in (0, 1].
    pub lambda: f64,
    /// Whether x is mirrored.
    pub flip_x: bool,
    /// Whether y is mirrored.
    pub flip_y: bool,
    /// Whether x and y change places (before the mirrors are applied).
    pub swap: bool,
}

impl Query {
    /// # Errors
    /// [`InputError`] for a NaN, an infinity, θ outside [0, π/2] or a width outside [0, 1].
    pub fn validate(&self) -> Result<Alpha, InputError> {
        check_range("theta", self.theta, 0.0, FRAC_PI_2)?;
        if !self.phi.is_finite() {
            return Err(InputError::NotFinite { name: "phi" });
        }
        Alpha::new(self.alpha_x, self.alpha_y)
    }

    /// Folds the query by the symmetries of a BRDF that mirrors in x and y (KT et al. 2022, eq. 13 and 15).
    ///
    /// # Errors
    /// As [`Query::validate`].
    pub fn fold(&self) -> Result<Folded, InputError> {
        let alpha = self.validate()?;
        let turn = self.phi.rem_euclid(TAU);
        let flip_y = turn > PI;
        let half = if flip_y { TAU - turn } else { turn };
        let flip_x = half > FRAC_PI_2;
        let quarter = if flip_x { PI - half } else { half };
        let swap = alpha.x() < alpha.y();
        let phi = if swap { FRAC_PI_2 - quarter } else { quarter };
        Ok(Folded {
            theta: self.theta,
            phi: phi.clamp(0.0, FRAC_PI_2),
            alpha: alpha.major(),
            lambda: alpha.ratio(),
            flip_x,
            flip_y,
            swap,
        })
    }
}

impl Folded {
    /// The lobe of the folded query's matrix, back where the query asked for it: `S M Sᵀ` for the signed permutation
    /// `S` that leads back.
    ///
    /// The papers apply `S` on the left only, which turns det M negative for an odd number of mirrors. The factor on
    /// the right changes no lobe (a clamped cosine is symmetric, 2022 paper, §5.1) and keeps det M > 0 and the gauge.
    pub fn unfold(&self, m: DMat3) -> DMat3 {
        let s = self.unfolding();
        s * m * s.transpose()
    }

    /// The signed permutation that leads from the folded quadrant back to the query's.
    fn unfolding(&self) -> DMat3 {
        let sign = |flip: bool| if flip { -1.0 } else { 1.0 };
        let mirror = DMat3::from_diagonal(DVec3::new(sign(self.flip_x), sign(self.flip_y), 1.0));
        let exchange = DMat3::from_cols_array(&[0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
        if self.swap { mirror * exchange } else { mirror }
    }
}

/// The unit direction of polar angle `theta` and azimuth `phi`.
pub fn direction(theta: f64, phi: f64) -> DVec3 {
    let ((st, ct), (sp, cp)) = (theta.sin_cos(), phi.sin_cos());
    DVec3::new(st * cp, st * sp, ct)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unfolding_the_folded_view_gives_the_view() {
        for i in 0..64 {
            let phi = f64::from(i) * 0.37 - 9.0;
            for (alpha_x, alpha_y) in [(0.5, 0.2), (0.2, 0.5), (0.3, 0.3)] {
                let query = Query { theta: 0.8, phi, alpha_x, alpha_y };
                let folded = query.fold().unwrap();
                assert!((0.0..=FRAC_PI_2).contains(&folded.phi) && folded.lambda <= 1.0);
                let back = folded.unfolding() * direction(folded.theta, folded.phi);
                assert!((back - direction(0.8, phi)).length() < 1e-14, "{phi} {alpha_x}");
                // The axis of the larger width comes back to where the query has it.
                let wide = folded.unfolding() * DVec3::X;
                let expected = if alpha_x >= alpha_y { wide.x } else { wide.y };
                assert_eq!(expected.abs(), 1.0);
            }
        }
    }

    #[test]
    fn the_determinant_stays_positive() {
        let m = DMat3::from_cols_array(&[0.5, 0.1, -0.2, 0.0, 0.3, 0.1, -0.6, -0.2, 0.8]);
        for phi in [0.3, 2.0, 4.0, 5.5] {
            for alpha_x in [0.1, 0.9] {
                let folded = Query { theta: 0.5, phi, alpha_x, alpha_y: 0.5 }.fold().unwrap();
                assert!((folded.unfold(m).determinant() - m.determinant()).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn nonsense_is_refused() {
        let good = Query { theta: 0.5, phi: 0.0, alpha_x: 0.5, alpha_y: 0.5 };
        assert!(good.fold().is_ok());
        assert!(Query { theta: 1.6, ..good }.fold().is_err());
        assert!(Query { phi: f64::INFINITY, ..good }.fold().is_err());
        assert!(Query { alpha_x: f64::NAN, ..good }.fold().is_err());
        assert!(Query { alpha_y: -0.1, ..good }.fold().is_err());
    }
}
