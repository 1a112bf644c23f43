// What the probe asks of a device. Needs: math, precise.

@group(1) @binding(0) var<uniform> probe_count: vec4u;
@group(1) @binding(1) var<storage, read> probe_input: array<vec4f>;
@group(1) @binding(2) var<storage, read_write> probe_output: array<vec4f>;

// Our arc tangent, the built-in one, a root over its argument, and a product that cancels.
@compute @workgroup_size(64)
fn arithmetic(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= probe_count.x {
        return;
    }
    let v = probe_input[id.x];
    let cancelling = ltc_cross(vec3f(v.x, v.y, 0.0), vec3f(v.z, v.w, 0.0)).z;
    probe_output[id.x] = vec4f(ltc_atan2(v.y, v.x), atan2(v.y, v.x), sqrt(abs(v.z)) / v.w, cancelling);
}

// How many comparisons with a NaN in x come out right, of four.
@compute @workgroup_size(64)
fn not_a_number(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= probe_count.x {
        return;
    }
    let x = probe_input[id.x].x;
    var right = 0.0;
    right += select(1.0, 0.0, x > 0.0);
    right += select(1.0, 0.0, x <= 0.0);
    if !(x > LTC_TINY) {
        right += 1.0;
    }
    if !(x == x) {
        right += 1.0;
    }
    probe_output[id.x] = vec4f(right, 0.0, 0.0, 0.0);
}

@group(0) @binding(0) var probe_texture: texture_2d<f32>;
@group(0) @binding(1) var probe_filter: sampler;

// What the texture unit gives at x, in texels.
@compute @workgroup_size(64)
fn filtering(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= probe_count.x {
        return;
    }
    let at = vec2f(probe_input[id.x].x, 0.5) / vec2f(textureDimensions(probe_texture));
    probe_output[id.x] = textureSampleLevel(probe_texture, probe_filter, at, 0.0);
}
