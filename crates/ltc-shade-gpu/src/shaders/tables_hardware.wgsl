// Bindings of the tables, interpolated by the texture unit. Needs: isotropic, anisotropic, fetch_hardware_isotropic, fetch_filtered_anisotropic.

@group(0) @binding(0) var<uniform> isotropic_axes: LtcAxes;
@group(0) @binding(1) var isotropic_table: texture_2d_array<f32>;
@group(0) @binding(2) var<uniform> anisotropic_axes: LtcAxes;
@group(0) @binding(3) var anisotropic_table: texture_3d<f32>;
@group(0) @binding(4) var table_filter: sampler;

fn lookup_isotropic(wo: vec3f, alpha: f32) -> LtcLookup {
    return ltc_lookup_isotropic(isotropic_table, table_filter, isotropic_axes, wo, alpha);
}

fn lookup_anisotropic(wo: vec3f, alpha_x: f32, alpha_y: f32) -> LtcLookup {
    return ltc_lookup_anisotropic(anisotropic_table, table_filter, anisotropic_axes, wo, alpha_x, alpha_y);
}
