//! Integration over parts of the unit sphere: spherical triangles, clipping by planes through the origin.

use glam::DVec3;

use crate::cubature::integrate_squares;
use crate::error::ReferenceError;
use crate::quadrature::{Estimate, Tolerance};

/// Edges longer than 60° (cosine below this) are halved, so that the chord triangle stays clear of the origin.
pub(crate) const MAX_EDGE_COSINE: f64 = 0.5;
/// Where kinks are unknown, edges are at most 16° long.
const FINE_EDGE_COSINE: f64 = 0.96;

/// A signed spherical triangle, parametrised by the unit square.
///
/// With unit vertices a, b, c and `p(u, v) = a + u ((b - a) + v (c - b))`, the solid angle element is
/// `|det(a, b, c)| u / |p|³ du dv`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Patch {
    a: DVec3,
    b: DVec3,
    c: DVec3,
    /// `±|det(a, b, c)|`.
    jacobian: f64,
}

impl Patch {
    /// The patch with vertices in any order; `None` when its area vanishes.
    fn new(a: DVec3, b: DVec3, c: DVec3, sign: f64) -> Option<Self> {
        let determinant = a.dot((b - a).cross(c - a));
        (determinant != 0.0).then_some(Self { a, b, c, jacobian: sign * determinant.abs() })
    }

    /// Direction at (u, v), and signed solid angle per du dv.
    fn direction(&self, u: f64, v: f64) -> (DVec3, f64) {
        let p = self.a + u * ((self.b - self.a) + v * (self.c - self.b));
        let length = p.length();
        // A patch whose chord passes through the origin has no area left in f64.
        if length == 0.0 {
            return (self.a, 0.0);
        }
        (p / length, self.jacobian * u / (length * length * length))
    }

    /// The places of the hints in the unit square. Of the many that may fall on a corner one is enough.
    fn seeds(&self, hints: Hints) -> Vec<[f64; 2]> {
        let (hints, around) = match hints {
            Hints::Inside(hints) => (hints, false),
            Hints::Around(hints) => (hints, true),
        };
        let mut seeds: Vec<[f64; 2]> = hints.iter().filter_map(|&w| self.locate(w, around)).collect();
        seeds.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
        seeds.dedup();
        seeds
    }

    /// Where the direction `w` is in the unit square. Directions outside of the triangle have no place, or (`around`)
    /// one on its border if they are on its half of the sphere.
    fn locate(&self, w: DVec3, around: bool) -> Option<[f64; 2]> {
        let orientation = self.a.dot(self.b.cross(self.c)).signum();
        let weight = |p: DVec3, q: DVec3| orientation * w.dot(p.cross(q));
        let weights = [weight(self.b, self.c), weight(self.c, self.a), weight(self.a, self.b)];
        if !around && weights.iter().any(|&w| w < 0.0) {
            return None;
        }
        let [wa, wb, wc] = weights.map(|w| w.max(0.0));
        let towards = w.dot(self.a + self.b + self.c) > 0.0;
        (towards && wa + wb + wc > 0.0).then(|| {
            let u = (wb + wc) / (wa + wb + wc);
            [u, if wb + wc > 0.0 { wc / (wb + wc) } else { 0.5 }]
        })
    }
}

/// Directions where an integrand's mass is.
#[derive(Clone, Copy)]
pub(crate) enum Hints<'a> {
    /// The patches cover the mass: a hint matters to the patch that contains it.
    Inside(&'a [DVec3]),
    /// The mass may lie beside the patches: its tail is then largest on the border next to it.
    Around(&'a [DVec3]),
}

/// `∫ f(w) dw` over signed patches.
pub(crate) fn integrate_patches(
    f: impl Fn(DVec3) -> f64,
    patches: &[Patch],
    hints: Hints,
    tolerance: Tolerance,
) -> Result<Estimate, ReferenceError> {
    let seeds: Vec<Vec<[f64; 2]>> = patches.iter().map(|patch| patch.seeds(hints)).collect();
    let integrand = |piece: usize, u: f64, v: f64| {
        let (w, weight) = patches[piece].direction(u, v);
        f(w) * weight
    };
    integrate_squares(integrand, &seeds, tolerance)
}

/// `∫ f(w) dw` over the whole unit sphere.
///
/// `kinks` are the normals of the planes through the origin along which `f` is not smooth. `hints` are directions where
/// the mass of `f` is; they matter for narrow lobes and cost nothing in accuracy.
///
/// Kinks that are not in the list converge, but one that runs along the border of a box can hide some 1e-6 of a unit
/// mass from the nodes, and more of a narrow lobe.
///
/// # Errors
/// [`ReferenceError::NonFiniteIntegrand`], [`ReferenceError::NotConverged`].
pub fn integrate_sphere(
    f: impl Fn(DVec3) -> f64,
    kinks: &[DVec3],
    hints: &[DVec3],
    tolerance: Tolerance,
) -> Result<Estimate, ReferenceError> {
    let mut patches = Vec::new();
    for i in 0..8 {
        let side = |bit: i32| if i & bit == 0 { 1.0 } else { -1.0 };
        let octant = [DVec3::X * side(1), DVec3::Y * side(2), DVec3::Z * side(4)];
        let sign = octant[0].dot(octant[1].cross(octant[2]));
        Cells { half_spaces: &[], kinks, edge_cosine: FINE_EDGE_COSINE }.push(octant, sign, &mut patches);
    }
    integrate_patches(f, &patches, Hints::Inside(hints), tolerance)
}

/// How a triangle is cut into patches.
pub(crate) struct Cells<'a> {
    /// Inward normals: only what is inside all of them is kept.
    pub half_spaces: &'a [DVec3],
    /// Normals of planes along which the triangle is cut.
    pub kinks: &'a [DVec3],
    /// Longer edges (of a smaller cosine) are halved.
    pub edge_cosine: f64,
}

