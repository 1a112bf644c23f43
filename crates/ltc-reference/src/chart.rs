//! Charts: parts of the unit sphere laid out on the unit square.

use std::f64::consts::{PI, TAU};

use glam::{DMat3, DVec3, dvec3};

use crate::error::ReferenceError;

/// A bijection between a part of the unit sphere and the unit square, as bins of directions need it.
///
/// Implement it for a light of odd shape whose directions no cap fits.
pub trait Chart {
    /// The unit direction at `uv` ∈ [0, 1]², and the solid angle per `du dv` there, ≥ 0.
    fn direction(&self, uv: [f64; 2]) -> (DVec3, f64);

    /// Where a unit direction lies in the unit square, or `None` outside of the chart.
    fn place(&self, w: DVec3) -> Option<[f64; 2]>;
}

/// The sphere, a cap or a band around an axis, in equal-area coordinates: u goes with `sin²(θ/2)`, v with φ.
///
/// Accurate to f64's resolution of directions for caps as narrow as 1e-8 rad.
///
/// ```
/// use glam::dvec3;
/// use ltc_reference::{CapChart, Chart};
///
/// let cap = CapChart::cap(dvec3(1.0, 2.0, 2.0), 0.1)?;
/// let (w, solid_angle) = cap.direction([0.5, 0.25]);
/// assert!((cap.place(w).unwrap()[0] - 0.5).abs() < 1e-12 && solid_angle < 0.0315);
/// # Ok::<(), ltc_reference::ReferenceError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CapChart {
    /// Columns: two directions across the axis, the axis.
    frame: DMat3,
    /// `sin²(θ/2)` at the inner border.
    low: f64,
    /// `sin²(θ/2)` at the outer border.
    high: f64,
}

impl CapChart {
    /// The whole sphere around z.
    pub fn sphere() -> Self {
        Self { frame: DMat3::IDENTITY, low: 0.0, high: 1.0 }
    }

    /// The upper hemisphere.
    pub fn hemisphere() -> Self {
        Self { high: 0.5, ..Self::sphere() }
    }

    /// Directions within `angle` ∈ (0, π] radians of `axis` (any length).
    ///
    /// # Errors
    /// As [`CapChart::band`].
    pub fn cap(axis: DVec3, angle: f64) -> Result<Self, ReferenceError> {
        Self::band(axis, [0.0, angle])
    }

    /// Directions at an angle within `theta`, radians, from `axis` (any length). The range is cut to [0, π].
    ///
    /// # Errors
    /// [`ReferenceError::NonFiniteInput`] for an axis without direction and for an empty or NaN range.
    pub fn band(axis: DVec3, theta: [f64; 2]) -> Result<Self, ReferenceError> {
        let axis = axis.try_normalize().ok_or(ReferenceError::NonFiniteInput { what: "axis of a chart" })?;
        let [low, high] = theta.map(|t| (0.5 * t.clamp(0.0, PI)).sin().powi(2));
        if (high - low).is_nan() || low >= high {
            return Err(ReferenceError::NonFiniteInput { what: "range of a chart" });
        }
        let (x, y) = axis.any_orthonormal_pair();
        Ok(Self { frame: DMat3::from_cols(x, y, axis), low, high })
    }
}

impl Chart for CapChart {
    fn direction(&self, [u, v]: [f64; 2]) -> (DVec3, f64) {
        let h = self.low + u * (self.high - self.low);
        let sine = 2.0 * (h * (1.0 - h)).max(0.0).sqrt();
        let (sin_phi, cos_phi) = (TAU * v).sin_cos();
        let w = self.frame * dvec3(sine * cos_phi, sine * sin_phi, 1.0 - 2.0 * h);
        (w, 4.0 * PI * (self.high - self.low))
    }

    fn place(&self, w: DVec3) -> Option<[f64; 2]> {
        let axis = self.frame.z_axis;
        // The nearer pole is the one that keeps the digits.
        let h = if w.dot(axis) >= 0.0 {
            0.25 * (w - axis).length_squared()
        } else {
            1.0 - 0.25 * (w + axis).length_squared()
        };
        let u = (h - self.low) / (self.high - self.low);
        let turns = w.dot(self.frame.y_axis).atan2(w.dot(self.frame.x_axis)) / TAU;
        let v = if turns < 0.0 { turns + 1.0 } else { turns };
        ((0.0..=1.0).contains(&u) && v.is_finite()).then_some([u, v.min(1.0)])
    }
}

/// A chart whose directions are moved by a matrix, `w = M ω / |M ω|`: for lobes and lights that are thin.
///
/// The solid angle changes by `|det M| / |M ω|³` (Heitz et al. 2016, appendix A).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TransformedChart<C> {
    chart: C,
    matrix: DMat3,
    inverse: DMat3,
    determinant: f64,
}

