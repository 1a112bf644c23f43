// The isotropic table: coordinates in, texels out of the engine's fetch, lobe out. No bindings. Needs: math, table.
//
// Texture: 2D array, x = alpha nodes, y = theta nodes, layer = group of four channels.

struct LtcIsotropicPlace {
    theta: LtcPlace,
    alpha: LtcPlace,
}

// `wo` is a unit vector in the shading frame.
fn ltc_isotropic_place(axes: LtcAxes, wo: vec3f, alpha: f32) -> LtcIsotropicPlace {
    return LtcIsotropicPlace(ltc_place_of_theta(axes.theta, wo), ltc_place_of_value(axes.alpha, alpha));
}

// Turns the entry, which is for phi = 0, to the azimuth of `wo`: M(phi) = R(phi) M(0) R(-phi). For wo along the normal,
// which has no azimuth, every turn is the same lobe and none is taken.
fn ltc_isotropic_decode(texels: LtcTexels, wo: vec3f) -> LtcLookup {
    let in_surface = ltc_unit_or_zero(vec3f(wo.xy, 0.0));
    let azimuth = select(vec2f(1.0, 0.0), in_surface.xy, dot(in_surface, in_surface) > 0.5);
    let turn = mat3x3f(azimuth.x, azimuth.y, 0.0, -azimuth.y, azimuth.x, 0.0, 0.0, 0.0, 1.0);
    let m = turn * ltc_matrix(texels) * transpose(turn);
    return LtcLookup(m, texels.g2.y, texels.g2.z);
}
