//! Schlick's Fresnel term, and how a table's two channels make the reflectance.

use crate::Real;

/// `(1 − cos)^5`, the weight of F90 in Schlick's approximation; `cos` = ωo·ωh is clamped to [0, 1].
pub fn schlick_weight<R: Real>(cos: R) -> R {
    let m = R::ONE - cos.clamped(R::ZERO, R::ONE);
    let m2 = m * m;
    m2 * m2 * m
}

/// Schlick's Fresnel reflectance `F0 + (F90 − F0)(1 − cos)^5`.
pub fn schlick<R: Real>(f0: R, f90: R, cos: R) -> R {
    f0 + (f90 - f0) * schlick_weight(cos)
}

/// Directional reflectance from a table's channels: `F0·n + (F90 − F0)·f`,
/// with `n = ∫ ρ cos` at F = 1 and `f = ∫ (1 − ωo·ωh)^5 ρ cos`.
pub fn reflectance<R: Real>(f0: R, f90: R, magnitude: R, fresnel: R) -> R {
    f0 * magnitude + (f90 - f0) * fresnel
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_of_schlick() {
        assert_eq!(schlick(0.04, 1.0, 1.0), 0.04);
        assert_eq!(schlick(0.04, 1.0, 0.0), 1.0);
        assert_eq!(schlick_weight(2.0), 0.0);
        assert!((schlick_weight(0.5_f64) - 0.03125).abs() < 1e-16);
    }

    #[test]
    fn reflectance_is_linear_in_both_channels() {
        assert_eq!(reflectance(1.0, 1.0, 0.9, 0.2), 0.9);
        assert!((reflectance(0.04_f64, 1.0, 0.9, 0.1) - (0.036 + 0.096)).abs() < 1e-16);
    }
}
