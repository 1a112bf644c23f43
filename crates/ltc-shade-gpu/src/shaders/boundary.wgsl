// The boundary sum of a polygon: one vertex at a time, no arrays. No bindings. Needs: math, precise, lobe, an edge form.
//
// In cosine space, accumulates the integral of sin^2(theta) dphi along the boundary, where theta > pi / 2 counts as
// pi / 2. By Stokes' theorem this is 2 * integral of max(0, cos(theta)) over the inside, less 2 pi when the nadir is
// inside, up to the sign of the winding (Heitz et al. 2016, eq. 11, exact for any horizon). The edges are independent of
// each other: nothing need be closed along the horizon of cosine space. Along the surface's, an arc joins each exit to
// the next entry.

// A vertex as a direction: its length means nothing.
struct LtcCorner {
    // In the shading frame.
    surface: vec3f,
    // In cosine space.
    cosine: vec3f,
}

struct LtcBoundary {
    first: LtcCorner,
    previous: LtcCorner,
    started: bool,
//#if surface_horizon
    // The first entry and the last exit, on the surface's horizon.
    entry: LtcCorner,
    exit: LtcCorner,
    has_entry: bool,
    has_exit: bool,
//#endif
    sum: f32,
}

fn ltc_boundary() -> LtcBoundary {
    let none = LtcCorner(vec3f(0.0), vec3f(0.0));
//#if surface_horizon
    return LtcBoundary(none, none, false, none, none, false, false, 0.0);
//#else
    return LtcBoundary(none, none, false, 0.0);
//#endif
}

fn ltc_corner(lobe: LtcLobe, vertex: vec3f) -> LtcCorner {
    let surface = vertex * (1.0 / ltc_largest_component(vertex));
    return LtcCorner(surface, ltc_cosine_from_target(lobe, surface));
}

// Azimuth in [-pi, pi] from its sine and cosine.
fn ltc_azimuth(sine: f32, cosine: f32) -> f32 {
    return ltc_atan2(sine, cosine);
}

//#if cosine_horizon
// Products of a, above, and b, below, whose cross product is `normal`, with the point abs(b.z) * a + abs(a.z) * b between
// them on the horizon. It is also parallel to normal x z; of both forms the one that does not cancel is taken.
fn ltc_horizon_cosines(a: vec3f, b: vec3f, normal: vec3f, length: f32) -> vec2f {
    let steep = vec2f(a.x * normal.y - a.y * normal.x, b.x * normal.y - b.y * normal.x);
    let cosine = dot(a, b);
    let flat = vec2f(a.z * cosine - b.z * dot(a, a), a.z * dot(b, b) - b.z * cosine);
    return select(flat, steep, dot(normal.xy, normal.xy) > 0.01 * length * length);
}
//#endif

// The integral along the great circle from a to b, whose cross product is `normal` times `scale` > 0; its part below the
// horizon dropped onto the horizon. Equal and antipodal ends span no plane and give 0.
fn ltc_arc(a: vec3f, b: vec3f, normal: vec3f, scale: f32) -> f32 {
    let direction = ltc_unit_or_zero(normal);
    let length = dot(normal, direction) * scale;
    if !(length > 0.0) {
        return 0.0;
    }
//#if cosine_horizon
    let a_above = a.z >= 0.0;
    let b_above = b.z >= 0.0;
    if a_above != b_above {
        let upper = select(b, a, a_above);
        let lower = select(a, b, a_above);
        let oriented = select(-direction, direction, a_above);
        let along = ltc_horizon_cosines(upper, lower, oriented * length, length);
        let above = ltc_edge_angle(upper.z * length, along.x) * oriented.z;
        let below = ltc_azimuth(-lower.z * length * oriented.z, along.y);
        return select(-(above + below), above + below, a_above);
    }
    if !a_above {
        return ltc_azimuth(length * direction.z, dot(a.xy, b.xy));
    }
//#endif
    return ltc_edge_angle(length, dot(a, b)) * direction.z;
}

// The integral along the edge from a to b, nothing cut by the surface.
fn ltc_edge(lobe: LtcLobe, a: LtcCorner, b: LtcCorner, kept: f32) -> f32 {
    let normal = ltc_cosine_normal(lobe, ltc_cross(a.surface, b.surface));
    return ltc_arc(a.cosine, b.cosine, normal, lobe.area_scale * kept);
}

