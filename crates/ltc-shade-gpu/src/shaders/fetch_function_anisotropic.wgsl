// The anisotropic table out of a function of the host, `ltc_anisotropic_texel(entry: u32, group: u32) -> vec4f`: a storage
// buffer, or whatever else holds a table where there are no float textures. Interpolated by hand, in full f32. No bindings.
// Needs: table, anisotropic.
//
// entry = lambda node + lambdas * (alpha node + alphas * (phi node + phis * theta node)); group as in the texture.

fn ltc_fetch_anisotropic(axes: LtcAxes, place: LtcAnisotropicPlace) -> LtcTexels {
    let lambdas = u32(axes.lambda.last) + 1u;
    let alphas = u32(axes.alpha.last) + 1u;
    let phis = u32(axes.phi.last) + 1u;
    var sum = LtcTexels(vec4f(0.0), vec4f(0.0), vec4f(0.0));
    for (var corner = 0u; corner < 16u; corner++) {
        let upper = (vec4u(corner) >> vec4u(0u, 1u, 2u, 3u)) & vec4u(1u);
        let weight = ltc_weight(place.lambda, upper.x) * ltc_weight(place.alpha, upper.y)
            * ltc_weight(place.phi, upper.z) * ltc_weight(place.theta, upper.w);
        let slice = place.phi.cell + upper.z + phis * (place.theta.cell + upper.w);
        let entry = place.lambda.cell + upper.x + lambdas * (place.alpha.cell + upper.y + alphas * slice);
        sum.g0 += weight * ltc_anisotropic_texel(entry, 0u);
        sum.g1 += weight * ltc_anisotropic_texel(entry, 1u);
        sum.g2 += weight * ltc_anisotropic_texel(entry, 2u);
    }
    return sum;
}
