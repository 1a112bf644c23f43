//! A convex quad over an LTC without branches: for one light, its edges side by side, or for many lights side by side.
//!
//! The quad is cut by the surface's horizon in the shading frame and by the horizon of cosine space there, as its edges are
//! summed. Cut once, a convex outline has one gap, which a single arc along the horizon closes; so there are four edges,
//! one arc along the surface's horizon, and one angle along the horizon of cosine space. Cut points are the positive
//! combinations `h = |z_b| a + |z_a| b`, so an edge's cut part has its own cross product up to a factor, and nothing is
//! divided.

use super::angle::{Arctangent, angle, unfold};
use super::lane::{Lane, Triple, any_below, blend, choose, cross, dot, minus, plus, times};

/// What a quad needs of an LTC.
#[derive(Clone, Copy)]
pub(super) struct Lobe<L> {
    /// Columns of `M⁻¹`.
    pub columns: [Triple<L>; 3],
    /// Normal of the surface's horizon in cosine space: the cross product of the first two columns.
    pub horizon: Triple<L>,
}

impl<L: Lane> Lobe<L> {
    #[inline(always)]
    pub fn new(columns: [Triple<L>; 3]) -> Self {
        Self { columns, horizon: cross(columns[0], columns[1]) }
    }

    #[inline(always)]
    pub fn apply(&self, v: Triple<L>) -> Triple<L> {
        let [x, y, z] = self.columns;
        [
            z[0].mul_add(v[2], y[0].mul_add(v[1], x[0] * v[0])),
            z[1].mul_add(v[2], y[1].mul_add(v[1], x[1] * v[0])),
            z[2].mul_add(v[2], y[2].mul_add(v[1], x[2] * v[0])),
        ]
    }
}

/// Where the short way is taken; beyond it the light is *hard* and somebody else's.
#[derive(Clone, Copy)]
pub(super) struct Limits {
    /// Least squared sine between the light's plane and the direction of its farthest vertex.
    pub plane: f64,
    /// Least squared ratio of the light's width to the distance of its farthest vertex.
    pub width: f64,
    /// Least and largest magnitude of the largest coordinate.
    pub range: [f64; 2],
    /// Least magnitude of each vertex's largest coordinate.
    pub nearest: f64,
    /// Least sine of an edge longer than 90°, seen in cosine space.
    pub sine: f64,
}

/// An edge in the shading frame from `p` to `q`; the same in cosine space from `a` to `b`, with `normal = a × b`.
#[derive(Clone, Copy)]
pub(super) struct Edge<L> {
    pub p: Triple<L>,
    pub q: Triple<L>,
    pub a: Triple<L>,
    pub b: Triple<L>,
    pub normal: Triple<L>,
}

impl<L: Lane> Edge<L> {
    /// Whether it is so near π that its plane is lost to rounding.
    #[inline(always)]
    pub fn flat(&self, limits: &Limits) -> L::Mask {
        let cosine = dot(self.a, self.b);
        let least = cosine.abs() * cosine.lit(limits.sine);
        L::and(cosine.less(cosine.lit(0.0)), dot(self.normal, self.normal).less(least * least))
    }
}

/// A running sum over arcs that are cut by the horizon of cosine space.
#[derive(Clone, Copy)]
pub(super) struct CosineSum<L: Lane> {
    pub sum: L,
    /// Where the outline goes below, and where it comes back: x and y.
    pub exit: [L; 2],
    pub entry: [L; 2],
}

impl<L: Lane> CosineSum<L> {
    #[inline(always)]
    pub fn new(zero: L) -> Self {
        Self { sum: zero, exit: [zero; 2], entry: [zero; 2] }
    }

    /// Adds the arc from `a` to `b` whose cross product is `normal`. `CUT`: something may be below.
    #[inline(always)]
    pub fn arc<K: Arctangent, const CUT: bool>(&mut self, a: Triple<L>, b: Triple<L>, normal: Triple<L>) {
        let zero = self.sum.lit(0.0);
        let length = dot(normal, normal).sqrt();
        let (mut cosine, mut sine, mut rise) = (dot(a, b), length, normal[2]);
        if CUT {
            let (a_below, b_below) = (a[2].less(zero), b[2].less(zero));
            let entering = b[2].mul_add(cosine, -(a[2] * dot(b, b)));
            let leaving = a[2].mul_add(cosine, -(b[2] * dot(a, a)));
            cosine = L::select(a_below, entering, L::select(b_below, leaving, cosine));
            let kept = L::select(a_below, b[2].max(zero), L::select(b_below, a[2], zero.lit(1.0)));
            sine = length * kept;
            rise = L::select(L::and(a_below, b_below), zero, rise);
            let (exits, enters) = (L::and_not(b_below, a_below), L::and_not(a_below, b_below));
            for i in 0..2 {
                let point = a[2].mul_add(b[i], -(b[2] * a[i]));
                self.exit[i] = self.exit[i] + L::select(exits, point, zero);
                self.entry[i] = self.entry[i] - L::select(enters, point, zero);
            }
        }
        let magnitude = cosine.abs();
        let (larger, smaller) = (magnitude.max(sine), magnitude.min(sine));
        let inverse = (length * larger).max(zero.lit(L::TINY)).reciprocal();
        let theta = unfold::<L, K>(smaller * length * inverse, sine, cosine);
        self.sum = theta.mul_add(rise * larger * inverse, self.sum);
    }

