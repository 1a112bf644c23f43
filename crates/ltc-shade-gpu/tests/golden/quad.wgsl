// Area lights by linearly transformed cosines, in closed form.
// WGSL, written by ltc 0.1.0 as
//   ltc shader --lang wgsl --lights 'quad' --features 'rational-edges'
// Without surface-horizon: light from below the surface leaks into tilted lobes.
// Without cosine-horizon: what lies below the horizon of cosine space counts negatively.
//
// Shading frame: x = tangent (carries alpha_x), y = bitangent (alpha_y), z = normal, right-handed. Lights are given in
// it, relative to the shading point; flat ones counter-clockwise seen from the side that emits. `wo` is a unit vector
// towards the eye. M (target_from_cosine) takes the clamped cosine to the lobe. A light's function gives the fraction of
// the lobe that sees it, in [0, 1]; 0 for a degenerate one. Inputs are finite: NaN and infinity are the caller's to
// refuse. alpha is the GGX width, the square of perceptual roughness; widths below the smallest are raised to it:
// alpha >= 0.0001.
//
// Functions to call:
//   fn ltc_lobe(target_from_cosine: mat3x3f) -> LtcLobe
//   fn ltc_cosine() -> LtcLobe
//   fn ltc_quad(lobe: LtcLobe, v0: vec3f, v1: vec3f, v2: vec3f, v3: vec3f) -> f32
//
// Use, once for a surface point:
//   lobe = ltc_lobe(M), and ltc_cosine() for diffuse light
// Paste it behind your bindings; textures and samplers are parameters.

// Arithmetic with defined results everywhere. No bindings.

const LTC_PI: f32 = 3.1415927;
// Near the smallest normal number. Some hardware flushes what is smaller to zero, so that dividing by it is not safe.
const LTC_TINY: f32 = 1e-37;

fn ltc_largest_component(v: vec3f) -> f32 {
    let a = abs(v);
    return max(a.x, max(a.y, a.z));
}

// The unit vector of v, or zero for a vector that has no direction.
fn ltc_unit_or_zero(v: vec3f) -> vec3f {
    let scale = ltc_largest_component(v);
    if !(scale > LTC_TINY) {
        return vec3f(0.0);
    }
    let u = v / scale;
    return u / length(u);
}

// Four-quadrant arc tangent of y / x, in [-pi, pi]; 0 for (0, 0). Absolute error below 3e-7.
//
// WGSL allows the built-in atan2 an error of 4096 ulp (5e-4): this one is as good on every device. The polynomial is a
// minimax fit of atan(t) / t on [0, tan(pi / 8)], relative error 2.1e-8.
fn ltc_atan2(y: f32, x: f32) -> f32 {
    let low = min(abs(x), abs(y));
    let high = max(abs(x), abs(y));
    if !(high > LTC_TINY) {
        return 0.0;
    }
    // Above tan(pi / 8), atan(t) = pi / 4 + atan((t - 1) / (t + 1)).
    let past_eighth = low > 0.41421357 * high;
    let t = select(low, low - high, past_eighth) / select(high, low + high, past_eighth);
    let s = t * t;
    let series = s * (-0.33332949 + s * (0.19977710 + s * (-0.13877678 + s * 0.08053720)));
    var angle = t + t * series + select(0.0, 0.25 * LTC_PI, past_eighth);
    angle = select(angle, 0.5 * LTC_PI - angle, abs(y) > abs(x));
    angle = select(angle, LTC_PI - angle, x < 0.0);
    return select(angle, -angle, y < 0.0);
}

// The largest power of two that is not above the magnitude; 0 below the smallest normal number. Scaling by it rounds nothing.
fn ltc_floor_power_of_two(x: f32) -> f32 {
    return bitcast<f32>(bitcast<u32>(x) & 0x7f800000u);
}

// Products whose leading digits cancel. No bindings.
//
// The twelve leading digits of a factor are split off by a mask, so that products of leading parts are exact and nothing hangs
// on how a sum is rounded. But compilers put parts together again where algebra allows: Mesa's turns a b + a c into a (b + c).
// What is exact goes through `ltc_apart` before it meets the rest.

// The same, in a way that algebra does not see through. For magnitudes up to 1e30.
fn ltc_apart(v: vec3f) -> vec3f {
    return max(v, vec3f(-1e30));
}

