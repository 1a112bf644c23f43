//! One quad, its four edges side by side.

use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch, f64x4};

use super::angle::{Arctangent, Double};
use super::convex::{CosineSum, Edge, Limits, Lobe, SurfaceGap, View};
use super::lane::{Lane as _, Triple, cross, minus};
use super::simd::Wide;

/// Nothing is lost in `f64` this far from the degenerate.
const LIMITS: Limits = Limits { plane: 1e-14, width: 1e-26, range: [1e-10, 1e10], nearest: 0.0, sine: 1e-4 };

/// A number of each edge.
type Four<S> = Wide<S, f64x4<S>>;

/// The fraction of the lobe of `M⁻¹` with these `columns` that sees the quad, whichever side is seen, and whether its front
/// is; `None` for a hard one.
pub(super) fn integrate(
    vertices: &[Triple<f64>; 4],
    columns: &[Triple<f64>; 3],
    surface: bool,
) -> Option<(f64, bool)> {
    // Shorter angles for `f32` would save 4 %, and double what there is to compile.
    dispatch!(Level::new(), simd => edges_at_once::<_, Double>(simd, vertices, columns, surface))
}

#[inline(always)]
fn edges_at_once<S: Simd, K: Arctangent>(
    simd: S,
    vertices: &[Triple<f64>; 4],
    columns: &[Triple<f64>; 3],
    surface: bool,
) -> Option<(f64, bool)> {
    let View { facing, hard } = View::new(vertices, &LIMITS);
    let lobe = Lobe::new(*columns);
    let edge = ring(simd, vertices, columns);
    let zero = Four::of(f64x4::splat(simd, 0.0));
    let below_surface = surface && edge.p[2].less(zero).any_true();
    let fraction = match (below_surface, edge.a[2].less(zero).any_true()) {
        (false, false) => around::<S, K, false, false>(zero, &edge, facing, &lobe),
        (false, true) => around::<S, K, false, true>(zero, &edge, facing, &lobe),
        (true, _) => around::<S, K, true, true>(zero, &edge, facing, &lobe),
    };
    (!hard && !edge.flat(&LIMITS).any_true()).then_some((fraction, facing > 0.0))
}

/// The fraction, from the edges. `SURFACE`, `CUT`: something may be below the one horizon or the other.
#[inline(always)]
fn around<S: Simd, K: Arctangent, const SURFACE: bool, const CUT: bool>(
    zero: Four<S>,
    edge: &Edge<Four<S>>,
    facing: f64,
    lobe: &Lobe<f64>,
) -> f64 {
    let mut sums = CosineSum::new(zero);
    if !SURFACE {
        sums.arc::<K, CUT>(edge.a, edge.b, edge.normal);
        return reduce(&sums).fraction::<K, CUT>(facing);
    }
    let mut gaps = SurfaceGap::new(zero);
    gaps.edge::<K, CUT>(edge, &mut sums);
    let gap = SurfaceGap {
        exit: [sum(gaps.exit[0]), sum(gaps.exit[1]), sum(gaps.exit[2])],
        entry: [sum(gaps.entry[0]), sum(gaps.entry[1]), sum(gaps.entry[2])],
        exit_plan: [sum(gaps.exit_plan[0]), sum(gaps.exit_plan[1])],
        entry_plan: [sum(gaps.entry_plan[0]), sum(gaps.entry_plan[1])],
    };
    let mut total = reduce(&sums);
    gap.close::<K, CUT>(lobe, &mut total);
    total.fraction::<K, CUT>(facing)
}

/// The edges, from each vertex to the next.
#[inline(always)]
fn ring<S: Simd>(simd: S, vertices: &[Triple<f64>; 4], columns: &[Triple<f64>; 3]) -> Edge<Four<S>> {
    let [x, y, z] = columns;
    let lobe = Lobe::new([all(simd, x), all(simd, y), all(simd, z)]);
    let p = [component(simd, vertices, 0), component(simd, vertices, 1), component(simd, vertices, 2)];
    let q = next(p);
    let a = lobe.apply(p);
    let step = lobe.apply(minus(q, p));
    Edge { p, q, a, b: next(a), normal: cross(a, step) }
}

#[inline(always)]
fn all<S: Simd>(simd: S, v: &Triple<f64>) -> Triple<Four<S>> {
    [
        Wide::of(f64x4::splat(simd, v[0])),
        Wide::of(f64x4::splat(simd, v[1])),
        Wide::of(f64x4::splat(simd, v[2])),
    ]
}

#[inline(always)]
fn component<S: Simd>(simd: S, v: &[Triple<f64>; 4], i: usize) -> Four<S> {
    Wide::of(f64x4::simd_from(simd, [v[0][i], v[1][i], v[2][i], v[3][i]]))
}

/// The vertex after each.
#[inline(always)]
fn next<S: Simd>(v: Triple<Four<S>>) -> Triple<Four<S>> {
    [
        Wide::of(v[0].0.rotate_elements_left::<1>()),
        Wide::of(v[1].0.rotate_elements_left::<1>()),
        Wide::of(v[2].0.rotate_elements_left::<1>()),
    ]
}

#[inline(always)]
fn sum<S: Simd>(x: Four<S>) -> f64 {
    x.0.reduce_sum()
}

#[inline(always)]
fn reduce<S: Simd>(sums: &CosineSum<Four<S>>) -> CosineSum<f64> {
    CosineSum {
        sum: sum(sums.sum),
        exit: [sum(sums.exit[0]), sum(sums.exit[1])],
        entry: [sum(sums.entry[0]), sum(sums.entry[1])],
    }
}
