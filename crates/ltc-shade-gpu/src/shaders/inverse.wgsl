// The inverse of M up to its scale, by cofactors: nothing is divided, so nothing can overflow. No bindings.

struct LtcInverse {
    // Rows of det(M) * M^-1. Integrals need directions only, for which the factor does not matter while it is positive.
    rows: mat3x3f,
    // False unless det M > 0: such a matrix is no lobe.
    valid: bool,
}

// `m` is target_from_cosine.
fn ltc_inverse(m: mat3x3f) -> LtcInverse {
    let first = cross(m[1], m[2]);
    let determinant = dot(m[0], first);
    return LtcInverse(mat3x3f(first, cross(m[2], m[0]), cross(m[0], m[1])), determinant > 0.0);
}

// Identity: the clamped cosine itself, Lambert's lobe.
fn ltc_cosine() -> LtcInverse {
    return LtcInverse(mat3x3f(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0), true);
}

// A direction of the lobe's space in cosine space, up to its length.
fn ltc_cosine_from_target(inverse: LtcInverse, v: vec3f) -> vec3f {
    return v * inverse.rows;
}
