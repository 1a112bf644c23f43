// Slices out of a function of the host, `ltc_baked_texel(entry: u32, group: u32) -> vec4f`: a storage buffer, or whatever else holds
// them where there are no float textures. Interpolated by hand, in full f32. No bindings. Needs: table, baked.
//
// entry = phi node + phis * (theta node + thetas * slice); group as in the texture.

// Between four neighbours.
fn ltc_fetch_four_baked(entry: u32, phis: u32, group: u32, weights: vec4f) -> vec4f {
    return weights.x * ltc_baked_texel(entry, group)
        + weights.y * ltc_baked_texel(entry + 1u, group)
        + weights.z * ltc_baked_texel(entry + phis, group)
        + weights.w * ltc_baked_texel(entry + phis + 1u, group);
}

// The table's answer for the unit vector `wo`, in the shading frame, and the widths that the slice was baked for.
fn ltc_lookup_baked(axes: LtcAxes, wo: vec3f, alpha_x: f32, alpha_y: f32, slice: u32) -> LtcLookup {
    let place = ltc_baked_place(axes, wo, alpha_x, alpha_y);
    let phis = u32(axes.phi.last) + 1u;
    let first = phis * (u32(axes.theta.last) + 1u) * slice;
    let entry = first + place.phi.cell + phis * place.theta.cell;
    let weights = ltc_weights(place.phi, place.theta);
    var texels = LtcTexels(
        ltc_fetch_four_baked(entry, phis, 0u, weights),
        ltc_fetch_four_baked(entry, phis, 1u, weights),
        ltc_fetch_four_baked(entry, phis, 2u, weights),
    );
    if !ltc_regular(texels) {
        let node = first + ltc_nearest_node(place.phi) + phis * ltc_nearest_node(place.theta);
        let nearest = LtcTexels(ltc_baked_texel(node, 0u), ltc_baked_texel(node, 1u), ltc_baked_texel(node, 2u));
        texels = ltc_with_matrix(texels, nearest);
    }
    return ltc_unfold(place.fold, texels, ltc_channels(texels, wo, alpha_x, alpha_y));
}
