// Entry points: forward shading of triangles, in the fragment stage. Needs: shade.

struct ForwardUniform {
    clip_from_world: mat4x4f,
    // In world space.
    eye: vec3f,
    light_count: u32,
    f0: vec3f,
    f90: f32,
    albedo: vec3f,
    table: u32,
    alpha_x: f32,
    alpha_y: f32,
    unused_0: u32,
    unused_1: u32,
}

@group(1) @binding(0) var<uniform> forward: ForwardUniform;
@group(1) @binding(1) var<storage, read> lights: array<LightRecord>;
@group(1) @binding(2) var<storage, read> light_vertices: array<vec4f>;

struct ForwardVarying {
    @builtin(position) clip: vec4f,
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) tangent: vec3f,
}

@vertex
fn vertex_main(
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) tangent: vec3f,
) -> ForwardVarying {
    return ForwardVarying(forward.clip_from_world * vec4f(position, 1.0), position, normal, tangent);
}

// Radiance towards the eye, on whichever side is seen.
@fragment
fn fragment_main(in: ForwardVarying) -> @location(0) vec4f {
    let wo = ltc_unit_or_zero(forward.eye - in.position);
    let normal = select(in.normal, -in.normal, dot(in.normal, wo) < 0.0);
    let point = SurfacePoint(
        in.position,
        forward.alpha_x,
        normal,
        forward.alpha_y,
        in.tangent,
        forward.table,
        wo,
        forward.f90,
        forward.f0,
        0.0,
        forward.albedo,
        0.0,
    );
    return vec4f(shade(point, forward.light_count), 1.0);
}