//#if surface_horizon
// Where the arc from a to b crosses the surface's horizon.
fn ltc_horizon_corner(a: LtcCorner, b: LtcCorner) -> LtcCorner {
    let to_b = abs(b.surface.z);
    let to_a = abs(a.surface.z);
    let point = a.surface * to_b + b.surface * to_a;
    return LtcCorner(vec3f(point.xy, 0.0), a.cosine * to_b + b.cosine * to_a);
}

// The arc from `exit` to `entry` along the surface's horizon.
fn ltc_boundary_close(lobe: LtcLobe, exit: LtcCorner, entry: LtcCorner) -> f32 {
    let up = ltc_cross(exit.surface, entry.surface).z;
    return ltc_arc(exit.cosine, entry.cosine, ltc_cosine_normal(lobe, vec3f(0.0, 0.0, up)), lobe.area_scale);
}
//#endif

// Adds the edge from a to b, cut by the surface's horizon: what keeps lights below it from leaking into a tilted lobe.
fn ltc_boundary_edge(boundary: ptr<function, LtcBoundary>, lobe: LtcLobe, a: LtcCorner, b: LtcCorner) {
//#if surface_horizon
    let a_above = a.surface.z >= 0.0;
    let b_above = b.surface.z >= 0.0;
    if !(a_above || b_above) {
        return;
    }
    let normal = ltc_cosine_normal(lobe, ltc_cross(a.surface, b.surface));
    var begin = a.cosine;
    var to = b.cosine;
    var kept = 1.0;
    if a_above != b_above {
        let point = ltc_horizon_corner(a, b);
        if a_above {
            to = point.cosine;
            kept = a.surface.z;
            (*boundary).exit = point;
            (*boundary).has_exit = true;
        } else {
            begin = point.cosine;
            kept = b.surface.z;
            if (*boundary).has_exit {
                (*boundary).sum += ltc_boundary_close(lobe, (*boundary).exit, point);
                (*boundary).has_exit = false;
            } else {
                (*boundary).entry = point;
                (*boundary).has_entry = true;
            }
        }
    }
    (*boundary).sum += ltc_arc(begin, to, normal, lobe.area_scale * kept);
//#else
    (*boundary).sum += ltc_edge(lobe, a, b, 1.0);
//#endif
}

// Adds a vertex. One at the shading point has no direction: leaving it out is the limit of a corner that is cut off.
fn ltc_boundary_push(boundary: ptr<function, LtcBoundary>, lobe: LtcLobe, vertex: vec3f) {
    if !(ltc_largest_component(vertex) > LTC_TINY) {
        return;
    }
    let corner = ltc_corner(lobe, vertex);
    if (*boundary).started {
        ltc_boundary_edge(boundary, lobe, (*boundary).previous, corner);
    } else {
        (*boundary).first = corner;
        (*boundary).started = true;
    }
    (*boundary).previous = corner;
}

// The sum over all edges, closed.
fn ltc_boundary_finish(boundary: ptr<function, LtcBoundary>, lobe: LtcLobe) -> f32 {
    if !(*boundary).started {
        return 0.0;
    }
    ltc_boundary_edge(boundary, lobe, (*boundary).previous, (*boundary).first);
//#if surface_horizon
    if (*boundary).has_exit && (*boundary).has_entry {
        (*boundary).sum += ltc_boundary_close(lobe, (*boundary).exit, (*boundary).entry);
    }
//#endif
    return (*boundary).sum;
}

// The integral over the inside, as a fraction, from the sum of a flat outline that winds positively, before it is clamped.
fn ltc_fraction_of_sum(sum: f32) -> f32 {
    let turns = sum / (2.0 * LTC_PI);
//#if cosine_horizon
    // With the nadir inside a flat outline covers at most half of the cosine, so it sums to [-1, -1/2]; without it, to
    // [0, 1]. Which of both is never in doubt, however much either is rounded.
    return select(turns, turns + 1.0, turns < -0.25);
//#else
    return turns;
//#endif
}
