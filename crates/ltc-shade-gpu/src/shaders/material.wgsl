// glTF's metallic-roughness parameters as the numbers that shading takes. No bindings. Needs: constants.

struct LtcMaterial {
    // Diffuse (Lambert) albedo.
    albedo: vec3f,
    // Specular reflectance at normal and at grazing incidence.
    f0: vec3f,
    f90: f32,
    // GGX widths along the tangent and the bitangent.
    alpha_x: f32,
    alpha_y: f32,
}

// pbrMetallicRoughness: perceptual roughness r is the width r^2; dielectrics reflect 4 % (index of refraction 1.5).
fn ltc_metallic_roughness(base_color: vec3f, metallic: f32, roughness: f32) -> LtcMaterial {
    let m = clamp(metallic, 0.0, 1.0);
    let alpha = clamp(roughness * roughness, LTC_ALPHA_MIN, 1.0);
    let color = clamp(base_color, vec3f(0.0), vec3f(1.0));
    return LtcMaterial(color * (1.0 - m), mix(vec3f(0.04), color, m), 1.0, alpha, alpha);
}

// KHR_materials_anisotropy: strength s in [0, 1] widens the lobe along the direction of anisotropy to mix(alpha, 1, s^2).
fn ltc_anisotropy(material: LtcMaterial, strength: f32) -> LtcMaterial {
    var result = material;
    result.alpha_x = mix(material.alpha_x, 1.0, clamp(strength * strength, 0.0, 1.0));
    return result;
}

// The tangent turned by KHR_materials_anisotropy's rotation, counter-clockwise from the tangent, for `ltc_frame`.
fn ltc_anisotropy_tangent(tangent: vec3f, bitangent: vec3f, rotation: f32) -> vec3f {
    return tangent * cos(rotation) + bitangent * sin(rotation);
}
