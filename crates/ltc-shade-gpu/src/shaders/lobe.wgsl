// A lobe as lights need it: M and its inverse up to scale, by cofactors. No bindings. Needs: math, precise.

struct LtcLobe {
    // M, its largest entry 1.
    target_from_cosine: mat3x3f,
    // Rows of determinant * M^-1, the largest entry 1.
    rows: mat3x3f,
    // What the rows are M^-1 times of.
    determinant: f32,
    // (rows a) x (rows b) = area_scale * transpose(M) * (a x b)
    area_scale: f32,
    // False unless det M > 0: such a matrix is no lobe, and sees nothing.
    valid: bool,
}

fn ltc_largest_entry(m: mat3x3f) -> f32 {
    return max(ltc_largest_component(m[0]), max(ltc_largest_component(m[1]), ltc_largest_component(m[2])));
}

// `target_from_cosine` may have any scale. Once for all lights of a point.
fn ltc_lobe(target_from_cosine: mat3x3f) -> LtcLobe {
    let m = target_from_cosine * (1.0 / max(ltc_largest_entry(target_from_cosine), LTC_TINY));
    let cofactors = mat3x3f(ltc_cross(m[1], m[2]), ltc_cross(m[2], m[0]), ltc_cross(m[0], m[1]));
    let determinant = dot(m[0], cofactors[0]);
    let scale = 1.0 / max(ltc_largest_entry(cofactors), LTC_TINY);
    let scaled = determinant * scale;
    return LtcLobe(m, cofactors * scale, scaled, scaled * scale, scaled > 0.0);
}

// The clamped cosine itself, Lambert's lobe.
fn ltc_cosine() -> LtcLobe {
    let identity = mat3x3f(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0);
    return LtcLobe(identity, identity, 1.0, 1.0, true);
}

// A direction of the lobe's space in cosine space, up to its length.
fn ltc_cosine_from_target(lobe: LtcLobe, v: vec3f) -> vec3f {
    return v * lobe.rows;
}

// The normal of a plane through the origin in cosine space, up to its length.
fn ltc_cosine_normal(lobe: LtcLobe, normal: vec3f) -> vec3f {
    return normal * lobe.target_from_cosine;
}

// The fraction of the lobe above the horizons: of a light in every direction. In cosine space the surface's horizon is a
// plane whose normal has the angle gamma to z; between both the cosine integrates to (1 + cos gamma) / 2.
fn ltc_everywhere(lobe: LtcLobe) -> f32 {
    if !lobe.valid {
        return 0.0;
    }
//#if surface_horizon
    let tilt = ltc_unit_or_zero(ltc_cosine_normal(lobe, vec3f(0.0, 0.0, 1.0))).z;
//#if cosine_horizon
    return clamp(0.5 + 0.5 * tilt, 0.0, 1.0);
//#else
    return clamp(tilt, 0.0, 1.0);
//#endif
//#else
    return 1.0;
//#endif
}
