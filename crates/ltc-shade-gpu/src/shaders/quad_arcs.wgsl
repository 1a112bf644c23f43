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
//#if surface_horizon
    let sunk = heights < vec2f(0.0);
    hidden = sunk.x & sunk.y;
    let sinks = sunk.x != sunk.y;
    let at = heights.x / select(1.0, heights.x - heights.y, sinks);
    let cut = a + at * edge;
    (*arcs).entry = select((*arcs).entry, cut, sunk.x & sinks);
    (*arcs).exit = select((*arcs).exit, cut, sunk.y & sinks);
    (*arcs).crossings.x += select(0.0, 1.0, sinks);
    part = vec2f(select(0.0, at, sunk.x & sinks), select(1.0, at, sunk.y & sinks));
//#endif
//#if cosine_horizon
    let lifted = a.zz + part * edge.z;
    let below = lifted < vec2f(0.0);
    let sets = (below.x != below.y) & !hidden;
    let place = part.x + (part.y - part.x) * (lifted.x / select(1.0, lifted.x - lifted.y, sets));
    let crossing = a.xy + place * edge.xy;
    (*arcs).cosine_entry = select((*arcs).cosine_entry, crossing, below.x & sets);
    (*arcs).cosine_exit = select((*arcs).cosine_exit, crossing, below.y & sets);
    (*arcs).crossings.y += select(0.0, 1.0, sets);
    part = vec2f(select(part.x, place, below.x & sets), select(part.y, place, below.y & sets));
    hidden = hidden | (below.x & below.y);
//#endif
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
//#if surface_horizon
    ltc_arcs_add(&arcs, arcs.exit, arcs.entry - arcs.exit, vec2f(0.0));
//#endif
//#if cosine_horizon
    let exit = vec3f(arcs.cosine_exit, 0.0);
    ltc_arcs_add(&arcs, exit, vec3f(arcs.cosine_entry, 0.0) - exit, vec2f(0.0));
//#endif
    return arcs;
}
