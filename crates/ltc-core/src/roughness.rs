//! Widths of the GGX distribution, and the perceptual roughness of artists, as two types.

use crate::{InputError, error::check_range};

/// The smallest GGX width that is evaluated: smaller ones, 0 included, are raised to it.
///
/// A lobe of this width spans about 0.01°, below what any light or pixel resolves, and all of the
/// arithmetic stays far from under- and overflow in `f64` (in `f32` the density reaches 3·10⁷).
pub const ALPHA_MIN: f64 = 1e-4;

/// Perceptual roughness in [0, 1]; the GGX width is its square.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct PerceptualRoughness(f64);

impl PerceptualRoughness {
    /// # Errors
    /// [`InputError`] unless `value` is in [0, 1].
    pub fn new(value: f64) -> Result<Self, InputError> {
        check_range("roughness", value, 0.0, 1.0).map(Self)
    }

    /// The number itself.
    pub fn get(self) -> f64 {
        self.0
    }
}

/// GGX widths along the tangent and the bitangent, each in [[`ALPHA_MIN`], 1].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Alpha {
    x: f64,
    y: f64,
}

impl Alpha {
    /// Widths along tangent and bitangent; values in [0, `ALPHA_MIN`) are raised to [`ALPHA_MIN`].
    ///
    /// # Errors
    /// [`InputError`] unless both are in [0, 1].
    pub fn new(alpha_x: f64, alpha_y: f64) -> Result<Self, InputError> {
        let x = check_range("alpha_x", alpha_x, 0.0, 1.0)?.max(ALPHA_MIN);
        let y = check_range("alpha_y", alpha_y, 0.0, 1.0)?.max(ALPHA_MIN);
        Ok(Self { x, y })
    }

    /// The same width in all directions.
    ///
    /// # Errors
    /// [`InputError`] unless `alpha` is in [0, 1].
    pub fn isotropic(alpha: f64) -> Result<Self, InputError> {
        Self::new(alpha, alpha)
    }

    /// From perceptual roughness `r` and anisotropy `a` ∈ [0, 1] as glTF's `KHR_materials_anisotropy` has them:
    /// `alpha_x = mix(r², 1, a²)` along the tangent, `alpha_y = r²`.
    ///
    /// # Errors
    /// [`InputError`] unless `anisotropy` is in [0, 1].
    pub fn from_perceptual(roughness: PerceptualRoughness, anisotropy: f64) -> Result<Self, InputError> {
        let a2 = check_range("anisotropy", anisotropy, 0.0, 1.0)?.powi(2);
        let alpha = roughness.0 * roughness.0;
        Self::new(alpha + (1.0 - alpha) * a2, alpha)
    }

    /// Width along the tangent.
    pub fn x(self) -> f64 {
        self.x
    }

    /// Width along the bitangent.
    pub fn y(self) -> f64 {
        self.y
    }

    /// The larger of both: the table's α.
    pub fn major(self) -> f64 {
        self.x.max(self.y)
    }

    /// The perceptual roughness of the larger width, √α.
    pub fn perceptual(self) -> PerceptualRoughness {
        PerceptualRoughness(self.major().sqrt())
    }

    /// λ = smaller / larger ∈ (0, 1].
    pub fn ratio(self) -> f64 {
        self.x.min(self.y) / self.major()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn perceptual_roughness_is_the_square_root() {
        let r = PerceptualRoughness::new(0.5).unwrap();
        let alpha = Alpha::from_perceptual(r, 0.0).unwrap();
        assert_eq!((alpha.x(), alpha.y()), (0.25, 0.25));
        let full = Alpha::from_perceptual(r, 1.0).unwrap();
        assert_eq!((full.x(), full.y()), (1.0, 0.25));
        assert_eq!((alpha.perceptual(), full.perceptual().get()), (r, 1.0));
    }

    #[test]
    fn zero_is_raised_to_the_floor_and_nonsense_is_refused() {
        let alpha = Alpha::new(0.0, 0.0).unwrap();
        assert_eq!((alpha.major(), alpha.ratio()), (ALPHA_MIN, 1.0));
        for bad in [-0.1, 1.1, f64::NAN, f64::INFINITY] {
            assert!(Alpha::new(bad, 0.5).is_err(), "{bad}");
            assert!(Alpha::new(0.5, bad).is_err(), "{bad}");
        }
    }
}
