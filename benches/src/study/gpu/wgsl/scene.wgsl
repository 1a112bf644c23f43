// A floor seen by an eye, each pixel with a material of its own, under lights around it. What is timed defines
//     alias TimedLobe
//     fn timed_find(pixel: TimedPixel) -> TimedFound
//     fn timed_fraction(lobe: TimedLobe, position: vec3f, light: u32) -> f32
// as far as its `pixel` needs them.

struct TimedPixel {
    // On the floor, z = 0; the shading frame is the world's.
    position: vec3f,
    alpha_x: f32,
    // Unit, towards the eye.
    wo: vec3f,
    alpha_y: f32,
}

// Lights to take.
@group(1) @binding(0) var<uniform> timed_lights: vec4u;
@group(1) @binding(1) var<storage, read> timed_input: array<TimedPixel>;
// As many numbers a light as its shape takes.
@group(1) @binding(2) var<storage, read> timed_points: array<vec4f>;

// A lobe as narrow as the material and leaning away from the view: M, without a table.
fn timed_matrix(p: TimedPixel) -> mat3x3f {
    let lean = vec3f(p.wo.xy * -0.9, sqrt(max(1.0 - 0.81 * dot(p.wo.xy, p.wo.xy), 0.0)));
    let t = timed_tangent(lean);
    return mat3x3f(t * p.alpha_x, cross(lean, t) * p.alpha_y, lean);
}

// Duff et al. 2017, for n.z > 0.
fn timed_tangent(n: vec3f) -> vec3f {
    let a = -1.0 / (1.0 + n.z);
    return vec3f(1.0 + n.x * n.x * a, n.x * n.y * a, -n.x);
}

fn timed_reflectance(magnitude: f32, fresnel: f32) -> f32 {
    return 0.04 * magnitude + 0.96 * fresnel;
}
