// The colour that a lobe sees of a light of any kind. Needs: lights, textured.

// Those of all lights; see `textured.wgsl`.
@group(0) @binding(5) var light_textures: texture_2d<f32>;

// White where the light has no texture. The light is in the frame already.
fn light_colour(lobe: LtcLobe, light: LightRecord, frame: LtcFrame, position: vec3f) -> vec3f {
    if (light.bits & LIGHT_TEXTURED) == 0u {
        return vec3f(1.0);
    }
    var texture = light.a.w;
    var origin = light.a.xyz;
    var axis_u = light.b.xyz - origin;
    var axis_v = light.d.xyz - origin;
    if light_kind(light) == LIGHT_POLYGON {
        texture = light.b.w;
        origin = ltc_shading_from_world(frame, light.b.xyz - position);
        axis_u = ltc_shading_from_world(frame, light.c.xyz);
        axis_v = ltc_shading_from_world(frame, light.d.xyz);
    }
    return ltc_texture_colour(light_textures, u32(texture), ltc_texture_fetch(lobe, origin, axis_u, axis_v));
}
