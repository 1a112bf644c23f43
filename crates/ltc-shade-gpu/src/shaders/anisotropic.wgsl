// The anisotropic table: folds, coordinates, decoding. No bindings. Needs: math, table.
//
// Texture: 3D, x = lambda nodes, y = alpha nodes, z = phi node + phis * (theta node + thetas * group of four channels).

struct LtcAnisotropicPlace {
    theta: LtcPlace,
    phi: LtcPlace,
    alpha: LtcPlace,
    lambda: LtcPlace,
    // -1 where x, y were mirrored.
    mirror: vec2f,
    // Whether x and y changed places.
    swap: bool,
}

// Folds by the symmetries of a BRDF that mirrors in x and y into phi in [0, pi / 2], alpha_x >= alpha_y (KT et al. 2022,
// eq. 13 and 15). `wo` is a unit vector in the shading frame.
fn ltc_anisotropic_place(axes: LtcAxes, wo: vec3f, alpha_x: f32, alpha_y: f32) -> LtcAnisotropicPlace {
    let mirror = select(vec2f(1.0), vec2f(-1.0), wo.xy < vec2f(0.0));
    let swap = alpha_x < alpha_y;
    let folded = select(abs(wo.xy), abs(wo.yx), swap);
    let alpha = max(alpha_x, alpha_y);
    return LtcAnisotropicPlace(
        ltc_place_of_theta(axes.theta, wo),
        ltc_place_of_value(axes.phi, ltc_atan2(folded.y, folded.x)),
        ltc_place_of_value(axes.alpha, alpha),
        ltc_place_of_value(axes.lambda, min(alpha_x, alpha_y) / max(alpha, LTC_TINY)),
        mirror,
        swap,
    );
}

// Back from the folded quadrant: S M S^T for the signed permutation S, which keeps det M > 0.
fn ltc_anisotropic_decode(texels: LtcTexels, place: LtcAnisotropicPlace) -> LtcLookup {
    let m = ltc_matrix(texels);
    let exchanged = mat3x3f(m[1].yxz, m[0].yxz, m[2].yxz);
    let s = vec3f(place.mirror, 1.0);
    let unfolded = mat3x3f(
        select(m[0], exchanged[0], place.swap) * s * s.x,
        select(m[1], exchanged[1], place.swap) * s * s.y,
        select(m[2], exchanged[2], place.swap) * s,
    );
    return LtcLookup(unfolded, texels.g2.y, texels.g2.z);
}

fn ltc_anisotropic_nearest(place: LtcAnisotropicPlace) -> LtcAnisotropicPlace {
    return LtcAnisotropicPlace(
        ltc_nearest(place.theta),
        ltc_nearest(place.phi),
        ltc_nearest(place.alpha),
        ltc_nearest(place.lambda),
        place.mirror,
        place.swap,
    );
}
