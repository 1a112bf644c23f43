// The anisotropic table interpolated by hand, in full f32: on every device. No bindings: the texture is a parameter.
// Needs: anisotropic, fetch_exact_entry.

fn ltc_fetch_anisotropic(
    texture: texture_3d<f32>,
    axes: LtcAxes,
    place: LtcAnisotropicPlace,
) -> LtcTexels {
    let phis = u32(axes.phi.last) + 1u;
    let group = vec3u(0u, 0u, phis * (u32(axes.theta.last) + 1u));
    let weights = ltc_weights(place.lambda, place.alpha);
    var sum = LtcTexels(vec4f(0.0), vec4f(0.0), vec4f(0.0));
    for (var slice = 0u; slice < 4u; slice++) {
        let upper = vec2u(slice & 1u, slice >> 1u);
        let weight = ltc_weight(place.phi, upper.x) * ltc_weight(place.theta, upper.y);
        var at = vec3u(place.lambda.cell, place.alpha.cell, place.phi.cell + upper.x + phis * (place.theta.cell + upper.y));
        sum.g0 += weight * ltc_fetch_four_anisotropic(texture, at, weights);
        at += group;
        sum.g1 += weight * ltc_fetch_four_anisotropic(texture, at, weights);
        at += group;
        sum.g2 += weight * ltc_fetch_four_anisotropic(texture, at, weights);
    }
    return sum;
}

// Between four neighbours of one slice.
fn ltc_fetch_four_anisotropic(texture: texture_3d<f32>, at: vec3u, weights: vec4f) -> vec4f {
    return weights.x * textureLoad(texture, at, 0)
        + weights.y * textureLoad(texture, at + vec3u(1u, 0u, 0u), 0)
        + weights.z * textureLoad(texture, at + vec3u(0u, 1u, 0u), 0)
        + weights.w * textureLoad(texture, at + vec3u(1u, 1u, 0u), 0);
}

// The nearest entry alone.
fn ltc_fetch_nearest_anisotropic(
    texture: texture_3d<f32>,
    axes: LtcAxes,
    place: LtcAnisotropicPlace,
) -> LtcTexels {
    let phis = u32(axes.phi.last) + 1u;
    let slice = ltc_nearest_node(place.phi) + phis * ltc_nearest_node(place.theta);
    let at = vec3u(ltc_nearest_node(place.lambda), ltc_nearest_node(place.alpha), slice);
    return ltc_fetch_entry(texture, at, phis * (u32(axes.theta.last) + 1u));
}

// The table's answer for the unit vector `wo`, in the shading frame.
fn ltc_lookup_anisotropic(
    texture: texture_3d<f32>,
    axes: LtcAxes,
    wo: vec3f,
    alpha_x: f32,
    alpha_y: f32,
) -> LtcLookup {
    let place = ltc_anisotropic_place(axes, wo, alpha_x, alpha_y);
    var texels = ltc_fetch_anisotropic(texture, axes, place);
    if !ltc_regular(texels) {
        texels = ltc_with_matrix(texels, ltc_fetch_nearest_anisotropic(texture, axes, place));
    }
    return ltc_unfold(place.fold, texels, ltc_channels(texels, wo, alpha_x, alpha_y));
}
