//! Table axes: which quantity, on which nodes.

use core::f64::consts::FRAC_PI_2;

use serde::{Deserialize, Serialize};

use crate::TableError;

/// What an axis measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// Polar angle of the view direction, radians.
    Theta,
    /// Azimuth of the view direction folded into [0, π/2], radians, from the axis of the larger α.
    Phi,
    /// The larger GGX width.
    Alpha,
    /// The smaller GGX width over the larger.
    Lambda,
}

impl Quantity {
    /// The name in manifests, arrays (`axis_<name>`) and URLs.
    pub fn name(self) -> &'static str {
        match self {
            Self::Theta => "theta",
            Self::Phi => "phi",
            Self::Alpha => "alpha",
            Self::Lambda => "lambda",
        }
    }
}

/// How node numbers map to values: nodes are spaced evenly in the mapped coordinate `u`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Mapping {
    /// `u = x`
    Linear,
    /// `u = √x`, for α: even in perceptual roughness.
    Sqrt,
    /// `u = √(1 − cos x)`, for θ.
    SqrtOneMinusCos,
    /// `u = tan(x/2)`, for θ: the radius of the stereographic projection. Nodes lie twice as dense at π/2 as at 0, and
    /// `sin x / (1 + cos x)` needs no inverse function.
    HalfTangent,
    /// `u = t/(2 − t)`, `t = tan(x/2)`, for θ: nodes lie eight times as dense at π/2 as at 0, because magnitude and Fresnel
    /// term of narrow lobes fall within a few degrees of grazing. As `sin x / (2 + 2 cos x − sin x)` it needs no inverse
    /// function either.
    GrazingHalfTangent,
}

impl Mapping {
    /// All of them.
    pub const ALL: [Self; 5] =
        [Self::Linear, Self::Sqrt, Self::SqrtOneMinusCos, Self::HalfTangent, Self::GrazingHalfTangent];

    /// The name in manifests.
    pub fn name(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::Sqrt => "sqrt",
            Self::SqrtOneMinusCos => "sqrt_one_minus_cos",
            Self::HalfTangent => "half_tangent",
            Self::GrazingHalfTangent => "grazing_half_tangent",
        }
    }

    /// The mapped coordinate of a value.
    pub fn coordinate(self, value: f64) -> f64 {
        match self {
            Self::Linear => value,
            Self::Sqrt => value.max(0.0).sqrt(),
            // 1 − cos x = 2 sin²(x/2), without the cancellation near 0.
            Self::SqrtOneMinusCos => core::f64::consts::SQRT_2 * (0.5 * value).sin().abs(),
            Self::HalfTangent => (0.5 * value).tan(),
            Self::GrazingHalfTangent => {
                let (sin, cos) = (0.5 * value).sin_cos();
                sin / (2.0 * cos - sin)
            }
        }
    }

    /// The value of a mapped coordinate.
    pub fn value(self, coordinate: f64) -> f64 {
        match self {
            Self::Linear => coordinate,
            Self::Sqrt => coordinate * coordinate,
            Self::SqrtOneMinusCos => 2.0 * (coordinate / core::f64::consts::SQRT_2).clamp(0.0, 1.0).asin(),
            Self::HalfTangent => 2.0 * coordinate.atan(),
            Self::GrazingHalfTangent => 2.0 * (2.0 * coordinate).atan2(1.0 + coordinate),
        }
    }

    /// How fast the value grows with the mapped coordinate, `dx/du`.
    pub fn slope(self, value: f64) -> f64 {
        match self {
            Self::Linear => 1.0,
            Self::Sqrt => 2.0 * value.max(0.0).sqrt(),
            Self::SqrtOneMinusCos => core::f64::consts::SQRT_2 / (0.5 * value).cos(),
            Self::HalfTangent => 2.0 * (0.5 * value).cos().powi(2),
            Self::GrazingHalfTangent => {
                let (sin, cos) = (0.5 * value).sin_cos();
                (2.0 * cos - sin).powi(2)
            }
        }
    }
}

/// One axis of a table: `len` nodes over `domain`, evenly spaced in the mapped coordinate, both ends included.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Axis {
    /// What it measures.
    pub quantity: Quantity,
    /// How its nodes are spaced.
    pub mapping: Mapping,
    /// Value at the first and at the last node.
    pub domain: [f64; 2],
    /// Number of nodes, at least 2.
    pub len: usize,
}

