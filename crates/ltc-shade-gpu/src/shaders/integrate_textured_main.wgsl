// Entry point: a batch of textured lights, each under a lobe of its own. Needs: light_textures.

struct IntegrateJob {
    // Columns of target_from_cosine.
    m0: vec3f,
    unused_0: u32,
    m1: vec3f,
    unused_1: u32,
    m2: vec3f,
    unused_2: u32,
    // In the shading frame, relative to the shading point.
    light: LightRecord,
}

@group(1) @binding(0) var<uniform> job_count: vec4u;
@group(1) @binding(1) var<storage, read> jobs: array<IntegrateJob>;
@group(1) @binding(2) var<storage, read> light_vertices: array<vec4f>;
@group(1) @binding(3) var<storage, read_write> results: array<vec4f>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= job_count.x {
        return;
    }
    let job = jobs[id.x];
    let lobe = ltc_lobe(mat3x3f(job.m0, job.m1, job.m2));
    let frame = LtcFrame(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 1.0, 0.0), vec3f(0.0, 0.0, 1.0));
    var seen = vec3f(light_fraction(lobe, job.light, frame, vec3f(0.0)));
    if seen.x > 0.0 {
        seen *= light_colour(lobe, job.light, frame, vec3f(0.0));
    }
    results[id.x] = vec4f(seen, 0.0);
}
