// Bindings of the tables as storage buffers: groups of four channels, one after the other, entries in table order within
// each. Needs: fetch_function_isotropic, fetch_function_anisotropic.

@group(0) @binding(0) var<uniform> isotropic_axes: LtcAxes;
@group(0) @binding(1) var<storage, read> isotropic_table: array<vec4f>;
@group(0) @binding(2) var<uniform> anisotropic_axes: LtcAxes;
@group(0) @binding(3) var<storage, read> anisotropic_table: array<vec4f>;

fn ltc_isotropic_texel(entry: u32, group: u32) -> vec4f {
    return isotropic_table[group * (arrayLength(&isotropic_table) / 3u) + entry];
}

fn ltc_anisotropic_texel(entry: u32, group: u32) -> vec4f {
    return anisotropic_table[group * (arrayLength(&anisotropic_table) / 3u) + entry];
}

fn lookup_isotropic(wo: vec3f, alpha: f32) -> LtcLookup {
    let place = ltc_isotropic_place(isotropic_axes, wo, alpha);
    var texels = ltc_fetch_isotropic(isotropic_axes, place);
    if !ltc_regular(texels) {
        let nearest = LtcIsotropicPlace(ltc_nearest(place.theta), ltc_nearest(place.alpha));
        texels = ltc_with_matrix(texels, ltc_fetch_isotropic(isotropic_axes, nearest));
    }
    return ltc_isotropic_decode(texels, wo);
}

fn lookup_anisotropic(wo: vec3f, alpha_x: f32, alpha_y: f32) -> LtcLookup {
    let place = ltc_anisotropic_place(anisotropic_axes, wo, alpha_x, alpha_y);
    var texels = ltc_fetch_anisotropic(anisotropic_axes, place);
    if !ltc_regular(texels) {
        let nearest = ltc_anisotropic_nearest(place);
        texels = ltc_with_matrix(texels, ltc_fetch_anisotropic(anisotropic_axes, nearest));
    }
    return ltc_anisotropic_decode(texels, place);
}
