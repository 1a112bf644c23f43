// The anisotropic table interpolated by hand, in full f32: on every device. No bindings: the texture is a parameter.
// Needs: table, anisotropic.

fn ltc_fetch_anisotropic(
    texture: texture_3d<f32>,
    axes: LtcAxes,
    place: LtcAnisotropicPlace,
) -> LtcTexels {
    let phis = u32(axes.phi.last) + 1u;
    let group = phis * (u32(axes.theta.last) + 1u);
    var sum = LtcTexels(vec4f(0.0), vec4f(0.0), vec4f(0.0));
    for (var corner = 0u; corner < 16u; corner++) {
        let upper = (vec4u(corner) >> vec4u(0u, 1u, 2u, 3u)) & vec4u(1u);
        let weight = ltc_weight(place.lambda, upper.x) * ltc_weight(place.alpha, upper.y)
            * ltc_weight(place.phi, upper.z) * ltc_weight(place.theta, upper.w);
        let layer = place.phi.cell + upper.z + phis * (place.theta.cell + upper.w);
        let at = vec3u(place.lambda.cell + upper.x, place.alpha.cell + upper.y, layer);
        sum.g0 += weight * textureLoad(texture, at, 0);
        sum.g1 += weight * textureLoad(texture, at + vec3u(0u, 0u, group), 0);
        sum.g2 += weight * textureLoad(texture, at + vec3u(0u, 0u, 2u * group), 0);
    }
    return sum;
}
