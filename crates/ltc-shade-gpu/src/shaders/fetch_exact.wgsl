// Interpolation by hand, in full f32: for devices that do not filter 32-bit floats, and as the exact path on all others.
// No bindings: textures are parameters. Needs: table, isotropic, anisotropic.

fn ltc_weight(place: LtcPlace, upper: u32) -> f32 {
    return select(1.0 - place.t, place.t, upper == 1u);
}

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
