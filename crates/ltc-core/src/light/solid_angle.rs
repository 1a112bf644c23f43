//! Solid angles of triangles.

use glam::DVec3;

/// Half the signed solid angle of a triangle of unit vectors, `atan2(det(a, b, c), 1 + a·b + b·c + c·a)`
/// (Van Oosterom and Strackee 1983), in (−π, π].
///
/// Small triangles and nearly antipodal vertices keep their digits: both arguments are written in the differences of close
/// and in the sum of opposite vertices, which are exact.
pub(crate) fn half_triangle(a: DVec3, b: DVec3, c: DVec3) -> f64 {
    let [p, q, r] = farthest_first(a, b, c);
    let determinant =
        if p.dot(q) > 0.0 { r.dot((p - r).cross(q - r)) } else { r.dot(p.cross(sum_of_units(p, q))) };
    determinant.atan2(one_and_cosines(a, b, c))
}

/// `1 + a·b + b·c + c·a` of unit vectors: what the tangent of half the solid angle divides by.
pub(crate) fn one_and_cosines(a: DVec3, b: DVec3, c: DVec3) -> f64 {
    let [p, q, r] = farthest_first(a, b, c);
    if p.dot(q) > 0.0 {
        1.0 + p.dot(q) + q.dot(r) + r.dot(p)
    } else {
        let sum = sum_of_units(p, q);
        0.5 * sum.length_squared() + r.dot(sum)
    }
}

/// `a + b` of unit vectors, without what their rounded lengths add: orthogonal to `a − b`.
pub(crate) fn sum_of_units(a: DVec3, b: DVec3) -> DVec3 {
    let (sum, difference) = (a + b, a - b);
    let squared = difference.length_squared();
    if squared > 0.0 { sum - difference * (sum.dot(difference) / squared) } else { sum }
}

/// The same cycle, begun with the two vertices that are farthest apart.
fn farthest_first(a: DVec3, b: DVec3, c: DVec3) -> [DVec3; 3] {
    let (ab, bc, ca) = (a.dot(b), b.dot(c), c.dot(a));
    if ab <= bc && ab <= ca {
        [a, b, c]
    } else if bc <= ca {
        [b, c, a]
    } else {
        [c, a, b]
    }
}
