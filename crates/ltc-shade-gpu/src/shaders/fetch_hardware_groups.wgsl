// One fetch by the texture unit for each group of channels of a 3D texture. No bindings: the texture is a parameter. Needs: table.

// `at` in texels, of which the texture has `size`; groups are `group` texels apart along z.
fn ltc_fetch_groups(
    texture: texture_3d<f32>,
    filtering: sampler,
    size: vec3f,
    at: vec3f,
    group: f32,
) -> LtcTexels {
    let place = at / size;
    let further = vec3f(0.0, 0.0, group / size.z);
    return LtcTexels(
        textureSampleLevel(texture, filtering, place, 0.0),
        textureSampleLevel(texture, filtering, place + further, 0.0),
        textureSampleLevel(texture, filtering, place + 2.0 * further, 0.0),
    );
}
