// Interpolation by hand in a 2D array texture. No bindings: the texture is a parameter.

// Between four neighbours of one layer.
fn ltc_fetch_four_layer(texture: texture_2d_array<f32>, at: vec2u, layer: u32, weights: vec4f) -> vec4f {
    return weights.x * textureLoad(texture, at, layer, 0)
        + weights.y * textureLoad(texture, at + vec2u(1u, 0u), layer, 0)
        + weights.z * textureLoad(texture, at + vec2u(0u, 1u), layer, 0)
        + weights.w * textureLoad(texture, at + vec2u(1u, 1u), layer, 0);
}
