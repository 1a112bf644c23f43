// Flat lights of four corners. No bindings. Needs: math, precise, lobe, boundary, facing.
//
// Nearly every quad on a screen is plain: above the surface's horizon, not seen edge-on, not tiny, no edge near half a turn. For
// those, unit vectors and a rational function are as exact as f32 is. All others, and what the surface's horizon cuts, go the
// way that holds everywhere: products whose leading digits cancel are split, and the clip streams.

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
//#if surface_horizon
    let whole = lowest >= 0.0;
//#else
    const whole = true;
//#endif
    // Far beyond where rounding could change the side or the sum.
    let area = cross(c - a, d - b);
    let height = dot(area, a);
    let size = dot(area, area);
    if whole && size > 1e-6 && height * height > 1e-6 * size {
        if height > 0.0 && !two_sided {
            return 0.0;
        }
        let plain = ltc_quad_plain(lobe, a, b, c, d);
        if plain.holds {
            return clamp(select(plain.sum, -plain.sum, height < 0.0) / (2.0 * LTC_PI), 0.0, 1.0);
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

struct LtcPlain {
    // Up to the sign of the winding.
    sum: f32,
    // Whether it is as exact as the sum over a boundary.
    holds: bool,
}

// Edges whose cosine is below this are left to the boundary sum.
const LTC_PLAIN_COSINE: f32 = -0.95;

// The z component of the edge's integral, (a x b) theta / sin(theta), for unit vectors.
fn ltc_plain_edge(a: vec3f, b: vec3f, cosine: f32) -> f32 {
    let acute = ltc_angle_over_sine(abs(cosine));
    let obtuse = LTC_PI * inverseSqrt(max(1.0 - cosine * cosine, 0.01)) - acute;
    return (a.x * b.y - a.y * b.x) * select(acute, obtuse, cosine < 0.0);
}

// The sum over the edges of a quad that the surface's horizon does not cut (Heitz et al. 2016, eq. 11).
fn ltc_quad_plain(lobe: LtcLobe, v0: vec3f, v1: vec3f, v2: vec3f, v3: vec3f) -> LtcPlain {
    let none = LtcPlain(0.0, false);
    let p0 = ltc_cosine_from_target(lobe, v0);
    let p1 = ltc_cosine_from_target(lobe, v1);
    let p2 = ltc_cosine_from_target(lobe, v2);
    let p3 = ltc_cosine_from_target(lobe, v3);
    let squares = vec4f(dot(p0, p0), dot(p1, p1), dot(p2, p2), dot(p3, p3));
    if !(min(min(squares.x, squares.y), min(squares.z, squares.w)) > 1e-30) {
        return none;
    }
    let shrink = inverseSqrt(squares);
    let a = p0 * shrink.x;
    let b = p1 * shrink.y;
    let c = p2 * shrink.z;
    let d = p3 * shrink.w;
    let ab = dot(a, b);
    let bc = dot(b, c);
    let cd = dot(c, d);
    let da = dot(d, a);
    if min(min(ab, bc), min(cd, da)) < LTC_PLAIN_COSINE {
        return none;
    }
//#if cosine_horizon
    if min(min(a.z, b.z), min(c.z, d.z)) < 0.0 {
        return ltc_quad_plain_cut(a, b, c, d);
    }
//#endif
    let sum = ltc_plain_edge(a, b, ab) + ltc_plain_edge(b, c, bc) + ltc_plain_edge(c, d, cd) + ltc_plain_edge(d, a, da);
    return LtcPlain(sum, true);
}

//#if cosine_horizon
// The same of what is above the horizon of cosine space, of a quad that it cuts or hides.
fn ltc_quad_plain_cut(v0: vec3f, v1: vec3f, v2: vec3f, v3: vec3f) -> LtcPlain {
    var a = v0;
    var b = v1;
    var c = v2;
    var d = v3;
    // A dent may reach through the horizon twice: what closes it along the horizon would be in two parts.
    let crossed = (a.z >= 0.0) != (b.z >= 0.0) && (b.z >= 0.0) != (c.z >= 0.0) && (c.z >= 0.0) != (d.z >= 0.0);
    if crossed {
        return LtcPlain(0.0, false);
    }
    if max(max(a.z, b.z), max(c.z, d.z)) < 0.0 {
        return LtcPlain(0.0, true);
    }
    var sum = 0.0;
    var exit = vec3f(0.0);
    var entry = vec3f(0.0);
    for (var i = 0; i < 4; i++) {
        let a_above = a.z >= 0.0;
        let b_above = b.z >= 0.0;
        if a_above || b_above {
            var begin = a;
            var end = b;
            if a_above != b_above {
                // Never short: no edge is near half a turn.
                let chord = mix(a.xy, b.xy, abs(a.z) / (abs(a.z) + abs(b.z)));
                let cut = vec3f(chord * inverseSqrt(max(dot(chord, chord), 0.01)), 0.0);
                if a_above {
                    end = cut;
                    exit = cut;
                } else {
                    begin = cut;
                    entry = cut;
                }
            }
            sum += ltc_plain_edge(begin, end, dot(begin, end));
        }
        let moved = a;
        a = b;
        b = c;
        c = d;
        d = moved;
    }
    let closing = dot(exit, entry);
    return LtcPlain(sum + ltc_plain_edge(exit, entry, closing), closing >= LTC_PLAIN_COSINE);
}
//#endif
