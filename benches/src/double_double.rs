//! Numbers of twice the digits of `f64`: the oracle for rounding errors.
//!
//! A number is the unevaluated sum of two `f64` that do not overlap: about 31 decimal digits. The algorithms are the
//! textbook ones (Dekker 1971, Knuth 1969: error-free sums and products; here with fused multiply-add).

use std::fmt;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// A number of about 31 decimal digits.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd, Default)]
pub struct DoubleDouble {
    high: f64,
    low: f64,
}

/// `a + b` and its rounding error.
fn two_sum(a: f64, b: f64) -> DoubleDouble {
    let high = a + b;
    let from_b = high - a;
    DoubleDouble { high, low: (a - (high - from_b)) + (b - from_b) }
}

/// The same where |a| ≥ |b|. A sum that overflowed has no error to speak of.
fn quick_two_sum(a: f64, b: f64) -> DoubleDouble {
    let high = a + b;
    let low = b - (high - a);
    DoubleDouble { high, low: if high.is_finite() { low } else { 0.0 } }
}

fn two_product(a: f64, b: f64) -> DoubleDouble {
    let high = a * b;
    let low = a.mul_add(b, -high);
    DoubleDouble { high, low: if low.is_finite() { low } else { 0.0 } }
}

impl From<f64> for DoubleDouble {
    fn from(high: f64) -> Self {
        Self { high, low: 0.0 }
    }
}

impl fmt::Display for DoubleDouble {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} + {}", self.high, self.low)
    }
}

impl Add for DoubleDouble {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let high = two_sum(self.high, other.high);
        let low = two_sum(self.low, other.low);
        let sum = quick_two_sum(high.high, high.low + low.high);
        quick_two_sum(sum.high, sum.low + low.low)
    }
}

impl Neg for DoubleDouble {
    type Output = Self;
    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl Sub for DoubleDouble {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl AddAssign for DoubleDouble {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Mul for DoubleDouble {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let product = two_product(self.high, other.high);
        quick_two_sum(product.high, product.low + (self.high * other.low + self.low * other.high))
    }
}

impl Div for DoubleDouble {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let first = self.high / other.high;
        if !first.is_finite() {
            return first.into();
        }
        let rest = self - other * first.into();
        let second = rest.high / other.high;
        let rest = rest - other * second.into();
        quick_two_sum(first, second) + (rest.high / other.high).into()
    }
}

impl DoubleDouble {
    /// 0
    pub const ZERO: Self = Self { high: 0.0, low: 0.0 };
    /// 1
    pub const ONE: Self = Self { high: 1.0, low: 0.0 };
    /// π
    pub const PI: Self = Self { high: core::f64::consts::PI, low: 1.224_646_799_147_353_2e-16 };

    /// Rounds to `f64`.
    pub fn to_f64(self) -> f64 {
        self.high
    }

    /// Magnitude.
    pub fn abs(self) -> Self {
        if self < Self::ZERO { -self } else { self }
    }

    /// Square root; 0 of what is below 0.
    pub fn sqrt(self) -> Self {
        if self.high <= 0.0 {
            return Self::ZERO;
        }
        // Newton's method from the root in f64, twice: the first step is good to 31 digits but for its own rounding.
        let start: Self = self.high.sqrt().into();
        let half: Self = (0.5).into();
        let first = start + (self - start * start) * half / start;
        first + (self - first * first) * half / first
    }
}

/// A vector of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vec3(pub [DoubleDouble; 3]);

impl Vec3 {
    /// From numbers of `f64`.
    pub fn from_f64(v: [f64; 3]) -> Self {
        Self(v.map(DoubleDouble::from))
    }

    fn zip(self, other: Self, f: impl Fn(DoubleDouble, DoubleDouble) -> DoubleDouble) -> Self {
        Self([0, 1, 2].map(|i| f(self.0[i], other.0[i])))
    }

    /// Scalar product.
    pub fn dot(self, other: Self) -> DoubleDouble {
        let [x, y, z] = self.zip(other, |a, b| a * b).0;
        x + y + z
    }

    /// Vector product.
    pub fn cross(self, other: Self) -> Self {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        Self([b * z - c * y, c * x - a * z, a * y - b * x])
    }

    /// Euclidean length.
    pub fn length(self) -> DoubleDouble {
        self.dot(self).sqrt()
    }
}

impl Add for Vec3 {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}

impl Sub for Vec3 {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}

impl Mul<DoubleDouble> for Vec3 {
    type Output = Self;
    fn mul(self, factor: DoubleDouble) -> Self {
        Self(self.0.map(|a| a * factor))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    type D = DoubleDouble;

    fn near(a: D, b: D, tolerance: f64) {
        let difference = (a - b).to_f64().abs();
        assert!(difference <= tolerance * b.to_f64().abs().max(1e-300), "{a}, not {b}: {difference:e}");
    }

    #[test]
    fn arithmetic_keeps_thirty_digits() {
        let third = D::ONE / 3.0.into();
        near(third + third + third, D::ONE, 1e-31);
        let root = D::from(2.0).sqrt();
        near(root * root, 2.0.into(), 1e-31);
        // What f64 loses altogether.
        let small = D::from(1.0) + D::from(1e-25);
        near(small - D::ONE, 1e-25.into(), 1e-6);
        assert!(small > D::ONE);
    }

    #[test]
    fn nothing_finite_becomes_nan() {
        for a in [0.0, 1.0, -1.0, 1e300, -1e-300] {
            for b in [1.0, -1e300, 1e-300] {
                let (a, b) = (D::from(a), D::from(b));
                for value in [a + b, a - b, a * b, a / b, a.sqrt()] {
                    assert!(!value.to_f64().is_nan(), "{a} {b}: {value}");
                }
            }
        }
    }
}
