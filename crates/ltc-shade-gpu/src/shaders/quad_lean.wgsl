// Flat convex lights of four corners, by one loop over arcs. No bindings. Needs: math, lobe, edge.
//
// The integral is that of `quad`, cut by the same horizons. What it leaves out is care for what is rare: an arc is good to some 1e-7 of
// the whole lobe, however small the light, so that tiny lights keep fewer digits; and a shading point in the light's plane is given
// what one of its sides sees, or nothing.

struct LtcLeanSum {
    sum: f32,
    // Where the outline goes below the surface's horizon, and where it comes back.
    exit: vec3f,
    entry: vec3f,
    // The same of the horizon of cosine space.
    cosine_exit: vec3f,
    cosine_entry: vec3f,
}

// Adds the arc from `a` along `edge`, in cosine space, whose ends have these heights above the surface.
fn ltc_lean_add(sum: ptr<function, LtcLeanSum>, a: vec3f, edge: vec3f, heights: vec2f) {
    var part = vec2f(0.0, 1.0);
    var hidden = false;
//#if surface_horizon
    let sunk = heights < vec2f(0.0);
    hidden = sunk.x && sunk.y;
    if sunk.x != sunk.y {
        let at = heights.x / (heights.x - heights.y);
        if sunk.x {
            part.x = at;
            (*sum).entry = a + at * edge;
        } else {
            part.y = at;
            (*sum).exit = a + at * edge;
        }
    }
//#endif
//#if cosine_horizon
    let lifted = a.zz + part * edge.z;
    let below = lifted < vec2f(0.0);
    if below.x != below.y && !hidden {
        let at = mix(part.x, part.y, lifted.x / (lifted.x - lifted.y));
        let cut = vec3f(a.xy + at * edge.xy, 0.0);
        if below.x {
            part.x = at;
            (*sum).cosine_entry = cut;
        } else {
            part.y = at;
            (*sum).cosine_exit = cut;
        }
    }
    hidden = hidden || (below.x && below.y);
//#endif
    let begin = a + part.x * edge;
    let end = a + part.y * edge;
    let shrink = inverseSqrt(max(dot(begin, begin) * dot(end, end), 1e-36));
    // Of begin and end, without their common part.
    let normal = cross(a, edge) * ((part.y - part.x) * shrink);
    let cosine = dot(begin, end) * shrink;
    let acute = ltc_angle_over_sine(abs(cosine));
    let obtuse = LTC_PI * inverseSqrt(max(dot(normal, normal), 1e-12)) - acute;
    (*sum).sum += select(normal.z * select(acute, obtuse, cosine < 0.0), 0.0, hidden);
}

// The fraction of the lobe that sees the quad, in [0, 1]; corners counter-clockwise seen from the emitting side, relative to the
// shading point in the shading frame, no angle between them above half a turn. Zero for a degenerate quad and behind a one-sided one.
fn ltc_quad(
    lobe: LtcLobe,
    v0: vec3f,
    v1: vec3f,
    v2: vec3f,
    v3: vec3f,
//#if two_sided
    two_sided: bool,
//#endif
) -> f32 {
//#ifnot two_sided
    const two_sided = false;
//#endif
    let scale = max(
        max(ltc_largest_component(v0), ltc_largest_component(v1)),
        max(ltc_largest_component(v2), ltc_largest_component(v3)),
    );
    var heights = vec4f(v0.z, v1.z, v2.z, v3.z);
    if !(scale > LTC_TINY && lobe.valid) {
        return 0.0;
    }
//#if surface_horizon
    if max(max(heights.x, heights.y), max(heights.z, heights.w)) <= 0.0 {
        return 0.0;
    }
//#endif
    let shrink = 1.0 / scale;
    // A corner and the way to the next, in cosine space. They move through registers, so that none is indexed and the arc's code stands
    // here once.
    var a = ltc_cosine_from_target(lobe, v0 * shrink);
    var edge = ltc_cosine_from_target(lobe, (v1 - v0) * shrink);
    var edge_1 = ltc_cosine_from_target(lobe, (v2 - v1) * shrink);
    var edge_2 = ltc_cosine_from_target(lobe, (v3 - v2) * shrink);
    var edge_3 = ltc_cosine_from_target(lobe, (v0 - v3) * shrink);
    var arcs = 4;
    let lowest = min(min(a.z, a.z + edge.z), min(a.z - edge_3.z, a.z + edge.z + edge_1.z));
    if min(lowest, min(min(heights.x, heights.y), min(heights.z, heights.w))) < 0.0 {
        arcs = 6;
    }
    let none = vec3f(0.0);
    var sum = LtcLeanSum(0.0, none, none, none, none);
    for (var i = 0; i < arcs; i++) {
        ltc_lean_add(&sum, a, edge, heights.xy);
        a += edge;
        edge = edge_1;
        edge_1 = edge_2;
        edge_2 = edge_3;
        heights = heights.yzwx;
        if i == 3 {
            // Along the surface's horizon, from where the outline went below to where it came back,
            a = sum.exit;
            edge = sum.entry - sum.exit;
            heights = vec4f(0.0);
        }
        if i == 4 {
            // and along that of cosine space.
            a = sum.cosine_exit;
            edge = sum.cosine_entry - sum.cosine_exit;
        }
    }
    let seen = select(-sum.sum, abs(sum.sum), two_sided);
    return clamp(seen / (2.0 * LTC_PI), 0.0, 1.0);
}
