// Schlick's Fresnel term from a table's two channels. No bindings.

// Directional reflectance F0 * n + (F90 - F0) * f, with n = integral of rho cos at F = 1 and f the same weighted by
// (1 - wo.wh)^5. Never below 0.
fn ltc_reflectance(f0: vec3f, f90: f32, magnitude: f32, fresnel: f32) -> vec3f {
    return max(f0 * magnitude + (vec3f(f90) - f0) * fresnel, vec3f(0.0));
}