fn ltc_leading(v: vec3f) -> vec3f {
    return bitcast<vec3f>(bitcast<vec3u>(v) & vec3u(0xfffff000u));
}

// a * b - c * d to some 2^-36 of the products.
fn ltc_product_differences(a: vec3f, b: vec3f, c: vec3f, d: vec3f) -> vec3f {
    let a_high = ltc_leading(a);
    let b_high = ltc_leading(b);
    let c_high = ltc_leading(c);
    let d_high = ltc_leading(d);
    let a_low = a - a_high;
    let b_low = b - b_high;
    let c_low = c - c_high;
    let d_low = d - d_high;
    let middle = (a_high * b_low - c_high * d_low) + (a_low * b_high - c_low * d_high);
    return ltc_apart(a_high * b_high - c_high * d_high) + (middle + (a_low * b_low - c_low * d_low));
}

// The cross product, each component to its own last digits where they do not cancel by more than 2^12.
fn ltc_cross(a: vec3f, b: vec3f) -> vec3f {
    return ltc_product_differences(a.yzx, b.zxy, a.zxy, b.yzx);
}

// The nearest multiples of 2^-11. Of numbers up to 1, sums of products of these are exact, whatever their order: what is left
// beside them is small.
fn ltc_whole(v: vec3f) -> vec3f {
    return round(v * 2048.0) * 0.00048828125;
}

// A vector as a sum, the first part of multiples of 2^-11.
struct LtcSplit {
    whole: vec3f,
    rest: vec3f,
}

fn ltc_split(v: vec3f) -> LtcSplit {
    let whole = ltc_whole(v);
    return LtcSplit(whole, v - whole);
}

fn ltc_split_sum(large: vec3f, small: vec3f) -> LtcSplit {
    let exact = ltc_apart(large);
    let whole = ltc_whole(exact + small);
    return LtcSplit(whole, (exact - whole) + small);
}

// |a|^2 - |b|^2 to some 2^-33, coordinates and lengths up to about 1.
fn ltc_difference_of_squares(a: LtcSplit, b: LtcSplit) -> f32 {
    let middle = dot(a.whole, a.rest) - dot(b.whole, b.rest);
    let small = dot(a.rest, a.rest) - dot(b.rest, b.rest);
    let exact = ltc_apart(vec3f(dot(a.whole, a.whole) - dot(b.whole, b.whole)));
    return exact.x + (2.0 * middle + small);
}

// a . b to some 2^-33, coordinates up to 1.
fn ltc_precise_dot(a: LtcSplit, b: LtcSplit) -> f32 {
    let small = dot(a.whole, b.rest) + dot(a.rest, b.whole) + dot(a.rest, b.rest);
    return ltc_apart(vec3f(dot(a.whole, b.whole))).x + small;
}

// A lobe as lights need it: M and its inverse up to scale, by cofactors. No bindings. Needs: math, precise.

struct LtcLobe {
    // M, its largest entry 1.
    target_from_cosine: mat3x3f,
    // Rows of determinant * M^-1, the largest entry 1.
    rows: mat3x3f,
    // What the rows are M^-1 times of.
    determinant: f32,
    // (rows a) x (rows b) = area_scale * transpose(M) * (a x b)
    area_scale: f32,
    // False unless det M > 0: such a matrix is no lobe, and sees nothing.
    valid: bool,
}

fn ltc_largest_entry(m: mat3x3f) -> f32 {
    return max(ltc_largest_component(m[0]), max(ltc_largest_component(m[1]), ltc_largest_component(m[2])));
}

// `target_from_cosine` may have any scale. Once for all lights of a point.
fn ltc_lobe(target_from_cosine: mat3x3f) -> LtcLobe {
    let m = target_from_cosine * (1.0 / max(ltc_largest_entry(target_from_cosine), LTC_TINY));
    let cofactors = mat3x3f(ltc_cross(m[1], m[2]), ltc_cross(m[2], m[0]), ltc_cross(m[0], m[1]));
    let determinant = dot(m[0], cofactors[0]);
    let scale = 1.0 / max(ltc_largest_entry(cofactors), LTC_TINY);
    let scaled = determinant * scale;
    return LtcLobe(m, cofactors * scale, scaled, scaled * scale, scaled > 0.0);
}

