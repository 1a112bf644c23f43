// Flat lights of four corners. No bindings. Needs: math, precise, lobe, boundary, facing, quad_arcs.
//
// Nearly every quad on a screen is plain: not seen edge-on, not tiny, no edge near half a turn, no dent through a horizon. For those
// straight code over arcs is as exact as f32 is. All others go the way that holds everywhere: products whose leading digits cancel are
// split, and the clip streams.

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
    // Far beyond where rounding could change the side or the sum.
    let area = cross(c - a, d - b);
    let height = dot(area, a);
    let size = dot(area, area);
    if size > 1e-6 && height * height > 1e-6 * size {
        if height > 0.0 && !two_sided {
            return 0.0;
        }
        let arcs = ltc_quad_arcs(lobe, a, b, c, d);
        if !arcs.half_turn && max(arcs.crossings.x, arcs.crossings.y) <= 2.0 {
            return clamp(select(arcs.sum, -arcs.sum, height < 0.0) / (2.0 * LTC_PI), 0.0, 1.0);
        }
    }
    // The two terms of Newell's sum in one: the cross product of the diagonals.
    let facing = ltc_facing(ltc_cross(c - a, d - b), a, 1.0);
    if !ltc_emits_towards(facing, two_sided) {
        return 0.0;
    }
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
    let sum = ltc_boundary_finish(&boundary, lobe);
    return clamp(ltc_fraction_of_sum(select(sum, -sum, facing > 0.0)), 0.0, 1.0);
}
