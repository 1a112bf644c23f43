// Slices interpolated by the texture unit, which rounds weights to about 8 bits: 3 fetches. No bindings: the texture is a
// parameter. Needs: table, baked.

fn ltc_fetch_baked(
    texture: texture_2d_array<f32>,
    filtering: sampler,
    phi: LtcPlace,
    theta: LtcPlace,
    slice: u32,
) -> LtcTexels {
    let slices = textureNumLayers(texture) / 3u;
    let at = vec2f(ltc_texel(phi), ltc_texel(theta)) / vec2f(textureDimensions(texture));
    return LtcTexels(
        textureSampleLevel(texture, filtering, at, slice, 0.0),
        textureSampleLevel(texture, filtering, at, slice + slices, 0.0),
        textureSampleLevel(texture, filtering, at, slice + 2u * slices, 0.0),
    );
}

// The table's answer for the unit vector `wo`, in the shading frame, and the widths that the slice was baked for.
fn ltc_lookup_baked(
    texture: texture_2d_array<f32>,
    filtering: sampler,
    axes: LtcAxes,
    wo: vec3f,
    alpha_x: f32,
    alpha_y: f32,
    slice: u32,
) -> LtcLookup {
    let place = ltc_baked_place(axes, wo, alpha_x, alpha_y);
    var texels = ltc_fetch_baked(texture, filtering, place.phi, place.theta, slice);
    if !ltc_regular(texels) {
        let nearest =
            ltc_fetch_baked(texture, filtering, ltc_nearest(place.phi), ltc_nearest(place.theta), slice);
        texels = ltc_with_matrix(texels, nearest);
    }
    return ltc_unfold(place.fold, texels, ltc_channels(texels, wo, alpha_x, alpha_y));
}
