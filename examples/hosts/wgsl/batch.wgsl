// A batch of quads, each under a lobe of its own. Behind what this writes:
//   ltc shader --lang wgsl --lights quad --features surface-horizon,cosine-horizon,two-sided

struct Job {
    // Columns of M (target_from_cosine).
    m0: vec4f,
    m1: vec4f,
    m2: vec4f,
    // Corners in the shading frame, relative to the shading point.
    corners: array<vec4f, 4>,
    // Flags in the last word: 256 for a light that emits to both sides.
    flags: vec4u,
}

@group(0) @binding(0) var<uniform> count: vec4u;
@group(0) @binding(1) var<storage, read> jobs: array<Job>;
@group(0) @binding(2) var<storage, read_write> results: array<f32>;

@compute @workgroup_size(64)
fn batch(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= count.x {
        return;
    }
    let job = jobs[id.x];
    let lobe = ltc_lobe(mat3x3f(job.m0.xyz, job.m1.xyz, job.m2.xyz));
    let c = job.corners;
    let two_sided = (job.flags.w & 256u) != 0u;
    results[id.x] = ltc_quad(lobe, c[0].xyz, c[1].xyz, c[2].xyz, c[3].xyz, two_sided);
}
