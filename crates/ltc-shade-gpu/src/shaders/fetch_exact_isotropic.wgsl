// The isotropic table interpolated by hand, in full f32: on every device. No bindings: the texture is a parameter.
// Needs: table, isotropic, fetch_exact_layer.

fn ltc_fetch_isotropic(texture: texture_2d_array<f32>, place: LtcIsotropicPlace) -> LtcTexels {
    let at = vec2u(place.alpha.cell, place.theta.cell);
    let weights = ltc_weights(place.alpha, place.theta);
    return LtcTexels(
        ltc_fetch_four_layer(texture, at, 0u, weights),
        ltc_fetch_four_layer(texture, at, 1u, weights),
        ltc_fetch_four_layer(texture, at, 2u, weights),
    );
}

// The nearest entry alone.
fn ltc_fetch_nearest_isotropic(texture: texture_2d_array<f32>, place: LtcIsotropicPlace) -> LtcTexels {
    let at = vec2u(ltc_nearest_node(place.alpha), ltc_nearest_node(place.theta));
    return LtcTexels(
        textureLoad(texture, at, 0, 0),
        textureLoad(texture, at, 1, 0),
        textureLoad(texture, at, 2, 0),
    );
}

// The table's answer for the unit vector `wo`, in the shading frame.
fn ltc_lookup_isotropic(
    texture: texture_2d_array<f32>,
    axes: LtcAxes,
    wo: vec3f,
    alpha: f32,
) -> LtcLookup {
    let place = ltc_isotropic_place(axes, wo, alpha);
    var texels = ltc_fetch_isotropic(texture, place);
    if !ltc_regular(texels) {
        texels = ltc_with_matrix(texels, ltc_fetch_nearest_isotropic(texture, place));
    }
    return ltc_isotropic_decode(texels, wo);
}
