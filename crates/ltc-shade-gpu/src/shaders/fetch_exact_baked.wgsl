// Slices interpolated by hand, in full f32: on every device. No bindings: the texture is a parameter. Needs: table, baked, fetch_exact_layer.

// The table's answer for the unit vector `wo`, in the shading frame, and the widths that the slice was baked for.
fn ltc_lookup_baked(
    texture: texture_2d_array<f32>,
    axes: LtcAxes,
    wo: vec3f,
    alpha_x: f32,
    alpha_y: f32,
    slice: u32,
) -> LtcLookup {
    let place = ltc_baked_place(axes, wo, alpha_x, alpha_y);
    let slices = textureNumLayers(texture) / 3u;
    let at = vec2u(place.phi.cell, place.theta.cell);
    let weights = ltc_weights(place.phi, place.theta);
    var texels = LtcTexels(
        ltc_fetch_four_layer(texture, at, slice, weights),
        ltc_fetch_four_layer(texture, at, slice + slices, weights),
        ltc_fetch_four_layer(texture, at, slice + 2u * slices, weights),
    );
    if !ltc_regular(texels) {
        let node = vec2u(ltc_nearest_node(place.phi), ltc_nearest_node(place.theta));
        let nearest = LtcTexels(
            textureLoad(texture, node, slice, 0),
            textureLoad(texture, node, slice + slices, 0),
            textureLoad(texture, node, slice + 2u * slices, 0),
        );
        texels = ltc_with_matrix(texels, nearest);
    }
    return ltc_unfold(place.fold, texels, ltc_channels(texels, wo, alpha_x, alpha_y));
}
