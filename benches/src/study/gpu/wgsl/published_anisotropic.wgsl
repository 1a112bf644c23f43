// KT et al. 2022, section 9: M and two Fresnel channels out of 3D textures, filtered in three dimensions by the texture unit and
// in the fourth by hand; symmetries by eq. 13 and 15; then M is inverted. Eleven channels are three textures, so six fetches.
// x = phi, y = theta, z = lambda + 8 alpha, all uniform.

@group(1) @binding(3) var published_0: texture_3d<f32>;
@group(1) @binding(4) var published_1: texture_3d<f32>;
@group(1) @binding(5) var published_2: texture_3d<f32>;
@group(1) @binding(6) var published_filter: sampler;

const PUBLISHED_NODES: f32 = 8.0;

fn published_inverse_of(m: mat3x3f) -> mat3x3f {
    let a = cross(m[1], m[2]);
    let b = cross(m[2], m[0]);
    let c = cross(m[0], m[1]);
    return transpose(mat3x3f(a, b, c)) * (1.0 / dot(m[0], a));
}

fn timed_find(p: TimedPixel) -> TimedFound {
    let theta = acos(clamp(p.wo.z, 0.0, 1.0));
    let swap = p.alpha_x < p.alpha_y;
    let folded = select(abs(p.wo.xy), abs(p.wo.yx), swap);
    let phi = atan2(folded.y, folded.x);
    let alpha = max(p.alpha_x, p.alpha_y);
    let lambda = min(p.alpha_x, p.alpha_y) / alpha;
    let last = PUBLISHED_NODES - 1.0;
    let along = clamp(alpha, 0.0, 1.0) * last;
    let cell = min(floor(along), last - 1.0);
    let t = along - cell;
    let plane = vec2f(phi, theta) * (last / 1.5707964);
    let depth = lambda * last + 0.5 + PUBLISHED_NODES * cell;
    let size = vec3f(PUBLISHED_NODES, PUBLISHED_NODES, PUBLISHED_NODES * PUBLISHED_NODES);
    let low = vec3f(plane + 0.5, depth) / size;
    let high = low + vec3f(0.0, 0.0, 1.0 / PUBLISHED_NODES);
    let g0 = mix(
        textureSampleLevel(published_0, published_filter, low, 0.0),
        textureSampleLevel(published_0, published_filter, high, 0.0), t);
    let g1 = mix(
        textureSampleLevel(published_1, published_filter, low, 0.0),
        textureSampleLevel(published_1, published_filter, high, 0.0), t);
    let g2 = mix(
        textureSampleLevel(published_2, published_filter, low, 0.0),
        textureSampleLevel(published_2, published_filter, high, 0.0), t);
    // Rows of M.
    var r0 = vec3f(g0.xyz);
    var r1 = vec3f(g0.w, g1.xy);
    let r2 = vec3f(g1.zw, g2.x);
    if swap {
        let exchanged = r0;
        r0 = r1;
        r1 = exchanged;
    }
    r0 *= select(1.0, -1.0, p.wo.x < 0.0);
    r1 *= select(1.0, -1.0, p.wo.y < 0.0);
    let m = transpose(mat3x3f(r0, r1, r2));
    return TimedFound(TimedLobe(published_inverse_of(m), m), timed_reflectance(g2.y, g2.z));
}
