// A surface point under all lights: one lookup, shared by deferred and forward shading. Whoever includes it binds
// `lights` and `light_vertices`. Needs: frame, lights, fresnel, table_choice.

struct SurfacePoint {
    position: vec3f,
    alpha_x: f32,
    normal: vec3f,
    alpha_y: f32,
    tangent: vec3f,
    // TABLE_ANISOTROPIC, TABLE_ISOTROPIC, or from TABLE_FIRST_SLICE on a slice.
    table: u32,
    // Unit, towards the eye, in world space.
    wo: vec3f,
    f90: f32,
    f0: vec3f,
    unused_0: f32,
    albedo: vec3f,
    unused_1: f32,
}

// The view direction in the shading frame, lifted onto the horizon where rounding put it below.
fn view_in_frame(frame: LtcFrame, wo: vec3f) -> vec3f {
    let v = ltc_shading_from_world(frame, wo);
    let unit = ltc_unit_or_zero(vec3f(v.xy, max(v.z, 0.0)));
    return select(vec3f(0.0, 0.0, 1.0), unit, dot(unit, unit) > 0.5);
}

fn shade(point: SurfacePoint, light_count: u32) -> vec3f {
    let frame = ltc_frame(point.normal, point.tangent);
    let wo = view_in_frame(frame, point.wo);
    let found = look_up(point.table, wo, point.alpha_x, point.alpha_y);
    let specular_lobe = ltc_lobe(found.m);
    let diffuse_lobe = ltc_cosine();
    let specular = ltc_reflectance(point.f0, point.f90, found.magnitude, found.fresnel);
    let has_diffuse = any(point.albedo > vec3f(0.0));
    var sum = vec3f(0.0);
    for (var i = 0u; i < light_count; i++) {
        let light = light_in_frame(lights[i], frame, point.position);
        // Both lobes by one copy of the lights' code.
        var lobe = specular_lobe;
        var reflectance = specular;
        for (var part = 0; part < 2; part++) {
            var seen = vec3f(light_fraction(lobe, light, frame, point.position));
//#if light_textures
            if seen.x > 0.0 {
                seen *= light_colour(lobe, light, frame, point.position);
            }
//#endif
            sum += light.radiance * reflectance * seen;
            if !has_diffuse {
                break;
            }
            lobe = diffuse_lobe;
            reflectance = point.albedo;
        }
    }
    return sum;
}
