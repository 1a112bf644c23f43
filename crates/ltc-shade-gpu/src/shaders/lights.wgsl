// Lights of all kinds from a storage buffer. Whoever includes it binds `light_vertices`. Needs: constants, frame, the
// modules of the lights.

struct LightRecord {
    // Points and directions in world space; which is what depends on the kind, see `LightLayout` in Rust.
    a: vec4f,
    b: vec4f,
    c: vec4f,
    d: vec4f,
    radiance: vec3f,
    // The kind in the lowest byte, then flags.
    bits: u32,
}

fn light_kind(light: LightRecord) -> u32 {
    return light.bits & 255u;
}

fn light_two_sided(light: LightRecord) -> bool {
    return (light.bits & LIGHT_TWO_SIDED) != 0u;
}

// The light as the shading point sees it; a polygon's vertices stay where they are.
fn light_in_frame(light: LightRecord, frame: LtcFrame, position: vec3f) -> LightRecord {
    let kind = light_kind(light);
    let b_is_direction = kind == LIGHT_DISK || kind == LIGHT_ELLIPSE;
    let c_is_direction = kind != LIGHT_QUAD;
    var result = light;
    if kind != LIGHT_POLYGON {
        let b = light.b.xyz - select(position, vec3f(0.0), b_is_direction);
        let c = light.c.xyz - select(position, vec3f(0.0), c_is_direction);
        result.a = vec4f(ltc_shading_from_world(frame, light.a.xyz - position), light.a.w);
        result.b = vec4f(ltc_shading_from_world(frame, b), light.b.w);
        result.c = vec4f(ltc_shading_from_world(frame, c), light.c.w);
        result.d = vec4f(ltc_shading_from_world(frame, light.d.xyz - position), light.d.w);
    }
    return result;
}

fn polygon_fraction(lobe: LtcLobe, light: LightRecord, frame: LtcFrame, position: vec3f) -> f32 {
    let first = bitcast<u32>(light.a.x);
    let count = bitcast<u32>(light.a.y);
    var polygon = ltc_polygon(lobe, ltc_shading_from_world(frame, light_vertices[first].xyz - position));
    for (var i = 1u; i < count; i++) {
        let vertex = ltc_shading_from_world(frame, light_vertices[first + i].xyz - position);
        ltc_polygon_push(&polygon, lobe, vertex);
    }
    return ltc_polygon_fraction(&polygon, lobe, light_two_sided(light));
}

// The fraction of the lobe that sees the light, which is in the frame already.
fn light_fraction(lobe: LtcLobe, light: LightRecord, frame: LtcFrame, position: vec3f) -> f32 {
    let two_sided = light_two_sided(light);
    let a = light.a.xyz;
    let b = light.b.xyz;
    let c = light.c.xyz;
    switch light_kind(light) {
        case LIGHT_QUAD: {
            return ltc_quad(lobe, a, b, c, light.d.xyz, two_sided);
        }
        case LIGHT_POLYGON: {
            return polygon_fraction(lobe, light, frame, position);
        }
        case LIGHT_LINE: {
            return ltc_line(lobe, a, b, light.a.w);
        }
        case LIGHT_LINE_WITH_CAPS: {
            return ltc_line_with_caps(lobe, a, b, light.a.w);
        }
        case LIGHT_STRIP: {
            return ltc_strip(lobe, a, b, light.a.w, c, two_sided);
        }
        case LIGHT_CYLINDER: {
            return ltc_cylinder(lobe, a, b, light.a.w, (light.bits & LIGHT_CAPS) != 0u);
        }
        case LIGHT_DISK: {
            return ltc_disk(lobe, a, b, light.a.w, two_sided);
        }
        case LIGHT_ELLIPSE: {
            return ltc_ellipse(lobe, a, b, c, two_sided);
        }
        case LIGHT_SPHERE: {
            return ltc_sphere(lobe, a, light.a.w);
        }
        default: {
            return 0.0;
        }
    }
}
