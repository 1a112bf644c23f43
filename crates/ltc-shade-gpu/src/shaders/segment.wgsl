// A straight segment seen from the shading point, and the integral along it that all thin lights share (Heitz and Hill 2017,
// eq. 1.20 to 1.26, in a form that cancels nowhere). No bindings. Needs: math, precise, lobe.
//
// Straight code but for what is rare. Of lean lights that is left out: a segment seen from nearly along itself, or cut by a horizon next to
// the shading point, keeps fewer digits.

struct LtcSegment {
    // Over a power of two near the farther end's distance.
    p0: vec3f,
    p1: vec3f,
    // A normal of the plane through both ends and the shading point: p0 x p1 = normal * moment.
    normal: vec3f,
    // 1, but where the square of p0 x p1 would be very small.
    moment: f32,
    // Scaled lengths per length.
    shrink: f32,
    // False for a segment that spans no angle: of no length, on a ray from the shading point, or through it.
    valid: bool,
}

//#ifnot lean_lights
const LTC_SMALL_SQUARE: f32 = 1e-24;
//#endif

fn ltc_segment(p0: vec3f, p1: vec3f) -> LtcSegment {
    let scale = ltc_floor_power_of_two(max(ltc_largest_component(p0), ltc_largest_component(p1)));
//#if lean_lights
    let shrink = 1.0 / max(scale, LTC_TINY);
    let a = p0 * shrink;
    let b = p1 * shrink;
    let product = cross(a, b - a);
    return LtcSegment(a, b, product, 1.0, shrink, dot(product, product) > 0.0);
//#else
    if !(scale > LTC_TINY) {
        return LtcSegment(p0, p1, vec3f(0.0), 1.0, 1.0, false);
    }
    let shrink = 1.0 / scale;
    let a = p0 * shrink;
    let b = p1 * shrink;
    // Two degrees apart, the plain product loses nothing that matters.
    let plain = cross(a, b);
    if dot(plain, plain) > 1e-3 * dot(a, a) * dot(b, b) && dot(plain, plain) >= LTC_SMALL_SQUARE {
        return LtcSegment(a, b, plain, 1.0, shrink, true);
    }
    let product = ltc_cross(a, b);
    if dot(product, product) >= LTC_SMALL_SQUARE {
        return LtcSegment(a, b, product, 1.0, shrink, true);
    }
    let unit = ltc_unit_or_zero(product);
    return LtcSegment(a, b, unit, dot(product, unit), shrink, dot(unit, unit) > 0.5);
//#endif
}

// Unit vector from the shading point towards the nearest point of the line.
fn ltc_towards_line(segment: LtcSegment) -> vec3f {
    return ltc_unit_or_zero(cross(segment.p1 - segment.p0, segment.normal));
}

// What is left of a segment above the horizons, in cosine space.
struct LtcKept {
    q0: vec3f,
    q1: vec3f,
    // Of q0 x q1 over that of the whole segment; 0 where nothing is left.
    share: f32,
}

//#if lean_lights
// `q` is the segment's first end, `along` from there to the other.
fn ltc_kept(segment: LtcSegment, q: vec3f, along: vec3f) -> LtcKept {
    var part = vec2f(0.0, 1.0);
    var hidden = false;
//#if surface_horizon
    let heights = vec2f(segment.p0.z, segment.p1.z);
    let sunk = heights < vec2f(0.0);
    let sinks = sunk.x != sunk.y;
    let at = heights.x / select(1.0, heights.x - heights.y, sinks);
    part = vec2f(select(0.0, at, sunk.x & sinks), select(1.0, at, sunk.y & sinks));
    hidden = max(heights.x, heights.y) <= 0.0;
//#endif
//#if cosine_horizon
    let lifted = q.zz + part * along.z;
    let below = lifted < vec2f(0.0);
    let sets = below.x != below.y;
    let place = part.x + (part.y - part.x) * (lifted.x / select(1.0, lifted.x - lifted.y, sets));
    part = vec2f(select(part.x, place, below.x & sets), select(part.y, place, below.y & sets));
    hidden = hidden | (max(lifted.x, lifted.y) <= 0.0);
//#endif
    return LtcKept(q + part.x * along, q + part.y * along, select(part.y - part.x, 0.0, hidden));
}
//#else
// Moves the end that lies below z = 0, if any, onto it. The moment p0 x p1 says where: the point is
// (z x moment) / (z1 - z0), which cancels nowhere.
fn ltc_clip_above(p0: vec3f, p1: vec3f, moment: vec3f) -> LtcKept {
    let sunk = vec2f(p0.z, p1.z) < vec2f(0.0);
    let crosses = sunk.x != sunk.y;
    let inverse_rise = 1.0 / select(1.0, p1.z - p0.z, crosses);
    let crossing = vec3f(-moment.y * inverse_rise, moment.x * inverse_rise, 0.0);
    let kept = select(-p0.z, p1.z, sunk.x) * inverse_rise;
    let share = select(select(1.0, kept, crosses), 0.0, max(p0.z, p1.z) <= 0.0);
    return LtcKept(select(p0, crossing, sunk.x & crosses), select(p1, crossing, sunk.y & crosses), share);
}

