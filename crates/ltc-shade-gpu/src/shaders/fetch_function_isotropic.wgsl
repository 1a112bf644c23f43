// The isotropic table out of a function of the host, `ltc_isotropic_texel(entry: u32, group: u32) -> vec4f`: a storage buffer,
// or whatever else holds a table where there are no float textures. Interpolated by hand, in full f32. No bindings.
// Needs: table, isotropic.
//
// entry = alpha node + alphas * theta node; group as in the texture.

fn ltc_fetch_isotropic(axes: LtcAxes, place: LtcIsotropicPlace) -> LtcTexels {
    let alphas = u32(axes.alpha.last) + 1u;
    var sum = LtcTexels(vec4f(0.0), vec4f(0.0), vec4f(0.0));
    for (var corner = 0u; corner < 4u; corner++) {
        let upper = vec2u(corner & 1u, corner >> 1u);
        let weight = ltc_weight(place.alpha, upper.x) * ltc_weight(place.theta, upper.y);
        let entry = place.alpha.cell + upper.x + alphas * (place.theta.cell + upper.y);
        sum.g0 += weight * ltc_isotropic_texel(entry, 0u);
        sum.g1 += weight * ltc_isotropic_texel(entry, 1u);
        sum.g2 += weight * ltc_isotropic_texel(entry, 2u);
    }
    return sum;
}
