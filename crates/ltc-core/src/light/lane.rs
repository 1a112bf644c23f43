//! Numbers that a closed form is computed with: one `f64`, or a vector of `f32` that holds as many lights.

use core::ops::{Add, Div, Mul, Neg, Sub};

/// One number per light, and what a branch-free closed form does with it.
pub(super) trait Lane:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// One truth value per light.
    type Mask: Copy;
    /// What a divisor is raised to, so that 0/0 becomes 0.
    const TINY: f64;

    /// `value` in every lane of a number like this one.
    fn lit(self, value: f64) -> Self;
    fn abs(self) -> Self;
    fn sqrt(self) -> Self;
    /// 1 / `self`, to the last digits but one.
    fn reciprocal(self) -> Self;
    fn max(self, other: Self) -> Self;
    fn min(self, other: Self) -> Self;
    /// `self · b + c`, rounded once or twice.
    fn mul_add(self, b: Self, c: Self) -> Self;
    /// `self < other`
    fn less(self, other: Self) -> Self::Mask;
    /// `if mask { yes } else { no }`
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    fn and(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    fn or(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// `a` without `b`.
    fn and_not(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// Whether the mask holds for any light.
    fn any(mask: Self::Mask) -> bool;
}

impl Lane for f64 {
    type Mask = bool;
    const TINY: f64 = 1e-300;

    #[inline(always)]
    fn lit(self, value: f64) -> Self {
        value
    }
    #[inline(always)]
    fn abs(self) -> Self {
        f64::abs(self)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }
    #[inline(always)]
    fn reciprocal(self) -> Self {
        1.0 / self
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if self > other { self } else { other }
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if self < other { self } else { other }
    }
    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        // Not fused: without the instruction, `f64::mul_add` is a slow call.
        self * b + c
    }
    #[inline(always)]
    fn less(self, other: Self) -> bool {
        self < other
    }
    #[inline(always)]
    fn select(mask: bool, yes: Self, no: Self) -> Self {
        if mask { yes } else { no }
    }
    #[inline(always)]
    fn and(a: bool, b: bool) -> bool {
        a & b
    }
    #[inline(always)]
    fn or(a: bool, b: bool) -> bool {
        a | b
    }
    #[inline(always)]
    fn and_not(a: bool, b: bool) -> bool {
        a & !b
    }
    #[inline(always)]
    fn any(mask: bool) -> bool {
        mask
    }
}

// No closures below and in what is built upon it: compiled on their own, without the instructions of the level that is
// dispatched to, they would not be inlined.

/// Three lanes: x, y, z.
pub(super) type Triple<L> = [L; 3];

#[inline(always)]
pub(super) fn plus<L: Lane>(a: Triple<L>, b: Triple<L>) -> Triple<L> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline(always)]
pub(super) fn minus<L: Lane>(a: Triple<L>, b: Triple<L>) -> Triple<L> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
pub(super) fn times<L: Lane>(a: Triple<L>, s: L) -> Triple<L> {
    [a[0] * s, a[1] * s, a[2] * s]
}

#[inline(always)]
pub(super) fn dot<L: Lane>(a: Triple<L>, b: Triple<L>) -> L {
    a[2].mul_add(b[2], a[1].mul_add(b[1], a[0] * b[0]))
}

#[inline(always)]
pub(super) fn cross<L: Lane>(a: Triple<L>, b: Triple<L>) -> Triple<L> {
    [
        a[1].mul_add(b[2], -(a[2] * b[1])),
        a[2].mul_add(b[0], -(a[0] * b[2])),
        a[0].mul_add(b[1], -(a[1] * b[0])),
    ]
}

/// `s·a + t·b`
#[inline(always)]
pub(super) fn blend<L: Lane>(a: Triple<L>, s: L, b: Triple<L>, t: L) -> Triple<L> {
    [a[0].mul_add(s, b[0] * t), a[1].mul_add(s, b[1] * t), a[2].mul_add(s, b[2] * t)]
}

#[inline(always)]
pub(super) fn choose<L: Lane>(mask: L::Mask, yes: Triple<L>, no: Triple<L>) -> Triple<L> {
    [L::select(mask, yes[0], no[0]), L::select(mask, yes[1], no[1]), L::select(mask, yes[2], no[2])]
}

/// Whether z < 0 for any of four and any light.
#[inline(always)]
pub(super) fn any_below<L: Lane>(p: &Triple<L>, q: &Triple<L>, r: &Triple<L>, s: &Triple<L>) -> bool {
    let lowest = p[2].min(q[2]).min(r[2].min(s[2]));
    L::any(lowest.less(lowest.lit(0.0)))
}