// `moment` is that of the whole segment in cosine space.
fn ltc_kept(segment: LtcSegment, lobe: LtcLobe, moment: vec3f) -> LtcKept {
    var kept = LtcKept(segment.p0, segment.p1, 1.0);
//#if surface_horizon
    kept = ltc_clip_above(segment.p0, segment.p1, segment.normal * segment.moment);
//#endif
    kept = LtcKept(ltc_cosine_from_target(lobe, kept.q0), ltc_cosine_from_target(lobe, kept.q1), kept.share);
//#if cosine_horizon
    let seen = ltc_clip_above(kept.q0, kept.q1, moment * kept.share);
    kept = LtcKept(seen.q0, seen.q1, kept.share * seen.share);
//#endif
    return kept;
}
//#endif

// A length whose square may underflow.
fn ltc_length(v: vec3f) -> f32 {
    let scale = ltc_largest_component(v);
    return select(0.0, scale * length(v / max(scale, LTC_TINY)), scale > LTC_TINY);
}

// (c_z / d) (angle - sin angle) + tan(angle / 2) (q0_z / |q0| + q1_z / |q1|) (1 / |q0| + 1 / |q1|), the angle being that
// between q0 and q1, sine = |q0 x q1|, nearness = c_z / d with d the distance of the line, c towards its nearest point.
fn ltc_cosine_along(q0: vec3f, q1: vec3f, sine: f32, nearness: f32) -> f32 {
    let squares = vec2f(dot(q0, q0), dot(q1, q1));
//#if lean_lights
    let near = inverseSqrt(max(squares, vec2f(1e-36)));
//#else
    var near = inverseSqrt(squares);
    if !(min(squares.x, squares.y) > 1e-30) {
        let r0 = ltc_length(q0);
        let r1 = ltc_length(q1);
        if !(r0 > 0.0 && r1 > 0.0) {
            return 0.0;
        }
        near = 1.0 / vec2f(r0, r1);
    }
//#endif
    // Products of unit lengths: what a horizon cuts may be as near as the line is.
    let cosine = dot(q0 * near.x, q1 * near.y);
    let unit_sine = sine * near.x * near.y;
    // 1 + cos cancels near pi, 1 - cos near 0.
    let acute = cosine >= 0.0;
    let half_tangent = select(1.0 - cosine, unit_sine, acute) / select(unit_sine, 1.0 + cosine, acute);
    let ends = half_tangent * (q0.z * near.x + q1.z * near.y) * (near.x + near.y);
    // angle - sin(angle) = sin (1 - cos) g with 1 - cos = sin tan(angle / 2), and g by a rational function of the cosine, relative
    // error 1e-8; beyond a right angle pi less the same of the rest.
    let x = abs(cosine);
    let g = ((0.084654707 * x + 0.51849874) * x + 0.57079632)
        / (((0.088782444 * x + 0.77275170) * x + 1.6603152) * x + 1.0);
    let less = unit_sine * unit_sine * half_tangent * g;
    let rest = LTC_PI - unit_sine * (2.0 + (1.0 - x) * g);
    return nearness * select(rest, less, acute) + ends;
}

// The integral of D(w) |w x w_t| / |p|^2 dl along the segment, per scaled length: half of eq. 1.6. Of what is above the
// horizons.
fn ltc_segment_integral(segment: LtcSegment, lobe: LtcLobe) -> f32 {
//#ifnot lean_lights
    if !(segment.valid && lobe.valid) {
        return 0.0;
    }
//#endif
    // q0 x q1 = stretch * transpose(M) * normal, not the product of rounded ends.
    let width = ltc_cosine_normal(lobe, segment.normal);
    let squared_width = dot(width, width);
    let stretch = segment.moment * lobe.area_scale;
    let along = ltc_cosine_from_target(lobe, segment.p1 - segment.p0);
//#if lean_lights
    let kept = ltc_kept(segment, ltc_cosine_from_target(lobe, segment.p0), along);
    // What is the lobe's alone is computed once for all its lights.
    let inverse_width = inverseSqrt(max(squared_width, 1e-36));
    let nearness = (along.x * width.y - along.y * width.x) * (inverse_width * inverse_width) * (1.0 / stretch);
    let sine = kept.share * stretch * (squared_width * inverse_width);
    let stretched = sqrt(dot(segment.normal, segment.normal)) * inverse_width * lobe.determinant;
//#else
    let kept = ltc_kept(segment, lobe, width * stretch);
    let nearness = (along.x * width.y - along.y * width.x) / squared_width / stretch;
    let sine = kept.share * stretch * sqrt(squared_width);
    let stretched = sqrt(dot(segment.normal, segment.normal) / squared_width) * lobe.determinant;
//#endif
    let integral = stretched * ltc_cosine_along(kept.q0, kept.q1, sine, nearness) * (0.5 / LTC_PI);
    // Whatever it is where nothing is left: chosen away, not multiplied.
    let valid = segment.valid & lobe.valid & (squared_width > 0.0) & (stretch > 0.0);
    return select(0.0, integral, valid & (kept.share > 0.0) & (sine > 0.0));
}
