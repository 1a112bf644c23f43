// The anisotropic table with more nodes along lambda, of which the nearest is taken; all else is interpolated by the texture unit,
// which rounds weights to about 8 bits: 3 fetches. No bindings: the texture is a parameter. Needs: anisotropic,
// fetch_exact_entry, fetch_hardware_groups.
//
// Texture: 3D, x = alpha nodes, y = phi nodes, z = theta node + thetas * (node of the finer lambda + their number * group of four channels).

struct LtcRefinedPlace {
    // In texels.
    at: vec3f,
    // From group to group of channels.
    group: f32,
}

fn ltc_refined_place(depth: f32, axes: LtcAxes, place: LtcAnisotropicPlace) -> LtcRefinedPlace {
    let thetas = axes.theta.last + 1.0;
    let group = depth / 3.0;
    let fine = (group / thetas - 1.0) / axes.lambda.last;
    let node = floor((f32(place.lambda.cell) + place.lambda.t) * fine + 0.5);
    // theta stays within the nodes of its lambda: the filter never reaches into the next one.
    let at = vec3f(ltc_texel(place.alpha), ltc_texel(place.phi), ltc_texel(place.theta) + thetas * node);
    return LtcRefinedPlace(at, group);
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
    let size = vec3f(textureDimensions(texture));
    let refined = ltc_refined_place(size.z, axes, place);
    var texels = ltc_fetch_groups(texture, filtering, size, refined.at, refined.group);
    if !ltc_regular(texels) {
        texels = ltc_with_matrix(texels, ltc_fetch_entry(texture, vec3u(refined.at), u32(refined.group)));
    }
    return ltc_unfold(place.fold, texels, ltc_channels(texels, wo, alpha_x, alpha_y));
}
