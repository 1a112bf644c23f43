//! Linearly transformed cosines.

use crate::{ClampedCosine, LinearlyTransformed, Real};

/// A linearly transformed cosine: a clamped cosine whose directions are moved by a matrix `M`,
/// `D(ω) = Do(M⁻¹ω / ‖M⁻¹ω‖) · |M⁻¹| / ‖M⁻¹ω‖³`, `Do(ω) = max(0, z)/π` (Heitz et al. 2016, eq. 1 and 4). It integrates
/// to 1 over the sphere.
///
/// `M = target_from_cosine` maps cosine space to the lobe; det M > 0. Its scale is free and kept at 1 for the largest
/// entry.
///
/// ```
/// use glam::{DMat3, DVec3};
/// use ltc_core::{Ltc, Matrix};
///
/// let ltc = Ltc::<f64>::new(DMat3::from_row_array([0.3, 0.0, 0.4, 0.0, 0.2, 0.0, -0.1, 0.0, 0.9]))?;
/// assert!(ltc.density(ltc.sample([0.2, 0.7])) > 0.0);
/// assert!(ltc.density(-ltc.median()) == 0.0);
/// # Ok::<(), ltc_core::InputError>(())
/// ```
pub type Ltc<R> = LinearlyTransformed<R, ClampedCosine>;

impl<R: Real> Ltc<R> {
    /// The clamped cosine itself (M = identity): Lambert's diffuse lobe.
    pub fn cosine() -> Self {
        Self::identity()
    }

    /// `M`, with its largest entry scaled to 1.
    pub fn target_from_cosine(&self) -> R::Mat3 {
        self.target_from_base()
    }

    /// `M⁻¹`, the inverse of [`Ltc::target_from_cosine`].
    pub fn cosine_from_target(&self) -> R::Mat3 {
        self.base_from_target()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::r2;
    use crate::{InputError, Matrix as _};
    use glam::{DMat3, DVec3, Mat3};

    fn lobes() -> [Ltc<f64>; 3] {
        [
            [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
            [0.4, 0.05, -0.6, 0.0, 0.2, -0.2, 0.1, 0.0, 0.7],
            [2.0, 0.3, 0.4, -0.2, 0.7, 0.1, 0.5, 0.2, 1.3],
        ]
        .map(|rows| Ltc::new(DMat3::from_row_array(rows)).unwrap())
    }

    #[test]
    fn density_integrates_to_one_and_matches_its_samples() {
        for ltc in lobes() {
            // Expectation of z under uniform sphere points weighted by the density, against the samples' mean z.
            let n = 1 << 20;
            let (mut mass, mut mean) = (0.0, DVec3::ZERO);
            for i in 0..n {
                let [u, v] = r2(i);
                let z = 1.0 - 2.0 * u;
                let (sin, cos) = (core::f64::consts::TAU * v).sin_cos();
                let r = (1.0 - z * z).sqrt();
                let w = DVec3::new(r * cos, r * sin, z);
                let p = ltc.density(w) * 4.0 * core::f64::consts::PI / n as f64;
                mass += p;
                mean += w * p;
            }
            let sampled: DVec3 = (0..n).map(|i| ltc.sample(r2(i))).sum::<DVec3>() / n as f64;
            assert!((mass - 1.0).abs() < 2e-3, "{mass}");
            assert!((mean - sampled).length() < 2e-3, "{mean} {sampled}");
        }
    }

    #[test]
    fn the_median_halves_the_lobe() {
        for ltc in lobes() {
            let n = 1 << 16;
            for axis in [DVec3::X, DVec3::Y, DVec3::new(1.0, 2.0, -1.0)] {
                let plane = ltc.median().cross(axis);
                let above = (0..n).filter(|i| ltc.sample(r2(*i)).dot(plane) > 0.0).count();
                assert!((above as f64 / n as f64 - 0.5).abs() < 2e-3);
            }
        }
    }

    #[test]
    fn scale_does_not_matter_and_the_inverse_is_one() {
        let m = lobes()[1].target_from_cosine();
        for scale in [1e-200, 1e-3, 1e200] {
            let ltc = Ltc::<f64>::new(m * scale).unwrap();
            assert!(
                (ltc.density(ltc.median()) / lobes()[1].density(lobes()[1].median()) - 1.0).abs() < 1e-12
            );
            let product = ltc.cosine_from_target() * ltc.target_from_cosine();
            assert!(product.abs_diff_eq(DMat3::IDENTITY, 1e-12));
        }
    }

    #[test]
    fn bad_matrices_are_refused() {
        let flip = DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0));
        assert!(matches!(Ltc::<f64>::new(flip), Err(InputError::SingularMatrix { .. })));
        assert!(matches!(Ltc::<f64>::new(DMat3::ZERO), Err(InputError::SingularMatrix { .. })));
        assert!(matches!(Ltc::<f64>::new(DMat3::NAN), Err(InputError::NotFinite { .. })));
        let flat = Mat3::from_diagonal(glam::Vec3::new(1e-30, 1e-30, 1.0));
        assert!(Ltc::<f32>::new(flat).is_err(), "the inverse overflows in f32");
    }
}
