// Flat lights of four corners. No bindings. Needs: math, precise, lobe, boundary, facing.
//
// Whether a horizon cuts is asked of all corners at once: a quad above both pays four comparisons each and one angle an
// edge; one below is left at once; only what the surface's horizon cuts goes through the streaming clip.

// The fraction of the lobe that sees the quad, in [0, 1]; corners counter-clockwise seen from the emitting side, relative to
// the shading point in the shading frame. Zero for a degenerate quad, for a shading point in its plane, and behind a
// one-sided one.
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
//#if surface_horizon
    let lowest = min(min(v0.z, v1.z), min(v2.z, v3.z));
    let sunk = max(max(v0.z, v1.z), max(v2.z, v3.z)) <= 0.0;
    if sunk || !(scale > LTC_TINY && lobe.valid) {
        return 0.0;
    }
//#else
    if !(scale > LTC_TINY && lobe.valid) {
        return 0.0;
    }
//#endif
    var a = v0 / scale;
    var b = v1 / scale;
    var c = v2 / scale;
    var d = v3 / scale;
    // The two terms of Newell's sum in one: the cross product of the diagonals.
    let facing = ltc_facing(ltc_cross(c - a, d - b), a, 1.0);
    if !ltc_emits_towards(facing, two_sided) {
        return 0.0;
    }
    var sum = 0.0;
//#if surface_horizon
    if lowest < 0.0 {
        var boundary = ltc_boundary();
        // The corners move through four registers, so that none is indexed and the edge's code stands here once.
        for (var i = 0; i < 4; i++) {
            ltc_boundary_push(&boundary, lobe, a);
            let moved = a;
            a = b;
            b = c;
            c = d;
            d = moved;
        }
        sum = ltc_boundary_finish(&boundary, lobe);
    } else {
        sum = ltc_quad_above(lobe, a, b, c, d);
    }
//#else
    sum = ltc_quad_above(lobe, a, b, c, d);
//#endif
    return clamp(ltc_fraction_of_sum(select(sum, -sum, facing > 0.0)), 0.0, 1.0);
}

// The boundary sum of a quad that the surface's horizon does not cut.
fn ltc_quad_above(lobe: LtcLobe, v0: vec3f, v1: vec3f, v2: vec3f, v3: vec3f) -> f32 {
    var a = v0;
    var b = v1;
    var c = v2;
    var d = v3;
    var sum = 0.0;
    var begin = ltc_cosine_from_target(lobe, a);
    for (var i = 0; i < 4; i++) {
        let to = ltc_cosine_from_target(lobe, b);
        sum += ltc_arc(begin, to, ltc_cosine_normal(lobe, ltc_cross(a, b)), lobe.area_scale);
        begin = to;
        let moved = a;
        a = b;
        b = c;
        c = d;
        d = moved;
    }
    return sum;
}
