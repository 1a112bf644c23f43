//! What of magnitude and Fresnel term a formula says, so that a table need only hold the rest.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::{Axis, ChannelInfo, TableError, direction};

/// A formula for the parts of magnitude and Fresnel term that change too fast between entries to be interpolated.
///
/// A table with one is read as `formula at the query + Σ wᵢ (entry − formula at the entry)`, clamped to [0, 1]: entries keep
/// their meaning, and where the formula is smooth nothing changes. The formula alone approximates neither channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ClosedForm {
    /// For GGX with Smith's shadowing, both widths. With `ωo = (w_x, w_y, c)`, `c` raised to 0 below the surface,
    ///
    /// ```text
    /// X = (α_x w_x)² + (α_y w_y)²    Y = (α_x w_y)² + (α_y w_x)²
    /// m₁ = max(c + √(c² + 7.5 X + 0.035 Y), 1e-6)    G₁ = 2 c / m₁
    /// m₂ = max(c + √(c² + 0.5 X + 0.4 Y), 1e-6)      G₂ = 2 c / m₂
    /// v = max(0, 1 − m₁/2)
    /// g_n = −0.471 G₁ (1 − G₁) − 0.924 G₂ (1 − G₂)² Y + 0.032 (α_x² + α_y²)
    /// g_f = v⁴ (0.869 + v G₁ (0.118 + (1 − G₁)(−0.293 − 1.372 Y)))
    /// ```
    ///
    /// `X` and `Y` are squares of the widths along and across the view, `G` has the form of Smith's `G₁`. Nothing in it is
    /// folded: mirrors of x and y and their exchange change nothing. Finite for all unit `ωo` and widths in [0, 1], with
    /// `g_n` in [−0.26, 0.07] (`G (1 − G) ≤ 1/4`, `G (1 − G)² ≤ 4/27`) and `g_f` in [0, 0.99].
    ///
    /// Source: a fit of its own, to quadrature of both channels over 8⁴ entries whose remainders were fitted with it, least in
    /// the fourth power of the error; see `docs/table-shapes.md` for errors with it and without.
    GgxSmith,
}

/// Numbers of [`ClosedForm::GgxSmith`], in the order in which the formula has them.
impl ClosedForm {
    /// Factors of `X` and `Y` in `m₁`.
    pub const M1: [f64; 2] = [7.5, 0.035];
    /// Factors of `X` and `Y` in `m₂`.
    pub const M2: [f64; 2] = [0.5, 0.4];
    /// Least `m₁` and `m₂`.
    pub const LEAST_M: f64 = 1e-6;
    /// Factors of the terms of `g_n`.
    pub const MAGNITUDE: [f64; 3] = [-0.471, -0.924, 0.032];
    /// Factors in `g_f`.
    pub const FRESNEL: [f64; 4] = [0.869, 0.118, -0.293, -1.372];
}

impl ClosedForm {
    /// All of them.
    pub const ALL: [Self; 1] = [Self::GgxSmith];

    /// The name in manifests.
    pub fn name(self) -> &'static str {
        match self {
            Self::GgxSmith => "ggx-smith",
        }
    }

    /// The number in the array `closed_form` of an NPZ.
    pub fn code(self) -> f64 {
        match self {
            Self::GgxSmith => 1.0,
        }
    }

    /// The form of that number.
    ///
    /// # Errors
    /// [`TableError::UnknownClosedForm`].
    pub fn from_code(code: f64) -> Result<Self, TableError> {
        Self::ALL.into_iter().find(|form| form.code() == code).ok_or(TableError::UnknownClosedForm { code })
    }

    /// Says in the descriptions of magnitude and Fresnel term how they are read with this.
    pub fn describe(self, channels: &mut [ChannelInfo]) {
        for (name, reading) in ["magnitude", "fresnel"].into_iter().zip(self.reading()) {
            for channel in channels.iter_mut().filter(|channel| channel.name == name) {
                channel.meaning = format!("{}; {reading}", channel.meaning);
                channel.closed_form = Some(self);
            }
        }
    }

    /// How to read magnitude, and how the Fresnel term.
    fn reading(self) -> [String; 2] {
        match self {
            Self::GgxSmith => ggx_smith_in_words().map(|g| {
                format!(
                    "interpolate entry - g(entry), add g(query), clamp to [0, 1] (plain interpolation of entries is less exact), \
                     where g = {g}, wo = (x, y, z), c = max(z, 0), X = (alpha_x x)^2 + (alpha_y y)^2, Y = (alpha_x y)^2 + \
                     (alpha_y x)^2"
                )
            }),
        }
    }

    /// `g_n` and `g_f` at every entry of an anisotropic table, in table order.
    ///
    /// # Errors
    /// [`TableError::NoClosedForm`] for other axes.
    pub fn at_entries(self, axes: &[Axis]) -> Result<Vec<[f64; 2]>, TableError> {
        let [theta, phi, alpha, lambda] = axes else { return Err(TableError::NoClosedForm) };
        let mut values = Vec::with_capacity(axes.iter().map(|axis| axis.len).product());
        for theta in theta.nodes() {
            for phi in phi.nodes() {
                for alpha in alpha.nodes() {
                    let at = |lambda| self.at(direction(theta, phi), alpha, alpha * lambda);
                    values.extend(lambda.nodes().into_iter().map(at));
                }
            }
        }
        Ok(values)
    }

    /// `g_n` and `g_f` for a unit view direction and widths in [0, 1].
    pub fn at(self, wo: DVec3, alpha_x: f64, alpha_y: f64) -> [f64; 2] {
        match self {
            Self::GgxSmith => ggx_smith(wo, alpha_x * alpha_x, alpha_y * alpha_y),
        }
    }
}

