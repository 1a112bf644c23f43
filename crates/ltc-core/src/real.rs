//! The two precisions: one body of code for `f64` (truth) and `f32` (speed).

use core::fmt::{Debug, Display};
use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// A 3-vector of glam ([`glam::Vec3`] or [`glam::DVec3`]), as generic code sees it.
pub trait Vector<R>:
    Copy
    + Debug
    + PartialEq
    + Send
    + Sync
    + Add<Output = Self>
    + AddAssign
    + Sub<Output = Self>
    + Mul<R, Output = Self>
    + Neg<Output = Self>
    + 'static
{
    /// The vector (x, y, z).
    fn new(x: R, y: R, z: R) -> Self;
    /// Component along the tangent.
    fn x(self) -> R;
    /// Component along the bitangent.
    fn y(self) -> R;
    /// Component along the normal.
    fn z(self) -> R;
    /// Scalar product.
    fn dot(self, other: Self) -> R;
    /// Vector product, right-handed.
    fn cross(self, other: Self) -> Self;
    /// Whether no component is NaN or infinite.
    fn is_finite(self) -> bool;

    /// Euclidean length.
    fn length(self) -> R;
    /// Largest magnitude of a component.
    fn max_abs(self) -> R;
    /// The unit vector of the same direction, or `None` for zero, non-finite, or too small a length.
    fn try_unit(self) -> Option<Self>;
}

/// A 3×3 matrix of glam, column-major in memory as glam has it.
pub trait Matrix<R, V>: Copy + Debug + PartialEq + Send + Sync + 'static {
    /// The matrix with these columns.
    fn from_columns(x: V, y: V, z: V) -> Self;
    /// Its columns.
    fn columns(self) -> [V; 3];
    /// Matrix times column vector.
    fn apply(self, v: V) -> V;
    /// Matrix product `self · other`.
    fn product(self, other: Self) -> Self;
    /// The transposed matrix.
    fn transposed(self) -> Self;

    /// Nine numbers, row-major: how matrices are written out everywhere.
    fn to_row_array(self) -> [R; 9]
    where
        V: Vector<R>,
    {
        let [a, b, c] = self.columns();
        [a.x(), b.x(), c.x(), a.y(), b.y(), c.y(), a.z(), b.z(), c.z()]
    }

    /// From nine numbers, row-major.
    fn from_row_array(m: [R; 9]) -> Self
    where
        V: Vector<R>,
    {
        let [m00, m01, m02, m10, m11, m12, m20, m21, m22] = m;
        Self::from_columns(V::new(m00, m10, m20), V::new(m01, m11, m21), V::new(m02, m12, m22))
    }
}

/// A floating-point precision: `f32` or `f64`.
///
/// Mathematics that is generic over `Real` is compiled for both; constants are written in `f64` and
/// rounded once by [`Real::of`].
pub trait Real:
    Copy
    + Debug
    + Display
    + PartialOrd
    + Send
    + Sync
    + Add<Output = Self>
    + AddAssign
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + 'static
{
    /// The 3-vector of this precision.
    type Vec3: Vector<Self>;
    /// The 3×3 matrix of this precision.
    type Mat3: Matrix<Self, Self::Vec3>;
    /// 0
    const ZERO: Self;
    /// 1
    const ONE: Self;
    /// π
    const PI: Self;
    /// Distance from 1 to the next larger number.
    const EPSILON: Self;
    /// The smallest normal positive number.
    const TINY: Self;

    /// Rounds from `f64`: the one place where precision is lost.
    fn of(value: f64) -> Self;
    /// Widens to `f64`.
    fn to_f64(self) -> f64;
    /// Neither NaN nor infinite.
    fn is_finite(self) -> bool;
    /// Magnitude.
    fn abs(self) -> Self;
    /// Square root.
    fn sqrt(self) -> Self;
    /// Cube root.
    fn cbrt(self) -> Self;
    /// Sine and cosine.
    fn sin_cos(self) -> (Self, Self);
    /// Four-quadrant arc tangent of `self / x`.
    fn atan2(self, x: Self) -> Self;
    /// `a·b − c·d` with a relative error below 2 ε however much cancels: f32 by f64, whose products are then exact, f64 by
    /// a fused multiply-add (Kahan).
    fn product_difference(a: Self, b: Self, c: Self, d: Self) -> Self;
    /// The largest power of two that is not above `|self|`; 0 below [`Real::TINY`]. Scaling by it rounds nothing.
    fn floor_power_of_two(self) -> Self;
    /// Inverse hyperbolic tangent, for |self| < 1.
    fn atanh(self) -> Self;
    /// The larger; the other one where one is NaN.
    fn max(self, other: Self) -> Self;
    /// The smaller; the other one where one is NaN.
    fn min(self, other: Self) -> Self;

    /// `self` restricted to `[low, high]`; `low` for NaN, so that nothing downstream sees one.
    fn clamped(self, low: Self, high: Self) -> Self {
        self.max(low).min(high)
    }
    /// `self²`
    fn squared(self) -> Self {
        self * self
    }
}

fn product_difference_f32(a: f32, b: f32, c: f32, d: f32) -> f32 {
    (f64::from(a) * f64::from(b) - f64::from(c) * f64::from(d)) as f32
}

fn product_difference_f64(a: f64, b: f64, c: f64, d: f64) -> f64 {
    let product = c * d;
    let rounding = (-c).mul_add(d, product);
    a.mul_add(b, -product) + rounding
}