    /// The fraction, from whichever side the light is seen. `CUT`: as for the arcs.
    #[inline(always)]
    pub fn fraction<K: Arctangent, const CUT: bool>(&self, facing: L) -> L {
        let zero = facing.lit(0.0);
        let mut sum = L::select(zero.less(facing), -self.sum, self.sum);
        if CUT {
            let ([x, y], [u, v]) = (self.exit, self.entry);
            sum = sum + angle::<L, K>((x * v - y * u).abs(), x.mul_add(u, y * v));
        }
        let fraction = sum * zero.lit(0.5 / core::f64::consts::PI);
        fraction.max(zero).min(zero.lit(1.0))
    }
}

/// Where the outline crosses the surface's horizon.
#[derive(Clone, Copy)]
pub(super) struct SurfaceGap<L> {
    /// In cosine space.
    pub exit: Triple<L>,
    pub entry: Triple<L>,
    /// In the shading frame: x and y.
    pub exit_plan: [L; 2],
    pub entry_plan: [L; 2],
}

impl<L: Lane> SurfaceGap<L> {
    #[inline(always)]
    pub fn new(zero: L) -> Self {
        Self { exit: [zero; 3], entry: [zero; 3], exit_plan: [zero; 2], entry_plan: [zero; 2] }
    }

    /// Adds what of the edge is above the surface to `sum`. `CUT`: as for its arcs.
    #[inline(always)]
    pub fn edge<K: Arctangent, const CUT: bool>(&mut self, edge: &Edge<L>, sum: &mut CosineSum<L>) {
        let Edge { p, q, a, b, normal } = *edge;
        let zero = p[2].lit(0.0);
        let none = [zero; 3];
        let (a_below, b_below) = (p[2].less(zero), q[2].less(zero));
        let (exits, enters) = (L::and_not(b_below, a_below), L::and_not(a_below, b_below));
        let (s, t) = (q[2].abs(), p[2].abs());
        let point = blend(a, s, b, t);
        self.exit = plus(self.exit, choose(exits, point, none));
        self.entry = plus(self.entry, choose(enters, point, none));
        for i in 0..2 {
            let plan = p[i].mul_add(s, q[i] * t);
            self.exit_plan[i] = self.exit_plan[i] + L::select(exits, plan, zero);
            self.entry_plan[i] = self.entry_plan[i] + L::select(enters, plan, zero);
        }
        let kept = L::select(a_below, q[2].max(zero), L::select(b_below, p[2], zero.lit(1.0)));
        // An edge that is gone stays as a point.
        let from = choose(enters, point, a);
        let to = choose(exits, point, choose(L::and(a_below, b_below), a, b));
        sum.arc::<K, CUT>(from, to, times(normal, kept));
    }

    /// Adds the arc along the surface's horizon.
    #[inline(always)]
    pub fn close<K: Arctangent, const CUT: bool>(&self, lobe: &Lobe<L>, sum: &mut CosineSum<L>) {
        let (from, to) = (self.exit_plan, self.entry_plan);
        let turn = from[0].mul_add(to[1], -(from[1] * to[0]));
        sum.arc::<K, CUT>(self.exit, self.entry, times(lobe.horizon, turn));
    }
}

