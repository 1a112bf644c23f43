// Bindings of the tables, interpolated by the texture unit. Needs: isotropic, anisotropic, fetch_hardware_isotropic, fetch_hardware_anisotropic.

@group(0) @binding(0) var<uniform> isotropic_axes: LtcAxes;
@group(0) @binding(1) var isotropic_table: texture_2d_array<f32>;
@group(0) @binding(2) var<uniform> anisotropic_axes: LtcAxes;
@group(0) @binding(3) var anisotropic_table: texture_3d<f32>;
@group(0) @binding(4) var table_filter: sampler;

fn lookup_isotropic(wo: vec3f, alpha: f32) -> LtcLookup {
    let place = ltc_isotropic_place(isotropic_axes, wo, alpha);
    var texels = ltc_fetch_isotropic(isotropic_table, table_filter, place);
    if !ltc_regular(texels) {
        let nearest = LtcIsotropicPlace(ltc_nearest(place.theta), ltc_nearest(place.alpha));
        texels = ltc_with_matrix(texels, ltc_fetch_isotropic(isotropic_table, table_filter, nearest));
    }
    return ltc_isotropic_decode(texels, wo);
}

fn lookup_anisotropic(wo: vec3f, alpha_x: f32, alpha_y: f32) -> LtcLookup {
    let place = ltc_anisotropic_place(anisotropic_axes, wo, alpha_x, alpha_y);
    var texels = ltc_fetch_anisotropic(anisotropic_table, table_filter, anisotropic_axes, place);
    if !ltc_regular(texels) {
        let nearest = ltc_anisotropic_nearest(place);
        texels = ltc_with_matrix(texels, ltc_fetch_anisotropic(anisotropic_table, table_filter, anisotropic_axes, nearest));
    }
    return ltc_anisotropic_decode(texels, place);
}
