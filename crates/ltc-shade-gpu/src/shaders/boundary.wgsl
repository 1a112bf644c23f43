// The boundary sum of a polygon: one vertex at a time, no arrays. No bindings. Needs: math, inverse.
//
// In cosine space, accumulates the integral of sin^2(theta) dphi along the boundary, where theta > pi / 2 counts as
// pi / 2. By Stokes' theorem this is 2 * integral of max(0, cos(theta)) over the inside, less 2 pi when the nadir is
// inside, up to the sign of the winding (Heitz et al. 2016, eq. 11, exact for any horizon). The edges are independent of
// each other: nothing need be closed along the horizon.

struct LtcBoundary {
    inverse: LtcInverse,
    first: vec3f,
    previous: vec3f,
    started: bool,
    sum: f32,
}

fn ltc_boundary(inverse: LtcInverse) -> LtcBoundary {
    return LtcBoundary(inverse, vec3f(0.0), vec3f(0.0), false, 0.0);
}

// Where the segment from p to q, whose ends lie on different sides of z = 0, crosses it.
fn ltc_horizon_point(p: vec3f, q: vec3f) -> vec3f {
    // abs(p.z) / abs(p.z - q.z), as the signs differ; the divisor cannot vanish.
    let t = min(abs(p.z) / max(abs(p.z) + abs(q.z), LTC_TINY), 1.0);
    let x = p + (q - p) * t;
    return vec3f(x.x, x.y, 0.0);
}

// The integral over an arc from unit vector a to b above the horizon: angle(a, b) * (a x b).z / |a x b|. Equal and
// antipodal ends span no plane and give 0.
fn ltc_edge_above(a: vec3f, b: vec3f) -> f32 {
    let normal = cross(a, b);
    let sine = length(normal);
    if !(sine > LTC_TINY) {
        return 0.0;
    }
    return ltc_atan2(sine, dot(a, b)) * (normal.z / sine);
}

// Azimuth from a to b, in [-pi, pi].
fn ltc_azimuth(a: vec3f, b: vec3f) -> f32 {
    return ltc_atan2(a.x * b.y - a.y * b.x, a.x * b.x + a.y * b.y);
}

// The integral over an arc from unit vector a to b, its part below the horizon dropped onto the horizon.
fn ltc_edge(a: vec3f, b: vec3f) -> f32 {
    let a_above = a.z >= 0.0;
    let b_above = b.z >= 0.0;
    var above_from = a;
    var above_to = b;
    var below = 0.0;
    if a_above != b_above {
        let x = ltc_horizon_point(a, b);
        above_from = select(x, a, a_above);
        above_to = select(x, b, b_above);
        below = ltc_azimuth(select(a, x, a_above), select(b, x, b_above));
    } else if !a_above {
        return ltc_azimuth(a, b);
    }
    return ltc_edge_above(above_from, above_to) + below;
}

// Adds a vertex, given in the lobe's space and already above the surface.
fn ltc_boundary_push(boundary: ptr<function, LtcBoundary>, vertex: vec3f) {
    let v = ltc_unit_or_zero(ltc_cosine_from_target((*boundary).inverse, vertex));
    // A vertex at the shading point has no direction: leaving it out is the limit of a corner that is cut off.
    if dot(v, v) < 0.5 {
        return;
    }
    if (*boundary).started {
        (*boundary).sum += ltc_edge((*boundary).previous, v);
    } else {
        (*boundary).first = v;
        (*boundary).started = true;
    }
    (*boundary).previous = v;
}

// Adds the part of the edge from p to q above the surface, z >= 0 in the shading frame, without its starting point
// (Sutherland-Hodgman). This is what keeps lights below the surface's horizon from leaking into a tilted lobe.
fn ltc_boundary_push_clipped(boundary: ptr<function, LtcBoundary>, p: vec3f, q: vec3f) {
    let q_above = q.z >= 0.0;
    if (p.z >= 0.0) != q_above {
        ltc_boundary_push(boundary, ltc_horizon_point(p, q));
    }
    if q_above {
        ltc_boundary_push(boundary, q);
    }
}

// The fraction of the lobe that sees the polygon, in [0, 1], once all edges are in. `facing` is above 0 when the
// shading point is in front of the polygon (see polygon.wgsl).
fn ltc_boundary_fraction(boundary: LtcBoundary, facing: f32) -> f32 {
    if !boundary.started || !boundary.inverse.valid {
        return 0.0;
    }
    let sum = boundary.sum + ltc_edge(boundary.previous, boundary.first);
    let turns = select(sum, -sum, facing > 0.0) / (2.0 * LTC_PI);
    // A flat polygon with the nadir inside covers at most half of the cosine, so it sums to [-1, -1/2]; without it, to
    // [0, 1]. Which of both is never in doubt, however much either is rounded.
    return clamp(select(turns, turns + 1.0, turns < -0.25), 0.0, 1.0);
}
