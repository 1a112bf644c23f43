// Bindings of baked slices, interpolated by hand. Needs: fetch_exact_baked, tables_exact.

@group(0) @binding(6) var<uniform> baked_axes: LtcAxes;
@group(0) @binding(7) var baked_slices: texture_2d_array<f32>;

fn lookup_baked(wo: vec3f, alpha_x: f32, alpha_y: f32, slice: u32) -> LtcLookup {
    return ltc_lookup_baked(baked_slices, baked_axes, wo, alpha_x, alpha_y, slice);
}
