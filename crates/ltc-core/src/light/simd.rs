//! Vectors of numbers as [`Lane`]s.

use core::marker::PhantomData;
use core::ops::{Add, Div, Mul, Neg, Sub};

use fearless_simd::prelude::*;

use super::lane::Lane;

/// An element of a vector.
pub(super) trait Element: SimdFloatElement {
    /// The constant `value`.
    fn constant(value: f64) -> Self;
    /// What a divisor is raised to.
    const TINY: f64;
    /// Whether a reciprocal is estimated (to 8 bits or more) and refined rather than divided for: twice as fast.
    const ESTIMATE: bool;
}

impl Element for f32 {
    #[inline(always)]
    fn constant(value: f64) -> Self {
        value as f32
    }
    const TINY: f64 = 1e-37;
    const ESTIMATE: bool = true;
}

impl Element for f64 {
    #[inline(always)]
    fn constant(value: f64) -> Self {
        value
    }
    const TINY: f64 = 1e-300;
    const ESTIMATE: bool = false;
}

/// A vector at one level of instructions.
pub(super) struct Wide<S, V>(pub V, PhantomData<S>);

impl<S: Simd, V: SimdFloat<S>> Wide<S, V> {
    #[inline(always)]
    pub fn of(vector: V) -> Self {
        Self(vector, PhantomData)
    }
}

impl<S, V: Copy> Clone for Wide<S, V> {
    #[inline(always)]
    fn clone(&self) -> Self {
        *self
    }
}

impl<S, V: Copy> Copy for Wide<S, V> {}

macro_rules! forward {
    ($($trait:ident $method:ident),*) => {$(
        impl<S: Simd, V: SimdFloat<S>> $trait for Wide<S, V> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self::of($trait::$method(self.0, other.0))
            }
        }
    )*};
}

forward!(Add add, Sub sub, Mul mul, Div div);

impl<S: Simd, V: SimdFloat<S>> Neg for Wide<S, V> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::of(-self.0)
    }
}

impl<S: Simd, V: SimdFloat<S>> Lane for Wide<S, V>
where
    V::Element: Element,
{
    type Mask = V::Mask;
    const TINY: f64 = <V::Element as Element>::TINY;

    #[inline(always)]
    fn lit(self, value: f64) -> Self {
        Self::of(V::splat(self.0.token(), V::Element::constant(value)))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self::of(self.0.abs())
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self::of(self.0.sqrt())
    }
    #[inline(always)]
    fn reciprocal(self) -> Self {
        let one = self.lit(1.0);
        if !V::Element::ESTIMATE {
            return one / self;
        }
        // Newton's steps double the digits: 8, 16, all.
        let mut estimate = Self::of(self.0.approximate_recip());
        estimate = (-(self * estimate)).mul_add(estimate, estimate + estimate);
        let rest = (-self).mul_add(estimate, one);
        estimate.mul_add(rest, estimate)
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::of(self.0.max(other.0))
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::of(self.0.min(other.0))
    }
    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        Self::of(self.0.mul_add(b.0, c.0))
    }
    #[inline(always)]
    fn less(self, other: Self) -> V::Mask {
        self.0.simd_lt(other.0)
    }
    #[inline(always)]
    fn select(mask: V::Mask, yes: Self, no: Self) -> Self {
        Self::of(mask.select(yes.0, no.0))
    }
    #[inline(always)]
    fn and(a: V::Mask, b: V::Mask) -> V::Mask {
        a & b
    }
    #[inline(always)]
    fn or(a: V::Mask, b: V::Mask) -> V::Mask {
        a | b
    }
    #[inline(always)]
    fn and_not(a: V::Mask, b: V::Mask) -> V::Mask {
        a & !b
    }
    #[inline(always)]
    fn any(mask: V::Mask) -> bool {
        mask.any_true()
    }
}
