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
