//! Linearly transformed distributions over the four bases of the 2016 paper.

use std::f64::consts::PI;

use glam::{DMat3, DVec3};

use crate::error::ReferenceError;
use crate::lobe::{Lobe, LtcLobe};

/// The shape that a [`TransformedLobe`] starts from (Heitz et al. 2016, Fig. 3), per steradian, z the cosine to the axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BaseShape {
    /// `1 / 4π`.
    UniformSphere,
    /// `1 / 2π` for z > 0.
    UniformHemisphere,
    /// `max(0, z) / π`.
    ClampedCosine,
    /// `3 max(0, z)² / 2π`.
    ClampedCosineSquared,
}

impl BaseShape {
    /// All four.
    pub const ALL: [Self; 4] =
        [Self::UniformSphere, Self::UniformHemisphere, Self::ClampedCosine, Self::ClampedCosineSquared];

    /// The density at this cosine.
    fn density(self, z: f64) -> f64 {
        match self {
            Self::UniformSphere => 1.0 / (4.0 * PI),
            Self::UniformHemisphere if z > 0.0 => 1.0 / (2.0 * PI),
            Self::UniformHemisphere => 0.0,
            Self::ClampedCosine => z.max(0.0) / PI,
            Self::ClampedCosineSquared => 3.0 * z.max(0.0).powi(2) / (2.0 * PI),
        }
    }
}

/// A base moved by a matrix, `D(w) = Do(M⁻¹w / |M⁻¹w|) |det M⁻¹| / |M⁻¹w|³` (Heitz et al. 2016, eq. 1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TransformedLobe {
    shape: BaseShape,
    base_from_target: DMat3,
    /// Of the same matrix: where the mass is.
    ltc: LtcLobe,
}

impl TransformedLobe {
    /// `shape` moved by an invertible matrix; its overall scale has no effect, and neither has the sign of its determinant on
    /// the lobe's mass.
    ///
    /// # Errors
    /// As [`LtcLobe::new`].
    pub fn new(shape: BaseShape, target_from_base: DMat3) -> Result<Self, ReferenceError> {
        let ltc = LtcLobe::new(target_from_base)?;
        Ok(Self { shape, base_from_target: ltc.cosine_from_target(), ltc })
    }
}

impl Lobe for TransformedLobe {
    fn density(&self, wi: DVec3) -> f64 {
        let w = self.base_from_target * wi;
        let length = w.length();
        if length == 0.0 {
            return 0.0;
        }
        self.shape.density(w.z / length) * (self.base_from_target.determinant().abs() / length.powi(3))
    }

    fn half_spaces(&self) -> Vec<DVec3> {
        match self.shape {
            BaseShape::UniformSphere => Vec::new(),
            _ => self.ltc.half_spaces(),
        }
    }

    fn hints(&self) -> Vec<DVec3> {
        let mut hints = self.ltc.hints();
        if self.shape == BaseShape::UniformSphere {
            hints.extend(self.ltc.hints().into_iter().map(|w| -w));
        }
        hints
    }
}
