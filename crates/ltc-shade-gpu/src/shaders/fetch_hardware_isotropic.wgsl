// The isotropic table interpolated by the texture unit, which rounds weights to about 8 bits: 3 fetches. No bindings:
// the texture is a parameter. Needs: table, isotropic.

fn ltc_fetch_isotropic(texture: texture_2d_array<f32>, filtering: sampler, place: LtcIsotropicPlace) -> LtcTexels {
    let at = vec2f(ltc_texel(place.alpha), ltc_texel(place.theta)) / vec2f(textureDimensions(texture));
    return LtcTexels(
        textureSampleLevel(texture, filtering, at, 0, 0.0),
        textureSampleLevel(texture, filtering, at, 1, 0.0),
        textureSampleLevel(texture, filtering, at, 2, 0.0),
    );
}

// The table's answer for the unit vector `wo`, in the shading frame.
fn ltc_lookup_isotropic(
    texture: texture_2d_array<f32>,
    filtering: sampler,
    axes: LtcAxes,
    wo: vec3f,
    alpha: f32,
) -> LtcLookup {
    let place = ltc_isotropic_place(axes, wo, alpha);
    var texels = ltc_fetch_isotropic(texture, filtering, place);
    if !ltc_regular(texels) {
        let nearest = LtcIsotropicPlace(ltc_nearest(place.theta), ltc_nearest(place.alpha));
        texels = ltc_with_matrix(texels, ltc_fetch_isotropic(texture, filtering, nearest));
    }
    return ltc_isotropic_decode(texels, wo);
}
