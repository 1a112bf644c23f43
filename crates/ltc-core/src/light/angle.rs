//! Angles from their sine and cosine, without the cost of a library's `atan2`.

use super::lane::Lane;
use crate::Real;

/// A way to compute arc tangents on [0, 1].
pub(super) trait Arctangent {
    /// `atan t` for t ∈ [0, 1].
    fn unit<L: Lane>(t: L) -> L;
}

/// To 7.3e-18, relative: rounding alone is left.
pub(super) struct Double;
/// To 2.4e-9, relative: what becomes an `f32` afterwards.
pub(super) struct Single;
/// To 1e-7, relative: what is `f32` already.
pub(super) struct Lanes;

/// `c[0] + c[1] x + …` by Horner's rule, coefficients ascending.
#[inline(always)]
fn horner<L: Lane, const N: usize>(x: L, c: [f64; N]) -> L {
    let mut sum = x.lit(c[N - 1]);
    let mut i = N - 1;
    while i > 0 {
        i -= 1;
        sum = sum.mul_add(x, x.lit(c[i]));
    }
    sum
}

/// The same in pairs: fewer steps wait for each other.
#[inline(always)]
fn pairs<L: Lane, const N: usize>(x: L, c: [f64; N]) -> L {
    let square = x * x;
    let mut i = N - 2;
    let mut sum = x.mul_add(x.lit(c[i + 1]), x.lit(c[i]));
    while i >= 2 {
        i -= 2;
        sum = sum.mul_add(square, x.mul_add(x.lit(c[i + 1]), x.lit(c[i])));
    }
    sum
}

// Minimax in the relative error of atan(t)/t as a function of t² ∈ [0, 1], by Remez exchange.

impl Arctangent for Double {
    #[inline(always)]
    fn unit<L: Lane>(t: L) -> L {
        let u = t * t;
        let p = [
            1.0,
            2.5087253398369023,
            2.2893291904335964,
            0.9253229035236891,
            0.1603240473965232,
            0.009453754820757615,
            8.181552858602005e-05,
        ];
        let q = [
            1.0,
            2.8420586731702335,
            3.0366820814905084,
            1.5119956722382222,
            0.35188345937176796,
            0.03328562573836684,
            0.0008364932453153471,
        ];
        t * (horner(u, p) / horner(u, q))
    }
}

impl Arctangent for Single {
    #[inline(always)]
    fn unit<L: Lane>(t: L) -> L {
        let c = [
            0.9999999976306287,
            -0.33333283641709077,
            0.1999826604191608,
            -0.14261933109789957,
            0.10942030684028972,
            -0.08377315488988502,
            0.05755210246140215,
            -0.03080459736817246,
            0.01072694410754457,
            -0.001753930149429696,
        ];
        t * pairs(t * t, c)
    }
}

impl Arctangent for Lanes {
    #[inline(always)]
    fn unit<L: Lane>(t: L) -> L {
        let c = [
            0.9999999009903421,
            -0.33331990746535045,
            0.1996972390113102,
            -0.14019480928039776,
            0.09914292872150889,
            -0.05948639367360118,
            0.024252403432439895,
            -0.00469327610080689,
        ];
        t * pairs(t * t, c)
    }
}

/// `atan2(y, x)` in [0, π] from `smaller / larger` of y ≥ 0 and |x|.
#[inline(always)]
pub(super) fn unfold<L: Lane, K: Arctangent>(ratio: L, y: L, x: L) -> L {
    let acute = K::unit(ratio);
    let acute = L::select(x.abs().less(y), x.lit(core::f64::consts::FRAC_PI_2) - acute, acute);
    L::select(x.less(x.lit(0.0)), x.lit(core::f64::consts::PI) - acute, acute)
}

/// `atan2(y, x)` ∈ [0, π] for y ≥ 0; 0 for y = x = 0.
#[inline(always)]
pub(super) fn angle<L: Lane, K: Arctangent>(y: L, x: L) -> L {
    let magnitude = x.abs();
    let ratio = magnitude.min(y) / magnitude.max(y).max(x.lit(L::TINY));
    unfold::<L, K>(ratio, y, x)
}

/// `atan2(sine, cosine)` ∈ [0, π] for a sine ≥ 0, to what an `R` can tell: 2.4e-9 or 5e-16, relative.
#[inline]
pub(super) fn angle_for<R: Real>(sine: f64, cosine: f64) -> f64 {
    if R::EPSILON.to_f64() > 1e-10 {
        angle::<f64, Single>(sine, cosine)
    } else {
        angle::<f64, Double>(sine, cosine)
    }
}

/// `atan2(sine, cosine)` ∈ [−π, π], as precise.
#[inline]
pub(super) fn azimuth_for<R: Real>(sine: f64, cosine: f64) -> f64 {
    angle_for::<R>(sine.abs(), cosine).copysign(sine)
}

/// `atan2(sine, cosine)` ∈ [−π, π].
#[inline]
pub(super) fn azimuth<R: Real>(sine: R, cosine: R) -> R {
    R::of(azimuth_for::<R>(sine.to_f64(), cosine.to_f64()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Largest errors, relative to the angle, over quotients from 0 to ∞ on both sides of π/2.
    fn error<K: Arctangent>() -> f64 {
        let mut largest = 0.0_f64;
        for i in 0..=100_000 {
            let phi = f64::from(i) * 1e-5 * core::f64::consts::PI;
            let (y, x) = (phi.sin().abs(), phi.cos());
            let exact = y.atan2(x);
            largest = largest.max((angle::<f64, K>(y, x) - exact).abs() / exact.max(1e-300));
        }
        largest
    }

    #[test]
    fn kernels_keep_the_errors_they_state() {
        let (double, single, lanes) = (error::<Double>(), error::<Single>(), error::<Lanes>());
        assert!(double < 5e-16, "{double:e}");
        assert!((1e-9..2.5e-9).contains(&single), "{single:e}");
        assert!((5e-8..1.05e-7).contains(&lanes), "{lanes:e}");
    }

    #[test]
    fn ends_are_exact_and_nothing_is_nan() {
        let pi = core::f64::consts::PI;
        for (y, x, expected) in
            [(0.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, -1.0, pi), (1.0, 0.0, pi / 2.0), (1e-200, -1e200, pi)]
        {
            assert_eq!(angle::<f64, Double>(y, x), expected, "{y} {x}");
        }
    }
}
