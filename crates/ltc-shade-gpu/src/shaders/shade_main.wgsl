// Entry point: deferred shading of a G-buffer, one invocation a surface point. Needs: shade.

// Numbers of points and of lights.
@group(1) @binding(0) var<uniform> counts: vec4u;
@group(1) @binding(1) var<storage, read> points: array<SurfacePoint>;
@group(1) @binding(2) var<storage, read> lights: array<LightRecord>;
@group(1) @binding(3) var<storage, read> light_vertices: array<vec4f>;
@group(1) @binding(4) var<storage, read_write> radiance: array<vec4f>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= counts.x {
        return;
    }
    radiance[id.x] = vec4f(shade(points[id.x], counts.y), 0.0);
}