impl Axis {
    /// Evenly spaced nodes over the whole range of the quantity ([0, π/2] for angles, else [0, 1]).
    pub fn full(quantity: Quantity, mapping: Mapping, len: usize) -> Self {
        let end = match quantity {
            Quantity::Theta | Quantity::Phi => FRAC_PI_2,
            Quantity::Alpha | Quantity::Lambda => 1.0,
        };
        Self { quantity, mapping, domain: [0.0, end], len }
    }

    /// # Errors
    /// [`TableError::BadAxis`] unless there are 2 to 4,096 nodes over a finite, increasing domain within the
    /// quantity's range.
    pub fn validate(&self) -> Result<(), TableError> {
        let bad = |reason| Err(TableError::BadAxis { quantity: self.quantity.name(), reason });
        let end = Self::full(self.quantity, self.mapping, 2).domain[1];
        let [low, high] = self.domain;
        if !(2..=4096).contains(&self.len) {
            return bad("must have 2 to 4096 nodes");
        }
        if !(low.is_finite() && high.is_finite() && low < high) {
            return bad("must have a finite, increasing domain");
        }
        if low < 0.0 || high > end + 1e-12 {
            return bad("must lie within the quantity's range");
        }
        Ok(())
    }

    /// Value at node `index`; exact at both ends.
    pub fn node(&self, index: usize) -> f64 {
        let last = self.len - 1;
        if index == 0 {
            return self.domain[0];
        }
        if index >= last {
            return self.domain[1];
        }
        let [low, high] = self.domain.map(|x| self.mapping.coordinate(x));
        self.mapping.value(low + (high - low) * index as f64 / last as f64)
    }

    /// All node values.
    pub fn nodes(&self) -> Vec<f64> {
        (0..self.len).map(|i| self.node(i)).collect()
    }

    /// The cell that contains `value`, and how far into it, in [0, 1]. Values outside the domain go to its ends.
    pub fn locate(&self, value: f64) -> (usize, f64) {
        let [low, high] = self.domain.map(|x| self.mapping.coordinate(x));
        let u = (self.mapping.coordinate(value) - low) / (high - low);
        let within = if u.is_nan() { 0.0 } else { u.clamp(0.0, 1.0) };
        let position = within * (self.len - 1) as f64;
        let cell = (position as usize).min(self.len - 2);
        (cell, position - cell as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_name_is_the_manifests() {
        for mapping in Mapping::ALL {
            assert_eq!(serde_json::to_value(mapping).unwrap(), mapping.name());
        }
    }

    #[test]
    fn the_slope_is_the_difference_quotient() {
        for mapping in Mapping::ALL {
            for value in [0.1, 0.7, 1.0] {
                let u = mapping.coordinate(value);
                let quotient = (mapping.value(u + 1e-5) - mapping.value(u - 1e-5)) / 2e-5;
                assert!((quotient / mapping.slope(value) - 1.0).abs() < 1e-8, "{mapping:?} {value}");
            }
        }
    }

    #[test]
    fn nodes_and_locate_are_each_others_inverse() {
        for mapping in Mapping::ALL {
            for quantity in [Quantity::Theta, Quantity::Alpha] {
                let axis = Axis::full(quantity, mapping, 9);
                for i in 0..9 {
                    let (cell, t) = axis.locate(axis.node(i));
                    assert!((cell as f64 + t - i as f64).abs() < 1e-7, "{mapping:?} {i}: {cell} {t}");
                }
                let middle = axis.mapping.value(
                    0.5 * (axis.mapping.coordinate(axis.node(3)) + axis.mapping.coordinate(axis.node(4))),
                );
                let (cell, t) = axis.locate(middle);
                assert_eq!(cell, 3);
                assert!((t - 0.5).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn outside_goes_to_the_ends() {
        let axis = Axis::full(Quantity::Alpha, Mapping::Linear, 8);
        assert_eq!(axis.locate(-1.0), (0, 0.0));
        assert_eq!(axis.locate(f64::NAN), (0, 0.0));
        assert_eq!(axis.locate(2.0), (6, 1.0));
    }

    #[test]
    fn nonsense_is_refused() {
        let good = Axis::full(Quantity::Theta, Mapping::Linear, 8);
        assert!(good.validate().is_ok());
        assert!(Axis { len: 1, ..good.clone() }.validate().is_err());
        assert!(Axis { domain: [0.0, f64::NAN], ..good.clone() }.validate().is_err());
        assert!(Axis { domain: [1.0, 0.5], ..good.clone() }.validate().is_err());
        assert!(Axis { domain: [0.0, 3.0], ..good }.validate().is_err());
    }
}