// The clamped cosine itself, Lambert's lobe.
fn ltc_cosine() -> LtcLobe {
    let identity = mat3x3f(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0);
    return LtcLobe(identity, identity, 1.0, 1.0, true);
}

// A direction of the lobe's space in cosine space, up to its length.
fn ltc_cosine_from_target(lobe: LtcLobe, v: vec3f) -> vec3f {
    return v * lobe.rows;
}

// The normal of a plane through the origin in cosine space, up to its length.
fn ltc_cosine_normal(lobe: LtcLobe, normal: vec3f) -> vec3f {
    return normal * lobe.target_from_cosine;
}

// The fraction of the lobe above the horizons: of a light in every direction. In cosine space the surface's horizon is a
// plane whose normal has the angle gamma to z; between both the cosine integrates to (1 + cos gamma) / 2.
fn ltc_everywhere(lobe: LtcLobe) -> f32 {
    if !lobe.valid {
        return 0.0;
    }
    return 1.0;
}

// The angle of an edge by a rational function: `ltc_core::Rational`, without an arc tangent. No bindings. Needs: math.

// theta / sin(theta) from its cosine, in [0, 1].
fn ltc_angle_over_sine(x: f32) -> f32 {
    return ((0.026367364 * x + 0.90948718) * x + 1.5707957) / ((0.29106499 * x + 1.2155835) * x + 1.0);
}

// The angle whose sine and cosine these are, up to one factor; sine >= 0. Relative error 7e-7 up to a right angle; beyond, by
// pi - f(-cosine), so that edges near pi keep their value.
fn ltc_edge_angle(sine: f32, cosine: f32) -> f32 {
    let length = sqrt(sine * sine + cosine * cosine);
    if !(length > LTC_TINY) {
        return 0.0;
    }
    let acute = ltc_angle_over_sine(abs(cosine) / length) * (sine / length);
    return select(acute, LTC_PI - acute, cosine < 0.0);
}

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
    sum: f32,
}

fn ltc_boundary() -> LtcBoundary {
    let none = LtcCorner(vec3f(0.0), vec3f(0.0));
    return LtcBoundary(none, none, false, 0.0);
}

fn ltc_corner(lobe: LtcLobe, vertex: vec3f) -> LtcCorner {
    let surface = vertex * (1.0 / ltc_largest_component(vertex));
    return LtcCorner(surface, ltc_cosine_from_target(lobe, surface));
}

// Azimuth in [-pi, pi] from its sine and cosine.
fn ltc_azimuth(sine: f32, cosine: f32) -> f32 {
    return ltc_atan2(sine, cosine);
}


// The integral along the great circle from a to b, whose cross product is `normal` times `scale` > 0; its part below the
// horizon dropped onto the horizon. Equal and antipodal ends span no plane and give 0.
fn ltc_arc(a: vec3f, b: vec3f, normal: vec3f, scale: f32) -> f32 {
    let direction = ltc_unit_or_zero(normal);
    let length = dot(normal, direction) * scale;
    if !(length > 0.0) {
        return 0.0;
    }
    return ltc_edge_angle(length, dot(a, b)) * direction.z;
}

// The integral along the edge from a to b, nothing cut by the surface.
fn ltc_edge(lobe: LtcLobe, a: LtcCorner, b: LtcCorner, kept: f32) -> f32 {
    let normal = ltc_cosine_normal(lobe, ltc_cross(a.surface, b.surface));
    return ltc_arc(a.cosine, b.cosine, normal, lobe.area_scale * kept);
}


// Adds the edge from a to b, cut by the surface's horizon: what keeps lights below it from leaking into a tilted lobe.
fn ltc_boundary_edge(boundary: ptr<function, LtcBoundary>, lobe: LtcLobe, a: LtcCorner, b: LtcCorner) {
    (*boundary).sum += ltc_edge(lobe, a, b, 1.0);
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
    return (*boundary).sum;
}

// The integral over the inside, as a fraction, from the sum of a flat outline that winds positively, before it is clamped.
fn ltc_fraction_of_sum(sum: f32) -> f32 {
    let turns = sum / (2.0 * LTC_PI);
    return turns;
}

// On which side of a flat light the shading point is. No bindings. Needs: math, precise.

fn ltc_emits_towards(facing: f32, two_sided: bool) -> bool {
    return facing > 0.0 || (two_sided && facing < 0.0);
}

