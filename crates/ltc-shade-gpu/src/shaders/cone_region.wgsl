// An elliptical cone cut by up to three planes through its apex, and the cosine's integral over it. No bindings.
// Needs: math, cone_arc.
//
// The boundary is cut plane after plane (Sutherland-Hodgman), so that it stays closed however its corners are rounded; a
// piece goes through all cuts before the next one does, so that no list of them is kept.

// A half-space, in the cone's axes.
struct LtcHalfSpace {
    // Unit normal.
    normal: vec3f,
    // The same as dot(linear, (x, y, 1)) >= 0 in the coordinates that make the cone's ellipse the unit circle.
    linear: vec3f,
    // Where the circle enters the half-space and where it leaves it.
    entry: vec2f,
    exit: vec2f,
    // LTC_CUTS, LTC_KEEPS_ALL or LTC_KEEPS_NOTHING of the circle.
    effect: u32,
}

const LTC_KEEPS_ALL: u32 = 0u;
const LTC_CUTS: u32 = 1u;
const LTC_KEEPS_NOTHING: u32 = 2u;

// A corner of the boundary, and what follows it: LTC_ARC, counter-clockwise, or the chord of the half-space of this number.
struct LtcPiece {
    // On the unit circle, or within.
    at: vec2f,
    // Towards it, in the cone's axes.
    direction: vec3f,
    along: u32,
}

const LTC_ARC: u32 = 3u;

struct LtcRegion {
    widths: vec2f,
    // What is integrated is the product with this, in the cone's axes.
    up: vec3f,
    plane_0: LtcHalfSpace,
    plane_1: LtcHalfSpace,
    plane_2: LtcHalfSpace,
}

fn ltc_half_space(widths: vec2f, normal: vec3f) -> LtcHalfSpace {
    let g = vec3f(widths * normal.xy, normal.z);
    let radius = length(g.xy);
    // Closer to touching than this only rounding tells.
    let limit = radius * 0.99999952;
    if g.z >= limit {
        return LtcHalfSpace(normal, g, vec2f(0.0), vec2f(0.0), LTC_KEEPS_ALL);
    }
    if g.z <= -limit {
        return LtcHalfSpace(normal, g, vec2f(0.0), vec2f(0.0), LTC_KEEPS_NOTHING);
    }
    let m = g.xy / radius;
    let cosine = -g.z / radius;
    let sine = sqrt(max((radius - g.z) * (radius + g.z), 0.0)) / radius;
    let middle = m * cosine;
    let aside = vec2f(m.y, -m.x) * sine;
    return LtcHalfSpace(normal, g, middle + aside, middle - aside, LTC_CUTS);
}

fn ltc_keep_all() -> LtcHalfSpace {
    return LtcHalfSpace(vec3f(0.0, 0.0, 1.0), vec3f(0.0, 0.0, 1.0), vec2f(0.0), vec2f(0.0), LTC_KEEPS_ALL);
}

// A position on the circle that grows with the angle, by 1 for each quarter, in [0, 4).
fn ltc_turn(at: vec2f) -> f32 {
    let ratio = at.x / max(abs(at.x) + abs(at.y), LTC_TINY);
    return select(3.0 + ratio, 1.0 - ratio, at.y >= 0.0);
}

// How far counter-clockwise from `from` to `to`, in [0, 4).
fn ltc_ahead(begin: vec2f, to: vec2f) -> f32 {
    let d = ltc_turn(to) - ltc_turn(begin);
    return select(d, d + 4.0, d < 0.0);
}

fn ltc_on_circle(region: LtcRegion, at: vec2f, along: u32) -> LtcPiece {
    return LtcPiece(at, vec3f(region.widths * at, 1.0), along);
}

fn ltc_plane(region: LtcRegion, number: u32) -> LtcHalfSpace {
    if number == 0u {
        return region.plane_0;
    }
    if number == 1u {
        return region.plane_1;
    }
    return region.plane_2;
}

// What a cut leaves of a piece.
struct LtcCut {
    count: u32,
    first: LtcPiece,
    second: LtcPiece,
    third: LtcPiece,
}

// Where a chord crosses another plane: along the planes' common line, which rounding does not move.
fn ltc_chord_corner(region: LtcRegion, plane: u32, start: LtcPiece, end: LtcPiece, begin: f32, to: f32) -> LtcPiece {
    let at = mix(start.at, end.at, begin / (begin - to));
    let shared_line = cross(ltc_plane(region, start.along).normal, ltc_plane(region, plane).normal);
    let along_line = length(shared_line) > 7.6e-6;
    let direction = select(vec3f(region.widths * at, 1.0), select(-shared_line, shared_line, begin >= 0.0), along_line);
    return LtcPiece(at, direction, select(start.along, plane, begin >= 0.0));
}

// The vertex, or the nearer end of the arc where rounding has put it beyond.
fn ltc_within(vertex: vec2f, ahead: f32, start: vec2f, end: vec2f, length: f32) -> vec2f {
    if ahead <= length {
        return vertex;
    }
    return select(start, end, ahead - length < 4.0 - ahead);
}