/// The fraction of each `lobe` that sees its quad, whichever side is seen, and whether the light is hard.
///
/// Cut by the horizon of cosine space and, with `surface`, by the surface's.
#[inline(always)]
pub(super) fn integrate<L: Lane, K: Arctangent>(
    vertices: &[Triple<L>; 4],
    view: &View<L>,
    lobe: &Lobe<L>,
    surface: bool,
    limits: &Limits,
) -> (L, L::Mask) {
    let edges = edges(vertices, lobe);
    let below_surface = surface && any_below(&vertices[0], &vertices[1], &vertices[2], &vertices[3]);
    // Points cut off by the surface lie between vertices: when these are above, so are those.
    let cut = any_below(&edges[0].a, &edges[1].a, &edges[2].a, &edges[3].a);
    let fraction = match (below_surface, cut) {
        (false, false) => around::<L, K, false, false>(&edges, view, lobe),
        (false, true) => around::<L, K, false, true>(&edges, view, lobe),
        (true, false) => around::<L, K, true, false>(&edges, view, lobe),
        (true, true) => around::<L, K, true, true>(&edges, view, lobe),
    };
    let mut hard = view.hard;
    for edge in &edges {
        hard = L::or(hard, edge.flat(limits));
    }
    (fraction, hard)
}

/// The fraction, from the edges. `SURFACE`, `CUT`: something may be below the one horizon or the other.
#[inline(always)]
fn around<L: Lane, K: Arctangent, const SURFACE: bool, const CUT: bool>(
    edges: &[Edge<L>; 4],
    view: &View<L>,
    lobe: &Lobe<L>,
) -> L {
    let zero = view.facing.lit(0.0);
    let mut sum = CosineSum::new(zero);
    if SURFACE {
        let mut gap = SurfaceGap::new(zero);
        for edge in edges {
            gap.edge::<K, CUT>(edge, &mut sum);
        }
        gap.close::<K, CUT>(lobe, &mut sum);
    } else {
        for e in edges {
            sum.arc::<K, CUT>(e.a, e.b, e.normal);
        }
    }
    sum.fraction::<K, CUT>(view.facing)
}

#[inline(always)]
fn edges<L: Lane>(vertices: &[Triple<L>; 4], lobe: &Lobe<L>) -> [Edge<L>; 4] {
    // Edges go to cosine space as differences, so that those of a small light keep their digits.
    let [p, q, r, s] = *vertices;
    let steps =
        [lobe.apply(minus(q, p)), lobe.apply(minus(r, q)), lobe.apply(minus(s, r)), lobe.apply(minus(p, s))];
    let a = lobe.apply(p);
    let b = plus(a, steps[0]);
    let (c, d) = (plus(b, steps[1]), minus(a, steps[3]));
    [
        Edge { p, q, a, b, normal: cross(a, steps[0]) },
        Edge { p: q, q: r, a: b, b: c, normal: cross(b, steps[1]) },
        Edge { p: r, q: s, a: c, b: d, normal: cross(c, steps[2]) },
        Edge { p: s, q: p, a: d, b: a, normal: cross(d, steps[3]) },
    ]
}

/// How the light's plane is seen.
pub(super) struct View<L: Lane> {
    /// Positive when the front is seen.
    pub facing: L,
    /// Near its plane, not convex, without area, or out of range.
    pub hard: L::Mask,
}

impl<L: Lane> View<L> {
    #[inline(always)]
    pub fn new(vertices: &[Triple<L>; 4], limits: &Limits) -> Self {
        let [p, q, r, s] = *vertices;
        let (u, w, e) = (minus(r, p), minus(s, q), minus(q, p));
        // Newell's vector area; the diagonals cross at the fractions `along_u / squared` and `along_w / squared` of each.
        let area = cross(u, w);
        let squared = dot(area, area);
        let (along_u, along_w) = (dot(cross(e, w), area), dot(cross(e, u), area));
        let zero = squared.lit(0.0);
        let facing = -dot(area, p);
        let reaches = [reach(p), reach(q), reach(r), reach(s)];
        let farthest = reaches[0].max(reaches[1]).max(reaches[2].max(reaches[3]));
        let nearest = reaches[0].min(reaches[1]).min(reaches[2].min(reaches[3]));
        let far = farthest * farthest;
        let oblique = (facing * facing).less(squared * far * zero.lit(limits.plane));
        let narrow = squared.less((dot(u, u) + dot(w, w)) * far * zero.lit(limits.width));
        let range = L::or(farthest.less(zero.lit(limits.range[0])), zero.lit(limits.range[1]).less(farthest));
        let range = L::or(range, nearest.less(zero.lit(limits.nearest)));
        let shape = L::or(
            L::or(along_u.less(zero), squared.less(along_u)),
            L::or(along_w.less(zero), squared.less(along_w)),
        );
        Self { facing, hard: L::or(L::or(shape, range), L::or(oblique, narrow)) }
    }
}

/// The largest magnitude of a coordinate.
#[inline(always)]
pub(super) fn reach<L: Lane>(v: Triple<L>) -> L {
    v[0].abs().max(v[1].abs()).max(v[2].abs())
}