// The distance of the shading point in front of the plane with this normal through `point`, times the normal's length;
// exactly 0 where rounding decides the side: within 8 epsilon of `reach`, how far what defines the plane is away.
fn ltc_facing(normal: vec3f, point: vec3f, reach: f32) -> f32 {
    let facing = -dot(normal, point);
    return select(0.0, facing, abs(facing) > 9.5367432e-7 * reach * length(normal));
}

// The boundary sum of a quad in straight code, cut by both horizons. No bindings. Needs: math, lobe.
//
// In cosine space the fraction of the lobe that sees a flat light is the sum of (a x b).z theta / (2 pi sin(theta)) over the arcs of its
// outline (Heitz et al. 2016, eq. 11), theta the angle between unit vectors a and b. The outline is cut by two planes through
// the shading point: where it goes below one and comes back, an arc along the horizon closes it. Four edges and two closing arcs are all
// that a convex quad has.

struct LtcArcs {
    sum: f32,
    // Where the outline goes below the surface's horizon, and where it comes back.
    exit: vec3f,
    entry: vec3f,
    // The same of the horizon of cosine space.
    cosine_exit: vec2f,
    cosine_entry: vec2f,
    // How often it crosses each; more than twice in a dent that reaches through, which these arcs do not close.
    crossings: vec2f,
    // Whether some arc is so near half a turn that rounding tells.
    half_turn: bool,
}

// Adds the arc from `a` along `edge`, in cosine space, whose ends have these heights above the surface.
fn ltc_arcs_add(arcs: ptr<function, LtcArcs>, a: vec3f, edge: vec3f, heights: vec2f) {
    var part = vec2f(0.0, 1.0);
    var hidden = false;
    let begin = a + part.x * edge;
    let end = a + part.y * edge;
    // begin x end, without the part that they have in common, and begin . end: the sine and the cosine, times the radius.
    let normal = cross(a, edge) * (part.y - part.x);
    let along = dot(begin, end);
    let radius = sqrt(dot(begin, begin) * dot(end, end));
    let sine = sqrt(dot(normal, normal));
    // theta / (radius sin(theta)) as one fraction: a rational function of the cosine up to a right angle (relative error 2e-8 before
    // rounding), pi / sine less that beyond.
    let x = abs(along);
    let square = radius * radius;
    let over = (0.18455717 * x + 1.3306760 * radius) * x + 1.5707963 * square;
    let under = ((0.040163346 * x + 0.56211384 * radius) * x + 1.4837523 * square) * x + square * radius;
    let obtuse = along < 0.0;
    let numerator = select(over, LTC_PI * under - over * sine, obtuse);
    let denominator = select(under, under * sine, obtuse);
    (*arcs).sum += select(normal.z * numerator / max(denominator, 1e-36), 0.0, hidden);
    (*arcs).half_turn = (*arcs).half_turn | (obtuse & (sine < 0.02 * radius) & !hidden);
}

// All arcs of the quad; its largest coordinate is about 1.
fn ltc_quad_arcs(lobe: LtcLobe, v0: vec3f, v1: vec3f, v2: vec3f, v3: vec3f) -> LtcArcs {
    let none = vec3f(0.0);
    var arcs = LtcArcs(0.0, none, none, none.xy, none.xy, none.xy, false);
    let a = ltc_cosine_from_target(lobe, v0);
    // Differences of corners first: what distant lights have of their own is in them.
    let ab = ltc_cosine_from_target(lobe, v1 - v0);
    let bc = ltc_cosine_from_target(lobe, v2 - v1);
    let cd = ltc_cosine_from_target(lobe, v3 - v2);
    let b = a + ab;
    let c = b + bc;
    ltc_arcs_add(&arcs, a, ab, vec2f(v0.z, v1.z));
    ltc_arcs_add(&arcs, b, bc, vec2f(v1.z, v2.z));
    ltc_arcs_add(&arcs, c, cd, vec2f(v2.z, v3.z));
    ltc_arcs_add(&arcs, c + cd, -(ab + bc + cd), vec2f(v3.z, v0.z));
    return arcs;
}

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
) -> f32 {
    const two_sided = false;
    let scale = max(
        max(ltc_largest_component(v0), ltc_largest_component(v1)),
        max(ltc_largest_component(v2), ltc_largest_component(v3)),
    );
    if !(scale > LTC_TINY && lobe.valid) {
        return 0.0;
    }
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
