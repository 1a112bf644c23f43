// Bindings of baked slices as a storage buffer: groups of four channels, one after the other, slices in order within each. Needs:
// fetch_function_baked, tables_buffer.

@group(0) @binding(6) var<uniform> baked_axes: LtcAxes;
@group(0) @binding(7) var<storage, read> baked_slices: array<vec4f>;

fn ltc_baked_texel(entry: u32, group: u32) -> vec4f {
    return baked_slices[group * (arrayLength(&baked_slices) / 3u) + entry];
}

fn lookup_baked(wo: vec3f, alpha_x: f32, alpha_y: f32, slice: u32) -> LtcLookup {
    return ltc_lookup_baked(baked_axes, wo, alpha_x, alpha_y, slice);
}
