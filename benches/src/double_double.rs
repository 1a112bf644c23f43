//! Numbers of twice the digits of `f64`: the oracle for rounding errors.
//!
//! A number is the unevaluated sum of two `f64` that do not overlap: about 31 decimal digits. The algorithms are the
//! textbook ones (Dekker 1971, Knuth 1969: error-free sums and products; here with fused multiply-add). Elementary
//! functions are series of our own, since those of the platform have 16 digits.

use std::fmt;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

use ltc_core::{Matrix, Real, Vector};

/// A number of about 31 decimal digits.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd, Default)]
pub struct DoubleDouble {
    high: f64,
    low: f64,
}

const PI: DoubleDouble = DoubleDouble { high: core::f64::consts::PI, low: 1.224_646_799_147_353_2e-16 };
const HALF_PI: DoubleDouble =
    DoubleDouble { high: core::f64::consts::FRAC_PI_2, low: 6.123_233_995_736_766e-17 };
const LN_2: DoubleDouble = DoubleDouble { high: core::f64::consts::LN_2, low: 2.319_046_813_846_299_6e-17 };

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
    /// `sin x` and `cos x` for |x| ≤ π/4 by their series, after halving the argument three times.
    fn small_sin_cos(self) -> (Self, Self) {
        let x = self * (0.125).into();
        let square = x * x;
        // versine 1 − cos keeps its digits through the doublings.
        let (mut sine, mut versine) = (Self::ZERO, Self::ZERO);
        let mut term = x;
        for k in 1..=12 {
            sine += term;
            let even = f64::from(2 * k);
            let cosine_term = term * x / even.into();
            versine += cosine_term;
            term = -(term * square) / (even * (even + 1.0)).into();
        }
        let (mut s, mut v) = (sine, versine);
        for _ in 0..3 {
            // sin 2x = 2 sin x cos x, 1 − cos 2x = 2 sin² x
            let two: Self = (2.0).into();
            (s, v) = (two * s * (Self::ONE - v), two * s * s);
        }
        (s, Self::ONE - v)
    }

    /// `eˣ` for moderate x: series of x/2⁹, squared nine times.
    fn exp(self) -> Self {
        let x = self * (1.0 / 512.0).into();
        let (mut sum, mut term) = (Self::ZERO, Self::ONE);
        for k in 1..=12 {
            term = term * x / f64::from(k).into();
            sum += term;
        }
        // expm1 of the double argument: e(e + 2)
        for _ in 0..9 {
            sum = sum * (sum + (2.0).into());
        }
        sum + Self::ONE
    }

    /// Natural logarithm: of the mantissa by one step of Newton's method from that of `f64`, and of the power of two.
    pub fn ln(self) -> Self {
        if !(self.high > 0.0 && self.high.is_finite()) {
            return self.high.ln().into();
        }
        let exponent = self.high.log2().floor().clamp(-1000.0, 1000.0);
        let mantissa = self * (-exponent).exp2().into();
        let start: Self = mantissa.high.ln().into();
        let correction = mantissa * (-start).exp() - Self::ONE;
        start + correction - correction * correction * (0.5).into() + LN_2 * exponent.into()
    }
}

impl Real for DoubleDouble {
    type Vec3 = Vec3;
    type Mat3 = Mat3;
    const ZERO: Self = Self { high: 0.0, low: 0.0 };
    const ONE: Self = Self { high: 1.0, low: 0.0 };
    const PI: Self = PI;
    const EPSILON: Self = Self { high: 4.9e-32, low: 0.0 };
    const TINY: Self = Self { high: f64::MIN_POSITIVE, low: 0.0 };

    fn of(value: f64) -> Self {
        value.into()
    }
    fn to_f64(self) -> f64 {
        self.high
    }
    fn is_finite(self) -> bool {
        self.high.is_finite()
    }
    fn abs(self) -> Self {
        if self.high < 0.0 || (self.high == 0.0 && self.low < 0.0) { -self } else { self }
    }
    fn sqrt(self) -> Self {
        if self.high <= 0.0 || !self.high.is_finite() {
            return self.high.sqrt().into();
        }
        let start: Self = self.high.sqrt().into();
        let half: Self = (0.5).into();
        let first = start + (self - start * start) * half / start;
        first + (self - first * first) * half / first
    }
    fn sin_cos(self) -> (Self, Self) {
        let turns = (self.high / HALF_PI.high).round();
        let rest = self - HALF_PI * turns.into();
        let (s, c) = rest.small_sin_cos();
        match turns.rem_euclid(4.0) as u8 {
            0 => (s, c),
            1 => (c, -s),
            2 => (-s, -c),
            _ => (-c, s),
        }
    }
    /// By one step of Newton's method from that of `f64`: `θ = θ₀ + (y cos θ₀ − x sin θ₀)/r`.
    fn atan2(self, x: Self) -> Self {
        let start = self.high.atan2(x.high);
        let largest = self.high.abs().max(x.high.abs());
        if largest == 0.0 || !largest.is_finite() {
            return start.into();
        }
        let (y, x) = (self / largest.into(), x / largest.into());
        let (s, c) = Self::from(start).sin_cos();
        let radius = (x * x + y * y).sqrt();
        Self::from(start) + (y * c - x * s) / radius
    }
    fn max(self, other: Self) -> Self {
        if self.high.is_nan() || other > self { other } else { self }
    }
    fn min(self, other: Self) -> Self {
        if self.high.is_nan() || other < self { other } else { self }
    }
}

