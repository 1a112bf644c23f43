// Flat polygonal lights, one vertex at a time. No bindings. Needs: math, precise, lobe, boundary, facing.
//
// Vertices are relative to the shading point, in the shading frame, counter-clockwise seen from the emitting side. Any simple
// polygon will do, convex or not:
//     var polygon = ltc_polygon(first);
//     for each further vertex: ltc_polygon_push(&polygon, lobe, vertex);
//     ltc_polygon_fraction(&polygon, lobe)
// For several lobes of one light, the outline is run through once for each.

struct LtcPolygon {
    boundary: LtcBoundary,
    first: vec3f,
    previous: vec3f,
    // Largest coordinate so far.
    scale: f32,
    // Newell's vector area about the first vertex, so that distant lights keep their digits; over the square of the scale.
    area: vec3f,
}

fn ltc_polygon(lobe: LtcLobe, first: vec3f) -> LtcPolygon {
    var boundary = ltc_boundary();
    ltc_boundary_push(&boundary, lobe, first);
    return LtcPolygon(boundary, first, first, max(ltc_largest_component(first), LTC_TINY), vec3f(0.0));
}

fn ltc_polygon_push(polygon: ptr<function, LtcPolygon>, lobe: LtcLobe, vertex: vec3f) {
    let scale = max((*polygon).scale, ltc_largest_component(vertex));
    let shrink = (*polygon).scale / scale;
    let first = (*polygon).first / scale;
    let term = ltc_cross((*polygon).previous / scale - first, vertex / scale - first);
    (*polygon).area = (*polygon).area * shrink * shrink + term;
    (*polygon).scale = scale;
    (*polygon).previous = vertex;
    // A copy, since some languages cannot pass a part of what is passed.
    var boundary = (*polygon).boundary;
    ltc_boundary_push(&boundary, lobe, vertex);
    (*polygon).boundary = boundary;
}

// The fraction of the lobe that sees the polygon, in [0, 1]. Zero for a degenerate one, for a shading point in its plane,
// and behind a one-sided one.
fn ltc_polygon_fraction(
    polygon: ptr<function, LtcPolygon>,
    lobe: LtcLobe,
//#if two_sided
    two_sided: bool,
//#endif
) -> f32 {
//#ifnot two_sided
    const two_sided = false;
//#endif
    let facing = ltc_facing((*polygon).area, (*polygon).first / (*polygon).scale, 1.0);
    if !(ltc_emits_towards(facing, two_sided) && lobe.valid) {
        return 0.0;
    }
    var boundary = (*polygon).boundary;
    let sum = ltc_boundary_finish(&boundary, lobe);
    return clamp(ltc_fraction_of_sum(select(sum, -sum, facing > 0.0)), 0.0, 1.0);
}
