// The anisotropic table interpolated by the texture unit, which rounds weights to about 8 bits: 6 fetches. No bindings:
// the texture is a parameter. Needs: anisotropic, fetch_hardware_groups.

fn ltc_fetch_theta(
    texture: texture_3d<f32>,
    filtering: sampler,
    axes: LtcAxes,
    place: LtcAnisotropicPlace,
    theta: f32,
) -> LtcTexels {
    let phis = axes.phi.last + 1.0;
    let thetas = axes.theta.last + 1.0;
    // phi stays within the nodes of its theta: the filter never reaches into the next one.
    let at = vec3f(ltc_texel(place.lambda), ltc_texel(place.alpha), ltc_texel(place.phi) + phis * theta);
    return ltc_fetch_groups(texture, filtering, vec3f(textureDimensions(texture)), at, phis * thetas);
}

fn ltc_fetch_anisotropic(
    texture: texture_3d<f32>,
    filtering: sampler,
    axes: LtcAxes,
    place: LtcAnisotropicPlace,
) -> LtcTexels {
    let low = f32(place.theta.cell);
    return ltc_blend(
        ltc_fetch_theta(texture, filtering, axes, place, low),
        ltc_fetch_theta(texture, filtering, axes, place, low + 1.0),
        place.theta.t,
    );
}

// The table's answer for the unit vector `wo`, in the shading frame.
fn ltc_lookup_anisotropic(
    texture: texture_3d<f32>,
    filtering: sampler,
    axes: LtcAxes,
    wo: vec3f,
    alpha_x: f32,
    alpha_y: f32,
) -> LtcLookup {
    let place = ltc_anisotropic_place(axes, wo, alpha_x, alpha_y);
    var texels = ltc_fetch_anisotropic(texture, filtering, axes, place);
    if !ltc_regular(texels) {
        let nearest = ltc_anisotropic_nearest(place);
        let theta = f32(ltc_nearest_node(place.theta));
        texels = ltc_with_matrix(texels, ltc_fetch_theta(texture, filtering, axes, nearest, theta));
    }
    return ltc_unfold(place.fold, texels, ltc_channels(texels, wo, alpha_x, alpha_y));
}
