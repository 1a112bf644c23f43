// The isotropic table interpolated by hand, in full f32: on every device. No bindings: the texture is a parameter.
// Needs: table, isotropic.

fn ltc_fetch_isotropic(texture: texture_2d_array<f32>, place: LtcIsotropicPlace) -> LtcTexels {
    var sum = LtcTexels(vec4f(0.0), vec4f(0.0), vec4f(0.0));
    for (var corner = 0u; corner < 4u; corner++) {
        let upper = vec2u(corner & 1u, corner >> 1u);
        let weight = ltc_weight(place.alpha, upper.x) * ltc_weight(place.theta, upper.y);
        let at = vec2u(place.alpha.cell, place.theta.cell) + upper;
        sum.g0 += weight * textureLoad(texture, at, 0, 0);
        sum.g1 += weight * textureLoad(texture, at, 1, 0);
        sum.g2 += weight * textureLoad(texture, at, 2, 0);
    }
    return sum;
}