/// A vector of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vec3([DoubleDouble; 3]);

impl Vec3 {
    fn zip(self, other: Self, f: impl Fn(DoubleDouble, DoubleDouble) -> DoubleDouble) -> Self {
        Self([0, 1, 2].map(|i| f(self.0[i], other.0[i])))
    }
}

impl Add for Vec3 {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}
impl AddAssign for Vec3 {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}
impl Sub for Vec3 {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}
impl Neg for Vec3 {
    type Output = Self;
    fn neg(self) -> Self {
        Self(self.0.map(|a| -a))
    }
}
impl Mul<DoubleDouble> for Vec3 {
    type Output = Self;
    fn mul(self, factor: DoubleDouble) -> Self {
        Self(self.0.map(|a| a * factor))
    }
}

impl Vector<DoubleDouble> for Vec3 {
    fn new(x: DoubleDouble, y: DoubleDouble, z: DoubleDouble) -> Self {
        Self([x, y, z])
    }
    fn x(self) -> DoubleDouble {
        self.0[0]
    }
    fn y(self) -> DoubleDouble {
        self.0[1]
    }
    fn z(self) -> DoubleDouble {
        self.0[2]
    }
    fn dot(self, other: Self) -> DoubleDouble {
        let [x, y, z] = self.zip(other, |a, b| a * b).0;
        x + y + z
    }
    fn cross(self, other: Self) -> Self {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        Self([b * z - c * y, c * x - a * z, a * y - b * x])
    }
    fn is_finite(self) -> bool {
        self.0.iter().all(|a| a.is_finite())
    }
    fn length(self) -> DoubleDouble {
        self.dot(self).sqrt()
    }
    fn max_abs(self) -> DoubleDouble {
        let [x, y, z] = self.0.map(Real::abs);
        x.max(y).max(z)
    }
    fn try_unit(self) -> Option<Self> {
        let scale = self.max_abs();
        if !(scale > DoubleDouble::ZERO && scale.is_finite()) {
            return None;
        }
        let scaled = self * (DoubleDouble::ONE / scale);
        Some(scaled * (DoubleDouble::ONE / scaled.length()))
    }
}

/// A matrix of them, by columns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mat3([Vec3; 3]);

impl Matrix<DoubleDouble, Vec3> for Mat3 {
    fn from_columns(x: Vec3, y: Vec3, z: Vec3) -> Self {
        Self([x, y, z])
    }
    fn columns(self) -> [Vec3; 3] {
        self.0
    }
    fn apply(self, v: Vec3) -> Vec3 {
        let [x, y, z] = self.0;
        x * v.x() + y * v.y() + z * v.z()
    }
    fn product(self, other: Self) -> Self {
        Self(other.0.map(|column| self.apply(column)))
    }
    fn transposed(self) -> Self {
        let [a, b, c] = self.0;
        Self([Vec3([a.x(), b.x(), c.x()]), Vec3([a.y(), b.y(), c.y()]), Vec3([a.z(), b.z(), c.z()])])
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
    fn sines_are_those_of_known_angles_and_of_their_sums() {
        let (s, c) = (PI / 6.0.into()).sin_cos();
        near(s, 0.5.into(), 1e-30);
        near(c * c, 0.75.into(), 1e-30);
        for k in -20..20 {
            let x: D = (0.37 * f64::from(k)).into();
            let (s, c) = x.sin_cos();
            near(s * s + c * c, D::ONE, 1e-30);
            let (s1, c1) = (x + D::ONE).sin_cos();
            let (so, co) = D::ONE.sin_cos();
            assert!((s1 - (s * co + c * so)).to_f64().abs() < 1e-30);
            assert!((c1 - (c * co - s * so)).to_f64().abs() < 1e-30);
        }
    }

    #[test]
    fn arc_tangent_undoes_the_tangent_in_every_quadrant() {
        for k in -31..=31 {
            let angle: D = (0.1 * f64::from(k)).into();
            let (s, c) = angle.sin_cos();
            for scale in [1e-100, 1.0, 1e100] {
                let scale: D = scale.into();
                assert!(((s * scale).atan2(c * scale) - angle).to_f64().abs() < 1e-30, "{k}");
            }
        }
        near(D::ONE.atan2(D::ZERO), HALF_PI, 1e-31);
        near(D::ZERO.atan2(-D::ONE), PI, 1e-31);
        assert_eq!(D::ZERO.atan2(D::ZERO), D::ZERO);
    }

    #[test]
    fn logarithms_add() {
        near(D::from(2.0).ln() + D::from(5.0).ln(), D::from(10.0).ln(), 1e-30);
        near(D::from(2.0).ln(), D { high: core::f64::consts::LN_2, low: 2.319_046_813_846_3e-17 }, 1e-29);
        near((D::ONE / 1e30.into()).ln(), -(D::from(1e30).ln()), 1e-30);
        near(D::from(1e-30).ln(), -(D::from(1e30).ln()), 1e-17);
        assert_eq!(D::ZERO.ln().to_f64(), f64::NEG_INFINITY);
    }

    #[test]
    fn nothing_finite_becomes_nan() {
        for a in [0.0, 1.0, -1.0, 1e300, -1e-300] {
            for b in [1.0, -1e300, 1e-300] {
                let (a, b) = (D::from(a), D::from(b));
                for value in [a + b, a - b, a * b, a / b, a.atan2(b), a.max(b), a.abs().sqrt()] {
                    assert!(!value.to_f64().is_nan(), "{a} {b}: {value}");
                }
            }
        }
    }
}