macro_rules! impl_real {
    ($real:ident, $vec:ty, $mat:ty, $product_difference:ident) => {
        impl Real for $real {
            type Vec3 = $vec;
            type Mat3 = $mat;
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            const PI: Self = core::$real::consts::PI;
            const EPSILON: Self = $real::EPSILON;
            const TINY: Self = $real::MIN_POSITIVE;

            #[inline]
            fn of(value: f64) -> Self {
                value as $real
            }
            #[inline]
            fn to_f64(self) -> f64 {
                f64::from(self)
            }
            #[inline]
            fn is_finite(self) -> bool {
                $real::is_finite(self)
            }
            #[inline]
            fn abs(self) -> Self {
                $real::abs(self)
            }
            #[inline]
            fn sqrt(self) -> Self {
                $real::sqrt(self)
            }
            #[inline]
            fn cbrt(self) -> Self {
                $real::cbrt(self)
            }
            #[inline]
            fn sin_cos(self) -> (Self, Self) {
                $real::sin_cos(self)
            }
            #[inline]
            fn atan2(self, x: Self) -> Self {
                $real::atan2(self, x)
            }
            #[inline]
            fn product_difference(a: Self, b: Self, c: Self, d: Self) -> Self {
                $product_difference(a, b, c, d)
            }
            #[inline]
            fn floor_power_of_two(self) -> Self {
                // The bits of infinity are those of the exponent.
                $real::from_bits(self.to_bits() & $real::INFINITY.to_bits())
            }
            #[inline]
            fn atanh(self) -> Self {
                $real::atanh(self)
            }
            #[inline]
            fn max(self, other: Self) -> Self {
                $real::max(self, other)
            }
            #[inline]
            fn min(self, other: Self) -> Self {
                $real::min(self, other)
            }
        }

        impl Vector<$real> for $vec {
            #[inline]
            fn new(x: $real, y: $real, z: $real) -> Self {
                <$vec>::new(x, y, z)
            }
            #[inline]
            fn x(self) -> $real {
                self.x
            }
            #[inline]
            fn y(self) -> $real {
                self.y
            }
            #[inline]
            fn z(self) -> $real {
                self.z
            }
            #[inline]
            fn dot(self, other: Self) -> $real {
                <$vec>::dot(self, other)
            }
            #[inline]
            fn cross(self, other: Self) -> Self {
                <$vec>::cross(self, other)
            }
            #[inline]
            fn is_finite(self) -> bool {
                <$vec>::is_finite(self)
            }
            #[inline]
            fn length(self) -> $real {
                <$vec>::length(self)
            }
            #[inline]
            fn max_abs(self) -> $real {
                self.abs().max_element()
            }
            #[inline]
            fn try_unit(self) -> Option<Self> {
                // Scaling by the largest component first keeps the square of the length in range.
                let scale = self.max_abs();
                if !(scale > 0.0 && scale.is_finite()) {
                    return None;
                }
                (self / scale).try_normalize()
            }
        }

        impl Matrix<$real, $vec> for $mat {
            #[inline]
            fn from_columns(x: $vec, y: $vec, z: $vec) -> Self {
                <$mat>::from_cols(x, y, z)
            }
            #[inline]
            fn columns(self) -> [$vec; 3] {
                [self.x_axis, self.y_axis, self.z_axis]
            }
            #[inline]
            fn apply(self, v: $vec) -> $vec {
                self * v
            }
            #[inline]
            fn product(self, other: Self) -> Self {
                self * other
            }
            #[inline]
            fn transposed(self) -> Self {
                self.transpose()
            }
        }
    };
}

impl_real!(f32, glam::Vec3, glam::Mat3, product_difference_f32);
impl_real!(f64, glam::DVec3, glam::DMat3, product_difference_f64);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_and_columns_are_each_others_inverse() {
        let rows = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0];
        let m = glam::DMat3::from_row_array(rows);
        assert_eq!(m.to_row_array(), rows);
        assert_eq!(m.apply(glam::DVec3::X), glam::DVec3::new(1.0, 4.0, 7.0));
    }

    #[test]
    fn unit_vectors_exist_for_tiny_and_huge_vectors_only() {
        for scale in [1e-300, 1e-30, 1.0, 1e30, 1e300] {
            let unit = (glam::DVec3::new(1.0, 2.0, 2.0) * scale).try_unit().unwrap();
            assert!((unit.length() - 1.0).abs() < 1e-15, "{scale}: {unit}");
        }
        assert_eq!(glam::DVec3::ZERO.try_unit(), None);
        assert_eq!(glam::DVec3::new(f64::NAN, 1.0, 0.0).try_unit(), None);
        assert_eq!(glam::DVec3::new(f64::INFINITY, 1.0, 0.0).try_unit(), None);
    }

    #[test]
    fn differences_of_products_keep_their_digits() {
        // (1 + ε)(1 − ε) − 1·1 = −ε², which a plain difference rounds to 0 or to a multiple of ε.
        let e = f64::EPSILON;
        assert_eq!(f64::product_difference(1.0 + e, 1.0 - e, 1.0, 1.0), -e * e);
        let e = f32::EPSILON;
        assert_eq!(f32::product_difference(1.0 + e, 1.0 - e, 1.0, 1.0), -e * e);
    }

    #[test]
    fn powers_of_two_are_at_most_the_number() {
        for (x, power) in [(1.0, 1.0), (-1.9, 1.0), (5.0, 4.0), (0.3, 0.25), (0.0, 0.0)] {
            assert_eq!(f64::floor_power_of_two(x), power);
            assert_eq!(f32::floor_power_of_two(x as f32), power as f32);
        }
        assert_eq!((f32::TINY / 2.0).floor_power_of_two(), 0.0);
    }

    #[test]
    fn clamping_swallows_nan() {
        assert_eq!(f64::NAN.clamped(0.0, 1.0), 0.0);
    }
}
