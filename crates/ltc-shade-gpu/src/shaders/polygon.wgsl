// Flat polygonal lights. No bindings. Needs: math, inverse, boundary.
//
// Vertices are relative to the shading point, in the shading frame, counter-clockwise seen from the emitting side.

fn ltc_emits_towards(facing: f32, two_sided: bool) -> bool {
    return facing > 0.0 || (two_sided && facing < 0.0);
}

// The term of vertices b, c in Newell's vector area about `first`, to be summed over b, c = the vertices 1, 2; 2, 3; …
// About the first vertex distant lights keep their digits.
fn ltc_area_term(first: vec3f, b: vec3f, c: vec3f) -> vec3f {
    return cross(b - first, c - first);
}

// Proportional to the distance of the shading point in front of the polygon's plane, from its vector area and first
// vertex, coordinates scaled to at most 1; exactly 0 where rounding decides the side: within 8 epsilon of the farthest
// vertex's distance.
fn ltc_facing(area: vec3f, first: vec3f) -> f32 {
    let facing = -dot(area, first);
    return select(0.0, facing, abs(facing) > 9.5367432e-7 * length(area));
}

// The fraction of the lobe that sees the quad, in [0, 1]. Zero for a degenerate quad, for a shading point in its plane,
// and behind a one-sided one.
fn ltc_quad(inverse: LtcInverse, v0: vec3f, v1: vec3f, v2: vec3f, v3: vec3f, two_sided: bool) -> f32 {
    let scale = max(
        max(ltc_largest_component(v0), ltc_largest_component(v1)),
        max(ltc_largest_component(v2), ltc_largest_component(v3)),
    );
    if !(scale > LTC_TINY) {
        return 0.0;
    }
    var a = v0 / scale;
    var b = v1 / scale;
    var c = v2 / scale;
    var d = v3 / scale;
    // The two terms of Newell's sum in one: half the cross product of the diagonals.
    let facing = ltc_facing(cross(c - a, d - b), a);
    if !ltc_emits_towards(facing, two_sided) {
        return 0.0;
    }
    var boundary = ltc_boundary(inverse);
    // The vertices move through four registers, so that none is indexed and the edge's code stands here once.
    for (var i = 0; i < 4; i++) {
        ltc_boundary_push_clipped(&boundary, d, a);
        let moved = a;
        a = b;
        b = c;
        c = d;
        d = moved;
    }
    return ltc_boundary_fraction(boundary, facing);
}
