//! Linearly transformed cosines.

use crate::{InputError, Matrix, Real, Vector};
use glam::DVec3;

/// A clamped cosine whose directions are moved by a matrix `M`: the distribution
/// `D(ω) = Do(M⁻¹ω / ‖M⁻¹ω‖) · |M⁻¹| / ‖M⁻¹ω‖³`, `Do(ω) = max(0, z)/π`
/// (Heitz et al. 2016, eq. 1 and 4). It integrates to 1 over the sphere.
///
/// `M = target_from_cosine` maps cosine space to the lobe; det M > 0. Its scale is free and kept at 1 for the largest
/// entry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ltc<R: Real> {
    target_from_cosine: R::Mat3,
    cosine_from_target: R::Mat3,
    /// Determinant of `target_from_cosine`.
    determinant: R,
}

impl<R: Real> Ltc<R> {
    /// The LTC of `M = target_from_cosine`, any positive scale.
    ///
    /// # Errors
    /// [`InputError::NotFinite`] for a NaN or infinite entry; [`InputError::SingularMatrix`] unless det M > 0 and M⁻¹
    /// has finite entries in this precision.
    pub fn new(target_from_cosine: R::Mat3) -> Result<Self, InputError> {
        let columns = target_from_cosine.columns();
        if !columns.iter().all(|c| c.is_finite()) {
            return Err(InputError::NotFinite { name: "matrix m" });
        }
        let largest = columns[0].max_abs().max(columns[1].max_abs()).max(columns[2].max_abs());
        if largest <= R::ZERO {
            return Err(InputError::SingularMatrix { determinant: 0.0 });
        }
        // In f64, so that an f32 inverse is off by its own rounding alone, not by that of the products in it.
        let wide = |c: R::Vec3| DVec3::new(c.x().to_f64(), c.y().to_f64(), c.z().to_f64()) / largest.to_f64();
        let [c0, c1, c2] = columns.map(wide);
        let rows = [c1.cross(c2), c2.cross(c0), c0.cross(c1)];
        let determinant = c0.dot(rows[0]);
        let inverse_scale = 1.0 / determinant;
        let round = |v: DVec3| R::Vec3::new(R::of(v.x), R::of(v.y), R::of(v.z));
        let [r0, r1, r2] = rows.map(|r| round(r * inverse_scale));
        let valid = R::of(determinant) > R::ZERO && [r0, r1, r2].iter().all(|r| r.is_finite());
        if !valid {
            return Err(InputError::SingularMatrix { determinant });
        }
        Ok(Self {
            target_from_cosine: R::Mat3::from_columns(round(c0), round(c1), round(c2)),
            cosine_from_target: R::Mat3::from_columns(r0, r1, r2).transposed(),
            determinant: R::of(determinant),
        })
    }

    /// The clamped cosine itself (M = identity): Lambert's diffuse lobe.
    pub fn cosine() -> Self {
        let (o, l) = (R::ZERO, R::ONE);
        let identity =
            R::Mat3::from_columns(R::Vec3::new(l, o, o), R::Vec3::new(o, l, o), R::Vec3::new(o, o, l));
        Self { target_from_cosine: identity, cosine_from_target: identity, determinant: l }
    }

    /// `M`, with its largest entry scaled to 1.
    pub fn target_from_cosine(&self) -> R::Mat3 {
        self.target_from_cosine
    }

    /// `M⁻¹`, the inverse of [`Ltc::target_from_cosine`].
    pub fn cosine_from_target(&self) -> R::Mat3 {
        self.cosine_from_target
    }

    /// Density at the unit direction `w`, in 1/sr.
    pub fn density(&self, w: R::Vec3) -> R {
        let wo = self.cosine_from_target.apply(w);
        if wo.z() <= R::ZERO {
            return R::ZERO;
        }
        let squared = wo.dot(wo);
        wo.z() / (R::PI * self.determinant * squared * squared)
    }

    /// A direction of density [`Ltc::density`], from `u` ∈ [0, 1)² (2016 paper, Algorithm 1).
    pub fn sample(&self, u: [R; 2]) -> R::Vec3 {
        let r = u[0].sqrt();
        let (sin, cos) = (R::of(2.0) * R::PI * u[1]).sin_cos();
        let wo = R::Vec3::new(r * cos, r * sin, (R::ONE - u[0]).max(R::ZERO).sqrt());
        self.target_from_cosine.apply(wo).try_unit().unwrap_or_else(|| self.median())
    }

    /// The median direction: every plane through it and the origin halves the lobe (2016 paper, §3.1).
    pub fn median(&self) -> R::Vec3 {
        let [_, _, c2] = self.target_from_cosine.columns();
        c2.try_unit().unwrap_or(R::Vec3::new(R::ZERO, R::ZERO, R::ONE))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::r2;
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