fn ltc_cut_piece(region: LtcRegion, plane: u32, start: LtcPiece, end: LtcPiece) -> LtcCut {
    let half_space = ltc_plane(region, plane);
    if half_space.effect == LTC_KEEPS_ALL {
        return LtcCut(1u, start, start, start);
    }
    if half_space.effect == LTC_KEEPS_NOTHING {
        return LtcCut(0u, start, start, start);
    }
    let begin = dot(half_space.linear, vec3f(start.at, 1.0));
    let to = dot(half_space.linear, vec3f(end.at, 1.0));
    let starts_in = begin >= 0.0;
    let ends_in = to >= 0.0;
    if start.along != LTC_ARC {
        if starts_in == ends_in {
            return LtcCut(select(0u, 1u, starts_in), start, start, start);
        }
        let corner = ltc_chord_corner(region, plane, start, end, begin, to);
        if starts_in {
            return LtcCut(2u, start, corner, corner);
        }
        return LtcCut(1u, corner, corner, corner);
    }
    let length = ltc_ahead(start.at, end.at);
    let to_entry = ltc_ahead(start.at, half_space.entry);
    let to_exit = ltc_ahead(start.at, half_space.exit);
    let entry = ltc_on_circle(region, half_space.entry, LTC_ARC);
    let exit = ltc_on_circle(region, half_space.exit, plane);
    if starts_in && ends_in {
        let bites = to_exit < to_entry && to_entry < length;
        return LtcCut(select(1u, 3u, bites), start, exit, entry);
    }
    if starts_in {
        let at = ltc_within(half_space.exit, to_exit, start.at, end.at, length);
        return LtcCut(2u, start, ltc_on_circle(region, at, plane), start);
    }
    if ends_in {
        let at = ltc_within(half_space.entry, to_entry, start.at, end.at, length);
        return LtcCut(1u, ltc_on_circle(region, at, LTC_ARC), start, start);
    }
    let pokes = to_entry < to_exit && to_exit < length;
    return LtcCut(select(0u, 2u, pokes), entry, exit, start);
}

// Pieces on their way: each waits for the next one's start, which is its end.
struct LtcTrail {
    first: LtcPiece,
    previous: LtcPiece,
    started: bool,
}

fn ltc_trail() -> LtcTrail {
    let none = LtcPiece(vec2f(0.0), vec3f(0.0), LTC_ARC);
    return LtcTrail(none, none, false);
}

// The piece that now has its end, if there is one.
fn ltc_trail_step(trail: ptr<function, LtcTrail>, next: LtcPiece) -> bool {
    let ready = (*trail).started;
    if !ready {
        (*trail).first = next;
        (*trail).started = true;
    }
    return ready;
}

fn ltc_piece_integral(region: LtcRegion, start: LtcPiece, end: LtcPiece) -> f32 {
    if start.along == LTC_ARC {
        return ltc_ellipse_arc(region.widths, region.up, start.at, end.at, ltc_ahead(start.at, end.at));
    }
    let normal = ltc_plane(region, start.along).normal;
    return ltc_angle_around(normal, start.direction, end.direction) * dot(normal, region.up);
}

// What the cut by the last plane leaves of a piece goes to the sum.
fn ltc_add_last(region: LtcRegion, trail: ptr<function, LtcTrail>, start: LtcPiece, end: LtcPiece) -> f32 {
    let cut = ltc_cut_piece(region, 2u, start, end);
    var sum = 0.0;
    for (var i = 0u; i < cut.count; i++) {
        var piece = cut.first;
        if i == 1u {
            piece = cut.second;
        } else if i == 2u {
            piece = cut.third;
        }
        if ltc_trail_step(trail, piece) {
            sum += ltc_piece_integral(region, (*trail).previous, piece);
        }
        (*trail).previous = piece;
    }
    return sum;
}

// Whether no plane cuts, and `ltc_region_integral` is not for it.
fn ltc_region_whole(region: LtcRegion) -> bool {
    return region.plane_0.effect == LTC_KEEPS_ALL && region.plane_1.effect == LTC_KEEPS_ALL
        && region.plane_2.effect == LTC_KEEPS_ALL;
}

// The integral of w.up / pi over the region, by Stokes' theorem: half the sum of the integrals of (r x dr).up / |r|^2 along the
// boundary, over pi. At least one plane must cut; plane 0 cuts whenever another one does.
fn ltc_region_integral(region: LtcRegion) -> f32 {
    let nothing = region.plane_0.effect == LTC_KEEPS_NOTHING || region.plane_1.effect == LTC_KEEPS_NOTHING
        || region.plane_2.effect == LTC_KEEPS_NOTHING;
    if nothing || region.plane_0.effect == LTC_KEEPS_ALL {
        return 0.0;
    }
    let entry = ltc_on_circle(region, region.plane_0.entry, LTC_ARC);
    let exit = ltc_on_circle(region, region.plane_0.exit, 0u);
    var after_1 = ltc_trail();
    var after_2 = ltc_trail();
    var sum = 0.0;
    // The arc, the chord, and what closes the outline: one loop, so that the code of a cut stands here once.
    for (var side = 0; side < 3; side++) {
        var cut = LtcCut(select(0u, 1u, after_1.started), after_1.first, after_1.first, after_1.first);
        if side < 2 {
            var start = entry;
            var end = exit;
            if side == 1 {
                start = exit;
                end = entry;
            }
            cut = ltc_cut_piece(region, 1u, start, end);
        }
        for (var i = 0u; i < cut.count; i++) {
            var piece = cut.first;
            if i == 1u {
                piece = cut.second;
            } else if i == 2u {
                piece = cut.third;
            }
            if ltc_trail_step(&after_1, piece) {
                sum += ltc_add_last(region, &after_2, after_1.previous, piece);
            }
            after_1.previous = piece;
        }
    }
    if after_2.started {
        sum += ltc_piece_integral(region, after_2.previous, after_2.first);
    }
    return sum / (2.0 * LTC_PI);
}
