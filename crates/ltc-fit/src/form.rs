//! The forms of `M` that isotropic lobes were fitted in before, with fewer parameters than a lobe has freedom.

use glam::{DMat3, DVec3};

use crate::{Lobe, bfgs::Point};

/// `M = B m` with three or four parameters in `m`, or `M` itself with four; for lobes seen from φ = 0, which mirror in y.
///
/// `B` turns z to the mean direction of the lobe, which is computed and not fitted. Under this symmetry a lobe has four degrees of
/// freedom; of the three with `B` each leaves some out, [`Form::Four`] none but the lobes whose median lies on the horizon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// `m = [[m₁₁, 0, m₁₃], [0, m₂₂, 0], [0, 0, 1]]` (the blog on fitting, "shearing in x").
    XShear,
    /// The same with m₂₃ in the second row: four parameters, of which the last comes out as 0 (the blog, of the 2016 fitter).
    XyShear,
    /// `m = [[m₁₁, 0, 0], [0, m₂₂, 0], [m₃₁, 0, 1]]` (the blog, "shearing in z").
    ZShear,
    /// `M = [[a, 0, b], [0, c, 0], [d, 0, 1]]` (2016 paper, eq. 6): no lobe whose median lies on the horizon.
    Four,
}

/// Widths are kept above this.
const MIN_WIDTH: f64 = 1e-7;

impl Form {
    /// Number of parameters.
    pub fn dimension(self) -> usize {
        match self {
            Self::XShear | Self::ZShear => 3,
            Self::XyShear | Self::Four => 4,
        }
    }

    /// The parameters of the identity.
    pub fn identity(self) -> Point {
        let mut point = Point::default();
        (point[0], point[1]) = (1.0, 1.0);
        point
    }

    /// The parameters of a round lobe about the normal, of this width.
    pub fn round(self, width: f64) -> Point {
        let mut point = Point::default();
        (point[0], point[1]) = (width, width);
        point
    }

    /// `M = target_from_cosine`; `mean` from [`mean_direction`]. Parameters: m₁₁, m₂₂, the shear(s), or a, c, b, d.
    pub fn matrix(self, p: &Point, mean: DVec3) -> DMat3 {
        let (u, v) = (p[0].max(MIN_WIDTH), p[1].max(MIN_WIDTH));
        let columns = |shear_x: f64, shear_y: f64, shear_z: f64| {
            DMat3::from_cols(
                DVec3::new(u, 0.0, shear_z),
                DVec3::new(0.0, v, 0.0),
                DVec3::new(shear_x, shear_y, 1.0),
            )
        };
        let turn =
            DMat3::from_cols(DVec3::new(mean.z, 0.0, -mean.x), DVec3::Y, DVec3::new(mean.x, 0.0, mean.z));
        match self {
            Self::XShear => turn * columns(p[2], 0.0, 0.0),
            Self::XyShear => turn * columns(p[2], p[3], 0.0),
            Self::ZShear => turn * columns(0.0, 0.0, p[2]),
            Self::Four => columns(p[2], 0.0, p[3]),
        }
    }
}

/// The mean direction of a lobe, in the plane y = 0 (the blog's `ω̄ᵢ`).
pub fn mean_direction(lobe: &Lobe) -> DVec3 {
    let sum: DVec3 = (0..lobe.len()).map(|i| lobe.direction(i) * lobe.weight[i]).sum();
    DVec3::new(sum.x, 0.0, sum.z).try_normalize().unwrap_or(DVec3::Z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::objective::testing::ggx;

    #[test]
    fn each_form_begins_as_a_cosine_around_the_mean() {
        let mean = DVec3::new(-0.6, 0.0, 0.8);
        for form in [Form::XShear, Form::XyShear, Form::ZShear] {
            let m = form.matrix(&form.identity(), mean);
            assert!(m.z_axis.abs_diff_eq(mean, 1e-15));
            assert!((m * m.transpose()).abs_diff_eq(DMat3::IDENTITY, 1e-12), "{form:?} turns only");
            assert!((m.determinant() - 1.0).abs() < 1e-12);
        }
        assert_eq!(Form::Four.matrix(&Form::Four.identity(), mean), DMat3::IDENTITY);
    }

    #[test]
    fn shears_are_where_the_blog_has_them() {
        let mut p = Point::default();
        (p[0], p[1], p[2], p[3]) = (0.5, 0.25, 0.1, 0.2);
        let rows = |form: Form| form.matrix(&p, DVec3::Z).transpose().to_cols_array();
        assert_eq!(rows(Form::XShear), [0.5, 0.0, 0.1, 0.0, 0.25, 0.0, 0.0, 0.0, 1.0]);
        assert_eq!(rows(Form::XyShear), [0.5, 0.0, 0.1, 0.0, 0.25, 0.2, 0.0, 0.0, 1.0]);
        assert_eq!(rows(Form::ZShear), [0.5, 0.0, 0.0, 0.0, 0.25, 0.0, 0.1, 0.0, 1.0]);
        assert_eq!(rows(Form::Four), [0.5, 0.0, 0.1, 0.0, 0.25, 0.0, 0.2, 0.0, 1.0]);
    }

    #[test]
    fn a_lobe_seen_from_phi_zero_lies_opposite() {
        let mean = mean_direction(&ggx(0.8, 0.0, 0.2, 0.2, 1024));
        assert!(mean.x < -0.5 && mean.y == 0.0 && mean.z > 0.3, "{mean}");
        assert_eq!(mean_direction(&Lobe::default()), DVec3::Z);
    }
}
