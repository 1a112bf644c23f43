// The anisotropic table with more nodes along lambda, of which the nearest is taken; all else is interpolated by the texture unit,
// which rounds weights to about 8 bits: 3 fetches. No bindings: the texture is a parameter. Needs: table, anisotropic.
//
// Texture: 3D, x = alpha nodes, y = phi nodes, z = theta node + thetas * (node of the finer lambda + their number * group of four channels).

struct LtcRefinedPlace {
    // In texels.
    alpha: f32,
    phi: f32,
    theta: f32,
    // Of the texture: its size, and from group to group of channels.
    size: vec3f,
    group: f32,
}

fn ltc_refined_place(size: vec3f, axes: LtcAxes, place: LtcAnisotropicPlace) -> LtcRefinedPlace {
    let thetas = axes.theta.last + 1.0;
    let group = size.z / 3.0;
    let fine = (group / thetas - 1.0) / axes.lambda.last;
    let node = floor((f32(place.lambda.cell) + place.lambda.t) * fine + 0.5);
    // theta stays within the nodes of its lambda: the filter never reaches into the next one.
    return LtcRefinedPlace(
        ltc_texel(place.alpha),
        ltc_texel(place.phi),
        ltc_texel(place.theta) + thetas * node,
        size,
        group,
    );
}

fn ltc_fetch_refined(texture: texture_3d<f32>, filtering: sampler, place: LtcRefinedPlace) -> LtcTexels {
    let at = vec3f(place.alpha, place.phi, place.theta) / place.size;
    let group = vec3f(0.0, 0.0, place.group / place.size.z);
    return LtcTexels(
        textureSampleLevel(texture, filtering, at, 0.0),
        textureSampleLevel(texture, filtering, at + group, 0.0),
        textureSampleLevel(texture, filtering, at + 2.0 * group, 0.0),
    );
}

// The nearest entry alone.
fn ltc_fetch_nearest_refined(texture: texture_3d<f32>, place: LtcRefinedPlace) -> LtcTexels {
    let at = vec3u(vec3f(place.alpha, place.phi, place.theta));
    let group = vec3u(0u, 0u, u32(place.group));
    return LtcTexels(
        textureLoad(texture, at, 0),
        textureLoad(texture, at + group, 0),
        textureLoad(texture, at + 2u * group, 0),
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
    let refined = ltc_refined_place(vec3f(textureDimensions(texture)), axes, place);
    var texels = ltc_fetch_refined(texture, filtering, refined);
    if !ltc_regular(texels) {
        texels = ltc_with_matrix(texels, ltc_fetch_nearest_refined(texture, refined));
    }
    return ltc_unfold(place.fold, texels, ltc_channels(texels, wo, alpha_x, alpha_y));
}