fn ggx_smith(wo: DVec3, alpha_x2: f64, alpha_y2: f64) -> [f64; 2] {
    let (x2, y2, cos) = (wo.x * wo.x, wo.y * wo.y, wo.z.max(0.0));
    let (along, across) = (alpha_x2 * x2 + alpha_y2 * y2, alpha_x2 * y2 + alpha_y2 * x2);
    let m = |[a, b]: [f64; 2]| (cos + (cos * cos + a * along + b * across).sqrt()).max(ClosedForm::LEAST_M);
    let (m1, m2) = (m(ClosedForm::M1), m(ClosedForm::M2));
    let (g1, g2) = (2.0 * cos / m1, 2.0 * cos / m2);
    let (hidden1, hidden2) = (1.0 - g1, 1.0 - g2);
    let [a, b, c] = ClosedForm::MAGNITUDE;
    let magnitude = a * g1 * hidden1 + b * g2 * hidden2 * hidden2 * across + c * (alpha_x2 + alpha_y2);
    let [d, e, f, g] = ClosedForm::FRESNEL;
    let v = (1.0 - 0.5 * m1).max(0.0);
    let fresnel = v.powi(4) * (d + v * g1 * (e + hidden1 * (f + g * across)));
    [magnitude, fresnel]
}

fn ggx_smith_in_words() -> [String; 2] {
    let least = ClosedForm::LEAST_M;
    let m = |i: usize, [a, b]: [f64; 2]| {
        format!("m{i} = max(c + sqrt(c^2 + {a} X + {b} Y), {least:e}), G{i} = 2 c / m{i}")
    };
    let (m1, m2) = (m(1, ClosedForm::M1), m(2, ClosedForm::M2));
    let [a, b, c] = ClosedForm::MAGNITUDE;
    let [d, e, f, g] = ClosedForm::FRESNEL;
    [
        format!("{a} G1 (1 - G1) + {b} G2 (1 - G2)^2 Y + {c} (alpha_x^2 + alpha_y^2), {m1}, {m2}"),
        format!("v^4 ({d} + v G1 ({e} + (1 - G1) ({f} + {g} Y))), v = max(0, 1 - m1/2), {m1}"),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::FRAC_PI_2;
    use ltc_core::points::SplitMix64;

    /// Views and widths of the whole domain, half of them within 1e-9 … 1 of grazing; widths from 1e-4.
    fn draw(random: &mut SplitMix64) -> (f64, f64, f64, f64) {
        let near = 10.0_f64.powf(-9.0 * random.unit());
        let theta = if random.unit() < 0.5 { FRAC_PI_2 - near } else { random.range(0.0, FRAC_PI_2) };
        let mut width = || 10.0_f64.powf(-4.0 * random.unit());
        let (alpha_x, alpha_y) = (width(), width());
        (theta, random.range(0.0, 6.3), alpha_x, alpha_y)
    }

    #[test]
    fn names_and_codes_lead_back() {
        for form in ClosedForm::ALL {
            assert_eq!(serde_json::to_value(form).unwrap(), form.name());
            assert_eq!(ClosedForm::from_code(form.code()).unwrap(), form);
        }
        for code in [0.0, 2.0, -1.0, f64::NAN] {
            let error = ClosedForm::from_code(code).unwrap_err();
            assert!(matches!(error, TableError::UnknownClosedForm { .. }), "{code}");
        }
    }

    #[test]
    fn it_is_the_formula_worked_by_hand() {
        // Straight down: X = Y = 0, m = 2, G = 1, v = 0.
        assert_eq!(ClosedForm::GgxSmith.at(DVec3::Z, 0.5, 0.25), [0.032 * 0.3125, 0.0]);
        // Along the surface at α = (0.4, 0.2), φ = 0: X = 0.16, Y = 0.04, c = 0, G = 0, m₁ = √(1.2 + 0.0014).
        let [n, f] = ClosedForm::GgxSmith.at(DVec3::X, 0.4, 0.2);
        assert!((n - 0.032 * 0.2).abs() < 1e-15);
        assert!((f - 0.869 * (1.0 - 0.5 * 1.2014_f64.sqrt()).powi(4)).abs() < 1e-15);
        // The formula of the documentation typed into Python: φ = 90°, X = 0.16, Y = 0.64, then φ = 0.
        for (wo, alpha_x, alpha_y, [n, f]) in [
            (DVec3::new(0.0, 0.8, 0.6), 1.0, 0.5, [-0.080_926_546_479_262, 2.177_677_860_304_8e-5]),
            (DVec3::new(0.6, 0.0, 0.8), 0.3, 0.2, [-0.030_677_676_459_574_8, 2.515_632_139_944_72e-4]),
        ] {
            let [found_n, found_f] = ClosedForm::GgxSmith.at(wo, alpha_x, alpha_y);
            assert!((found_n - n).abs() < 1e-14 && (found_f - f).abs() < 1e-14, "{found_n} {found_f}");
        }
    }

    #[test]
    fn manifests_say_it_in_words() {
        let [n, f] = ClosedForm::GgxSmith.reading();
        for (words, g) in [
            (
                n,
                "g = -0.471 G1 (1 - G1) + -0.924 G2 (1 - G2)^2 Y + 0.032 (alpha_x^2 + alpha_y^2), m1 = max(c + sqrt(c^2 + 7.5 X \
                 + 0.035 Y), 1e-6), G1 = 2 c / m1, m2 = max(c + sqrt(c^2 + 0.5 X + 0.4 Y), 1e-6), G2 = 2 c / m2, wo",
            ),
            (
                f,
                "g = v^4 (0.869 + v G1 (0.118 + (1 - G1) (-0.293 + -1.372 Y))), v = max(0, 1 - m1/2), m1 = max(c + sqrt(c^2 + \
                 7.5 X + 0.035 Y), 1e-6), G1 = 2 c / m1, wo",
            ),
        ] {
            assert!(words.contains(g), "{words}");
        }
    }

    #[test]
    fn it_is_finite_and_within_its_range_up_to_grazing() {
        let mut random = SplitMix64::new(1);
        for i in 0..200_000 {
            let (theta, phi, mut alpha_x, mut alpha_y) = draw(&mut random);
            let mut wo = direction(theta, phi);
            if i % 4 == 0 {
                wo = DVec3::new(phi.cos(), phi.sin(), 0.0);
            }
            if i % 100 == 0 {
                (alpha_x, alpha_y) = (0.0, 0.0);
            }
            let [n, f] = ClosedForm::GgxSmith.at(wo, alpha_x, alpha_y);
            assert!((-0.26..=0.07).contains(&n), "{n}");
            assert!((0.0..=0.99).contains(&f), "{f}");
        }
    }

    #[test]
    fn it_is_continuous_up_to_grazing() {
        // Steps of 1e-3 of the distance to grazing or of the width: nothing jumps.
        let mut random = SplitMix64::new(2);
        for _ in 0..100_000 {
            let (theta, phi, alpha_x, alpha_y) = draw(&mut random);
            let here = ClosedForm::GgxSmith.at(direction(theta, phi), alpha_x, alpha_y);
            let nearer = FRAC_PI_2 - 0.999 * (FRAC_PI_2 - theta);
            for there in [
                ClosedForm::GgxSmith.at(direction(nearer, phi), alpha_x, alpha_y),
                ClosedForm::GgxSmith.at(
                    direction(theta, phi + 1e-3 * alpha_y.min(alpha_x)),
                    alpha_x,
                    alpha_y,
                ),
                ClosedForm::GgxSmith.at(direction(theta, phi), 0.999 * alpha_x, alpha_y),
            ] {
                for k in 0..2 {
                    assert!((here[k] - there[k]).abs() < 2e-3, "{theta} {phi} {alpha_x} {alpha_y}");
                }
            }
        }
    }

    #[test]
    fn mirrors_and_exchange_change_nothing() {
        let mut random = SplitMix64::new(3);
        for _ in 0..1000 {
            let (theta, phi, alpha_x, alpha_y) = draw(&mut random);
            let wo = direction(theta, phi);
            let here = ClosedForm::GgxSmith.at(wo, alpha_x, alpha_y);
            let mirrored = DVec3::new(-wo.x, wo.y, wo.z);
            assert_eq!(ClosedForm::GgxSmith.at(mirrored, alpha_x, alpha_y), here);
            let exchanged = ClosedForm::GgxSmith.at(DVec3::new(wo.y, wo.x, wo.z), alpha_y, alpha_x);
            for k in 0..2 {
                assert!((exchanged[k] - here[k]).abs() < 1e-15);
            }
            // Exchanging one of the two without the other is another question.
            let other = ClosedForm::GgxSmith.at(wo, alpha_y, alpha_x);
            assert!(other != here || wo.x == wo.y || alpha_x == alpha_y);
        }
    }
}