impl Cells<'_> {
    /// Appends the cells of a triangle (vertices of any length), counted with the sign of `sign · det(a, b, c)`.
    pub fn push(&self, triangle: [DVec3; 3], sign: f64, patches: &mut Vec<Patch>) {
        let [a, b, c] = triangle;
        let determinant = a.dot((b - a).cross(c - a));
        let unit: Option<Vec<DVec3>> = triangle.iter().map(|p| p.try_normalize()).collect();
        let Some(unit) = unit.filter(|_| determinant != 0.0) else { return };
        let mut cells = vec![self.half_spaces.iter().fold(unit, |polygon, &n| clip(&polygon, n))];
        for &n in self.kinks.iter().filter(|n| !self.half_spaces.contains(n)) {
            cells = cells.iter().flat_map(|cell| [clip(cell, n), clip(cell, -n)]).collect();
        }
        let sign = sign * determinant.signum();
        for cell in cells {
            let cell: Vec<DVec3> = cell.into_iter().filter_map(DVec3::try_normalize).collect();
            for j in 2..cell.len() {
                push_patches([cell[0], cell[j - 1], cell[j]], sign, self.edge_cosine, patches);
            }
        }
    }
}

/// Appends a triangle of unit vectors, cut into patches whose edges have at least this cosine.
fn push_patches(triangle: [DVec3; 3], sign: f64, edge_cosine: f64, patches: &mut Vec<Patch>) {
    let mut stack = vec![triangle];
    // The longest edge halves every second step, so a sphere's triangle needs far fewer than this; the bound is for
    // triangles that rounding has made degenerate.
    let mut budget = 256;
    while let Some([a, b, c]) = stack.pop() {
        // Rotate so that bc is the longest edge.
        let (ab, bc, ca) = (a.dot(b), b.dot(c), c.dot(a));
        let [a, b, c] = if bc <= ab && bc <= ca {
            [a, b, c]
        } else if ca <= ab {
            [b, c, a]
        } else {
            [c, a, b]
        };
        let middle = (b + c).try_normalize();
        match middle {
            Some(middle) if b.dot(c) < edge_cosine && budget > 0 => {
                budget -= 1;
                stack.push([a, b, middle]);
                stack.push([a, middle, c]);
            }
            _ => patches.extend(Patch::new(a, b, c, sign)),
        }
    }
}

/// The part of a convex polygon (a cone of directions from the origin) where `inward · w > 0`.
pub(crate) fn clip(polygon: &[DVec3], inward: DVec3) -> Vec<DVec3> {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (i, &p) in polygon.iter().enumerate() {
        let q = polygon[(i + 1) % polygon.len()];
        let (dp, dq) = (inward.dot(p), inward.dot(q));
        if dp > 0.0 {
            kept.push(p);
        }
        if (dp > 0.0) != (dq > 0.0) {
            // dp and dq differ in sign or one of them is zero, so the denominator cannot vanish.
            kept.push((p * dq - q * dp) / (dq - dp));
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec3;
    use std::f64::consts::{FRAC_PI_2, PI};

    fn solid_angle(a: DVec3, b: DVec3, c: DVec3) -> f64 {
        let mut patches = Vec::new();
        push_patches([a, b, c], 1.0, MAX_EDGE_COSINE, &mut patches);
        integrate_patches(|_| 1.0, &patches, Hints::Inside(&[]), Tolerance::absolute(1e-11)).unwrap().value
    }

    #[test]
    fn areas_of_sphere_octant_and_near_hemisphere() {
        let whole = integrate_sphere(|_| 1.0, &[], &[], Tolerance::absolute(1e-10)).unwrap();
        assert!((whole.value - 4.0 * PI).abs() < 1e-10);
        assert!((solid_angle(DVec3::X, DVec3::Y, DVec3::Z) - FRAC_PI_2).abs() < 1e-11);
        // Three vertices just above the equator enclose nearly the upper hemisphere: 2π minus a strip.
        for lift in [1e-2, 1e-5, 1e-8] {
            let vertex = |angle: f64| dvec3(angle.cos(), angle.sin(), lift).normalize_or(DVec3::X);
            let got = solid_angle(vertex(0.0), vertex(2.0 * PI / 3.0), vertex(4.0 * PI / 3.0));
            let cosine = vertex(0.0).dot(vertex(2.0 * PI / 3.0));
            // Girard: the sum of three equal angles minus π, cos A = (c - c²) / s² = c / (1 + c).
            let angle = (cosine / (1.0 + cosine)).acos();
            // The oracle itself loses digits near cos A = -1.
            assert!((got - (3.0 * angle - PI)).abs() < 2e-7, "{lift}: {got}");
        }
    }

    #[test]
    fn clip_keeps_the_inner_side() {
        let square =
            [dvec3(1.0, 1.0, 1.0), dvec3(-1.0, 1.0, 1.0), dvec3(-1.0, -1.0, 1.0), dvec3(1.0, -1.0, 1.0)];
        let right = clip(&square, DVec3::X);
        assert_eq!(right.len(), 4);
        assert!(right.iter().all(|p| p.x >= 0.0));
        assert!(clip(&square, -DVec3::Z).is_empty());
        assert_eq!(clip(&square, DVec3::Z), square);
    }
}
