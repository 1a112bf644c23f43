// The symmetries of a BRDF that mirrors in x and y (KT et al. 2022, eq. 13 and 15). No bindings. Needs: math, table.

// How a view direction came into the quadrant that an anisotropic table holds: phi in [0, pi / 2], alpha_x >= alpha_y.
struct LtcFold {
    // -1 where x, y were mirrored.
    mirror: vec2f,
    // Whether x and y changed places.
    swap: bool,
}

// `wo` is a unit vector in the shading frame.
fn ltc_fold(wo: vec3f, alpha_x: f32, alpha_y: f32) -> LtcFold {
    return LtcFold(select(vec2f(1.0), vec2f(-1.0), wo.xy < vec2f(0.0)), alpha_x < alpha_y);
}

fn ltc_folded_azimuth(fold: LtcFold, wo: vec3f) -> f32 {
    let folded = select(abs(wo.xy), abs(wo.yx), fold.swap);
    return ltc_atan2(folded.y, folded.x);
}

// Back from the folded quadrant: S M S^T for the signed permutation S, which keeps det M > 0.
fn ltc_unfold(fold: LtcFold, texels: LtcTexels, channels: vec2f) -> LtcLookup {
    let m = ltc_matrix(texels);
    let exchanged = mat3x3f(m[1].yxz, m[0].yxz, m[2].yxz);
    let s = vec3f(fold.mirror, 1.0);
    let unfolded = mat3x3f(
        select(m[0], exchanged[0], fold.swap) * s * s.x,
        select(m[1], exchanged[1], fold.swap) * s * s.y,
        select(m[2], exchanged[2], fold.swap) * s,
    );
    return LtcLookup(unfolded, channels.x, channels.y);
}
