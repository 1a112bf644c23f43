// Entry point: a batch of lookups. Needs: table_choice.

struct LookupJob {
    wo: vec3f,
    alpha_x: f32,
    alpha_y: f32,
    // As in a surface point.
    table: u32,
    unused_0: u32,
    unused_1: u32,
}

@group(1) @binding(0) var<uniform> job_count: vec4u;
@group(1) @binding(1) var<storage, read> jobs: array<LookupJob>;
@group(1) @binding(2) var<storage, read_write> results: array<vec4f>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= job_count.x {
        return;
    }
    let job = jobs[id.x];
    let found = look_up(job.table, job.wo, job.alpha_x, job.alpha_y);
    // Row-major, then the two channels: the layout of a texel triple.
    let m = found.m;
    results[3u * id.x] = vec4f(m[0].x, m[1].x, m[2].x, m[0].y);
    results[3u * id.x + 1u] = vec4f(m[1].y, m[2].y, m[0].z, m[1].z);
    results[3u * id.x + 2u] = vec4f(m[2].z, found.magnitude, found.fresnel, 0.0);
}
