// The isotropic table out of a function of the host, `ltc_isotropic_texel(entry: u32, group: u32) -> vec4f`: a storage buffer,
// or whatever else holds a table where there are no float textures. Interpolated by hand, in full f32. No bindings.
// Needs: table, isotropic.
//
// entry = alpha node + alphas * theta node; group as in the texture.

fn ltc_fetch_isotropic(axes: LtcAxes, place: LtcIsotropicPlace) -> LtcTexels {
    let alphas = u32(axes.alpha.last) + 1u;
    let entry = place.alpha.cell + alphas * place.theta.cell;
    let weights = ltc_weights(place.alpha, place.theta);
    return LtcTexels(
        ltc_fetch_four_isotropic(entry, alphas, 0u, weights),
        ltc_fetch_four_isotropic(entry, alphas, 1u, weights),
        ltc_fetch_four_isotropic(entry, alphas, 2u, weights),
    );
}

// Between four neighbours.
fn ltc_fetch_four_isotropic(entry: u32, alphas: u32, group: u32, weights: vec4f) -> vec4f {
    return weights.x * ltc_isotropic_texel(entry, group)
        + weights.y * ltc_isotropic_texel(entry + 1u, group)
        + weights.z * ltc_isotropic_texel(entry + alphas, group)
        + weights.w * ltc_isotropic_texel(entry + alphas + 1u, group);
}

// The nearest entry alone.
fn ltc_fetch_nearest_isotropic(axes: LtcAxes, place: LtcIsotropicPlace) -> LtcTexels {
    let entry = ltc_nearest_node(place.alpha) + (u32(axes.alpha.last) + 1u) * ltc_nearest_node(place.theta);
    return LtcTexels(
        ltc_isotropic_texel(entry, 0u),
        ltc_isotropic_texel(entry, 1u),
        ltc_isotropic_texel(entry, 2u),
    );
}

// The table's answer for the unit vector `wo`, in the shading frame.
fn ltc_lookup_isotropic(axes: LtcAxes, wo: vec3f, alpha: f32) -> LtcLookup {
    let place = ltc_isotropic_place(axes, wo, alpha);
    var texels = ltc_fetch_isotropic(axes, place);
    if !ltc_regular(texels) {
        texels = ltc_with_matrix(texels, ltc_fetch_nearest_isotropic(axes, place));
    }
    return ltc_isotropic_decode(texels, wo);
}
