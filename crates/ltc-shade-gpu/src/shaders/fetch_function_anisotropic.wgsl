// The anisotropic table out of a function of the host, `ltc_anisotropic_texel(entry: u32, group: u32) -> vec4f`: a storage
// buffer, or whatever else holds a table where there are no float textures. Interpolated by hand, in full f32. No bindings.
// Needs: table, anisotropic.
//
// entry = lambda node + lambdas * (alpha node + alphas * (phi node + phis * theta node)); group as in the texture.

fn ltc_fetch_anisotropic(axes: LtcAxes, place: LtcAnisotropicPlace) -> LtcTexels {
    let lambdas = u32(axes.lambda.last) + 1u;
    let alphas = u32(axes.alpha.last) + 1u;
    let phis = u32(axes.phi.last) + 1u;
    let weights = ltc_weights(place.lambda, place.alpha);
    var sum = LtcTexels(vec4f(0.0), vec4f(0.0), vec4f(0.0));
    for (var slice = 0u; slice < 4u; slice++) {
        let upper = vec2u(slice & 1u, slice >> 1u);
        let weight = ltc_weight(place.phi, upper.x) * ltc_weight(place.theta, upper.y);
        let layer = place.phi.cell + upper.x + phis * (place.theta.cell + upper.y);
        let entry = place.lambda.cell + lambdas * (place.alpha.cell + alphas * layer);
        sum.g0 += weight * ltc_fetch_four_anisotropic(entry, lambdas, 0u, weights);
        sum.g1 += weight * ltc_fetch_four_anisotropic(entry, lambdas, 1u, weights);
        sum.g2 += weight * ltc_fetch_four_anisotropic(entry, lambdas, 2u, weights);
    }
    return sum;
}

// Between four neighbours of one slice.
fn ltc_fetch_four_anisotropic(entry: u32, lambdas: u32, group: u32, weights: vec4f) -> vec4f {
    return weights.x * ltc_anisotropic_texel(entry, group)
        + weights.y * ltc_anisotropic_texel(entry + 1u, group)
        + weights.z * ltc_anisotropic_texel(entry + lambdas, group)
        + weights.w * ltc_anisotropic_texel(entry + lambdas + 1u, group);
}

// The nearest entry alone.
fn ltc_fetch_nearest_anisotropic(axes: LtcAxes, place: LtcAnisotropicPlace) -> LtcTexels {
    let lambdas = u32(axes.lambda.last) + 1u;
    let alphas = u32(axes.alpha.last) + 1u;
    let phis = u32(axes.phi.last) + 1u;
    let layer = ltc_nearest_node(place.phi) + phis * ltc_nearest_node(place.theta);
    let entry = ltc_nearest_node(place.lambda) + lambdas * (ltc_nearest_node(place.alpha) + alphas * layer);
    return LtcTexels(
        ltc_anisotropic_texel(entry, 0u),
        ltc_anisotropic_texel(entry, 1u),
        ltc_anisotropic_texel(entry, 2u),
    );
}

// The table's answer for the unit vector `wo`, in the shading frame.
fn ltc_lookup_anisotropic(axes: LtcAxes, wo: vec3f, alpha_x: f32, alpha_y: f32) -> LtcLookup {
    let place = ltc_anisotropic_place(axes, wo, alpha_x, alpha_y);
    var texels = ltc_fetch_anisotropic(axes, place);
    if !ltc_regular(texels) {
        texels = ltc_with_matrix(texels, ltc_fetch_nearest_anisotropic(axes, place));
    }
    return ltc_unfold(place.fold, texels, ltc_channels(texels, wo, alpha_x, alpha_y));
}
