// One entry of a 3D texture, not interpolated. No bindings: the texture is a parameter. Needs: table.

// Groups of channels are `group` texels apart along z.
fn ltc_fetch_entry(texture: texture_3d<f32>, at: vec3u, group: u32) -> LtcTexels {
    let further = vec3u(0u, 0u, group);
    return LtcTexels(
        textureLoad(texture, at, 0),
        textureLoad(texture, at + further, 0),
        textureLoad(texture, at + 2u * further, 0),
    );
}