impl<C: Chart> TransformedChart<C> {
    /// `chart` moved by the invertible `matrix`, of any scale.
    ///
    /// # Errors
    /// [`ReferenceError::NonFiniteInput`], [`ReferenceError::SingularMatrix`].
    pub fn new(chart: C, matrix: DMat3) -> Result<Self, ReferenceError> {
        let size = matrix.to_cols_array().into_iter().fold(0.0f64, |m, x| m.max(x.abs()));
        if !matrix.is_finite() {
            return Err(ReferenceError::NonFiniteInput { what: "matrix of a chart" });
        }
        let matrix = matrix * (1.0 / if size > 0.0 { size } else { 1.0 });
        let determinant = matrix.determinant();
        if determinant == 0.0 || !matrix.inverse().is_finite() {
            return Err(ReferenceError::SingularMatrix { determinant });
        }
        Ok(Self { chart, matrix, inverse: matrix.inverse(), determinant })
    }
}

impl<C: Chart> Chart for TransformedChart<C> {
    fn direction(&self, uv: [f64; 2]) -> (DVec3, f64) {
        let (w, solid_angle) = self.chart.direction(uv);
        let moved = self.matrix * w;
        let length = moved.length();
        (moved / length, solid_angle * self.determinant.abs() / (length * length * length))
    }

    fn place(&self, w: DVec3) -> Option<[f64; 2]> {
        (self.inverse * w).try_normalize().and_then(|w| self.chart.place(w))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::points::R2;

    fn check(chart: &impl Chart, solid_angle: Option<f64>) {
        let n = 4096;
        let mut total = 0.0;
        for i in 0..n {
            let uv = R2::new().point(i);
            let (w, element) = chart.direction(uv);
            total += element / n as f64;
            let back = chart.place(w).expect("the direction is in the chart");
            assert!((w.length() - 1.0).abs() < 1e-14);
            let (again, _) = chart.direction(back);
            assert!((again - w).length() < 1e-14, "{uv:?} {back:?}");
            // The element is the area spanned by the derivatives.
            let h = 1e-5;
            let [du, dv] = [[h, 0.0], [0.0, h]].map(|d| {
                let at = |s: f64| chart.direction([uv[0] + s * d[0], uv[1] + s * d[1]]).0;
                (at(1.0) - at(-1.0)) / (2.0 * h)
            });
            let near_border = uv.iter().any(|x| !(0.01..0.99).contains(x));
            assert!(near_border || (du.cross(dv).length() / element - 1.0).abs() < 1e-5, "{uv:?}");
        }
        assert!(solid_angle.is_none_or(|expected| (total / expected - 1.0).abs() < 1e-3), "{total}");
    }

    #[test]
    fn charts_are_bijections_with_the_right_element() {
        check(&CapChart::sphere(), Some(4.0 * PI));
        check(&CapChart::hemisphere(), Some(TAU));
        let axis = dvec3(0.3, -2.0, 0.7);
        for angle in [3.0f64, 1.0, 0.1] {
            let expected = 4.0 * PI * (0.5 * angle).sin().powi(2);
            check(&CapChart::cap(axis, angle).expect("a valid cap"), Some(expected));
        }
        check(&CapChart::band(axis, [0.5, 0.9]).expect("a valid band"), None);
        let matrix = DMat3::from_cols(dvec3(0.3, 0.0, 0.1), dvec3(0.1, 0.2, 0.0), dvec3(-0.4, 0.2, 1.0));
        let moved = TransformedChart::new(CapChart::sphere(), matrix).expect("invertible");
        check(&moved, Some(4.0 * PI));
    }

    #[test]
    fn narrow_caps_keep_their_digits() {
        for angle in [1e-3, 1e-5, 1e-7] {
            let chart = CapChart::cap(dvec3(1.0, 2.0, -0.5), angle).expect("a valid cap");
            for i in 0..1000 {
                let uv = R2::new().point(i);
                let back = chart.place(chart.direction(uv).0).expect("the direction is in the chart");
                // An angle of one rounding error of a direction.
                let resolution = 1e-15 / angle;
                assert!(
                    (back[0] - uv[0]).abs() < resolution
                        && (back[1] - uv[1]).abs() < resolution / uv[0].sqrt()
                );
            }
        }
    }

    #[test]
    fn what_is_no_chart_is_an_error() {
        assert!(CapChart::cap(DVec3::ZERO, 1.0).is_err());
        assert!(CapChart::cap(DVec3::Z, f64::NAN).is_err());
        assert!(CapChart::band(DVec3::Z, [1.0, 1.0]).is_err());
        assert!(TransformedChart::new(CapChart::sphere(), DMat3::ZERO).is_err());
        assert!(TransformedChart::new(CapChart::sphere(), DMat3::NAN).is_err());
        assert_eq!(CapChart::hemisphere().place(-DVec3::Z), None);
        assert_eq!(CapChart::sphere().place(DVec3::NAN), None);
    }
}
