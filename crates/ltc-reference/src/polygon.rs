//! A lobe integrated over a polygonal light, by cubature on the sphere.

use glam::DVec3;

use crate::error::ReferenceError;
use crate::lobe::Lobe;
use crate::quadrature::{Estimate, Tolerance};
use crate::sphere::{Cells, Hints, MAX_EDGE_COSINE, integrate_patches};

/// Below this fraction of the polygon's extent the origin counts as lying in its plane.
const IN_PLANE: f64 = 1e-14;

/// How a polygon is integrated.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PolygonOptions {
    /// Does the back of the polygon emit, too?
    pub two_sided: bool,
    /// When to stop.
    pub tolerance: Tolerance,
}

/// `∫ density(w) dw` over the directions from the origin that hit a planar polygon.
///
/// Vertices are in the lobe's frame, counter-clockwise seen from the emitting side; three or more. The polygon may be
/// non-convex; where it overlaps itself the overlap counts as often as it is wound around. Not planar: the
/// cone over its fan from vertex 0 is integrated. Seen from behind, a one-sided polygon gives 0, as does a polygon
/// without area or with the origin in its plane (to 1e-14 of its extent).
///
/// Method: the polygon's signed fan of triangles, projected onto the unit sphere, clipped by the lobe's
/// [`Lobe::half_spaces`] and cut along its [`Lobe::kinks`], then adaptive cubature of the density against solid angle. Coordinates are f64, so
/// the vertices' rounding limits the result to about 1e-16 · extent / distance. LTC lobes reach 1e-7 absolute up to
/// a condition number of 1e4 (tested).
///
/// # Errors
/// [`ReferenceError::TooFewVertices`], [`ReferenceError::NonFiniteInput`], [`ReferenceError::NonFiniteIntegrand`],
/// [`ReferenceError::NotConverged`].
pub fn integrate_polygon(
    lobe: &impl Lobe,
    vertices: &[DVec3],
    options: PolygonOptions,
) -> Result<Estimate, ReferenceError> {
    let Some(view) = PolygonView::new(vertices, options.two_sided)? else {
        return Ok(Estimate::default());
    };
    let cells =
        Cells { half_spaces: &lobe.half_spaces(), kinks: &lobe.kinks(), edge_cosine: MAX_EDGE_COSINE };
    let mut patches = Vec::new();
    for i in 1..vertices.len() - 1 {
        let triangle = [view.vertices[0], view.vertices[i], view.vertices[i + 1]];
        cells.push(triangle, view.sign, &mut patches);
    }
    integrate_patches(|w| lobe.density(w), &patches, Hints::Around(&lobe.hints()), options.tolerance)
}

/// A validated polygon that the origin sees.
pub(crate) struct PolygonView {
    /// The vertices, scaled to an extent of 1.
    pub vertices: Vec<DVec3>,
    /// What turns `det(a, b, c)` of the fan's triangles into a positive solid angle.
    pub sign: f64,
}

impl PolygonView {
    /// `None` when nothing is to be seen: degenerate, in plane, or from behind.
    pub fn new(vertices: &[DVec3], two_sided: bool) -> Result<Option<Self>, ReferenceError> {
        if vertices.len() < 3 {
            return Err(ReferenceError::TooFewVertices { count: vertices.len() });
        }
        if !vertices.iter().all(|v| v.is_finite()) {
            return Err(ReferenceError::NonFiniteInput { what: "polygon vertex" });
        }
        let extent = vertices.iter().fold(0.0f64, |m, v| m.max(v.abs().max_element()));
        if extent == 0.0 {
            return Ok(None);
        }
        let vertices: Vec<DVec3> = vertices.iter().map(|&v| v / extent).collect();
        let first = vertices[0];
        let normal: DVec3 = vertices.windows(2).map(|e| (e[0] - first).cross(e[1] - first)).sum();
        let Some(normal) = normal.try_normalize() else { return Ok(None) };
        // Positive: the origin is behind the emitting face.
        let behind = normal.dot(first);
        if behind.abs() <= IN_PLANE || (behind > 0.0 && !two_sided) {
            return Ok(None);
        }
        Ok(Some(Self { vertices, sign: behind.signum() }))
    }
}
