// Entry points: a batch of polygons, each under a lobe of its own. Needs: polygon.

struct PolygonJob {
    // Columns of target_from_cosine.
    m0: vec3f,
    two_sided: u32,
    m1: vec3f,
    first_vertex: u32,
    m2: vec3f,
    vertex_count: u32,
}

@group(0) @binding(0) var<uniform> job_count: vec4u;
@group(0) @binding(1) var<storage, read> jobs: array<PolygonJob>;
@group(0) @binding(2) var<storage, read> vertices: array<vec4f>;
@group(0) @binding(3) var<storage, read_write> results: array<f32>;

fn job_inverse(job: PolygonJob) -> LtcInverse {
    return ltc_inverse(mat3x3f(job.m0, job.m1, job.m2));
}

@compute @workgroup_size(64)
fn quads(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= job_count.x {
        return;
    }
    let job = jobs[id.x];
    let at = job.first_vertex;
    results[id.x] = ltc_quad(
        job_inverse(job),
        vertices[at].xyz,
        vertices[at + 1u].xyz,
        vertices[at + 2u].xyz,
        vertices[at + 3u].xyz,
        job.two_sided != 0u,
    );
}

// The largest magnitude of a coordinate of the polygon.
fn polygon_scale(job: PolygonJob) -> f32 {
    var scale = 0.0;
    for (var i = 0u; i < job.vertex_count; i++) {
        scale = max(scale, ltc_largest_component(vertices[job.first_vertex + i].xyz));
    }
    return scale;
}

fn polygon_facing(job: PolygonJob, scale: f32) -> f32 {
    let first = vertices[job.first_vertex].xyz / scale;
    var area = vec3f(0.0);
    var previous = vertices[job.first_vertex + 1u].xyz / scale;
    for (var i = 2u; i < job.vertex_count; i++) {
        let vertex = vertices[job.first_vertex + i].xyz / scale;
        area += ltc_area_term(first, previous, vertex);
        previous = vertex;
    }
    return ltc_facing(area, first);
}

fn polygon_fraction(job: PolygonJob) -> f32 {
    let scale = polygon_scale(job);
    if !(scale > LTC_TINY) {
        return 0.0;
    }
    let facing = polygon_facing(job, scale);
    if !ltc_emits_towards(facing, job.two_sided != 0u) {
        return 0.0;
    }
    var boundary = ltc_boundary(job_inverse(job));
    var previous = vertices[job.first_vertex + job.vertex_count - 1u].xyz / scale;
    for (var i = 0u; i < job.vertex_count; i++) {
        let vertex = vertices[job.first_vertex + i].xyz / scale;
        ltc_boundary_push_clipped(&boundary, previous, vertex);
        previous = vertex;
    }
    return ltc_boundary_fraction(boundary, facing);
}

@compute @workgroup_size(64)
fn polygons(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= job_count.x {
        return;
    }
    results[id.x] = polygon_fraction(jobs[id.x]);
}
