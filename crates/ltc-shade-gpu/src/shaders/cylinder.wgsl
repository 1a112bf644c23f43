// Round cylinders of any width by their true silhouette. No bindings. Needs: math, precise, frame, boundary,
// cone_light.
//
// The silhouette is the rectangle between the two generators that are seen edge-on, and beside it the segments of both end
// circles beyond the rectangle; without caps the near part of an end that faces the shading point is taken away instead.

// A cylinder from the shading point, lengths over its largest.
struct LtcCylinder {
    // Unit vector from the first end to the second.
    along: vec3f,
    // Unit vector from the shading point to the nearest point of the axis' line, zero where that is the shading point.
    towards: vec3f,
    // Where the ends are along the axis, ascending.
    low: f32,
    high: f32,
    radius: f32,
    // The square of the axis' distance less that of the radius.
    outside: f32,
    valid: bool,
}

// From p to q, its largest component between 0.5 and 1; p and q of coordinates up to 1.
fn ltc_cylinder_axis(p: LtcSplit, q: LtcSplit, extent: f32) -> LtcSplit {
    let grow = 0.5 / max(ltc_floor_power_of_two(extent), LTC_TINY);
    return ltc_split_sum((q.whole - p.whole) * grow, (q.rest - p.rest) * grow);
}

// The square of the distance from the origin of the line through p along `a`, less that of the radius, all of them up to 1.
// Near the surface it is a small difference of what f32 has no digits for.
fn ltc_outside_of_cylinder(p: LtcSplit, a: LtcSplit, radius: f32) -> f32 {
    let moment = p.whole.yzx * a.whole.zxy - p.whole.zxy * a.whole.yzx;
    let small = (p.whole.yzx * a.rest.zxy - p.whole.zxy * a.rest.yzx)
        + (p.rest.yzx * a.whole.zxy - p.rest.zxy * a.whole.yzx)
        + (p.rest.yzx * a.rest.zxy - p.rest.zxy * a.rest.yzx);
    let r = ltc_split(vec3f(radius, 0.0, 0.0));
    let wide = r.whole.x * a.whole;
    let narrow = r.whole.x * a.rest + r.rest.x * (a.whole + a.rest);
    let length = a.whole + a.rest;
    return ltc_difference_of_squares(ltc_split_sum(moment, small), ltc_split_sum(wide, narrow)) / dot(length, length);
}

fn ltc_cylinder_view(p0: vec3f, p1: vec3f, radius: f32) -> LtcCylinder {
    let size = 2.0 * ltc_floor_power_of_two(max(max(ltc_largest_component(p0), ltc_largest_component(p1)), radius));
    let shrink = 1.0 / max(size, LTC_TINY);
    let a = p0 * shrink;
    let b = p1 * shrink;
    let r = radius * shrink;
    let along = ltc_unit_or_zero(b - a);
    // along x (p x along): without the cancellation of p - along (p.along). The nearer end loses less.
    let nearer = select(b, a, dot(a, a) <= dot(b, b));
    let towards = ltc_unit_or_zero(cross(along, ltc_cross(nearer, along)));
    let valid = radius > 0.0 && size > LTC_TINY && dot(along, along) > 0.5;
    let p = ltc_split(a);
    let q = ltc_split(b);
    let axis = ltc_cylinder_axis(p, q, ltc_largest_component(b - a));
    let outside = ltc_outside_of_cylinder(ltc_split(nearer), axis, r);
    // Where an end is along the axis decides what is seen of it from beside its rim.
    let per_length = 1.0 / max(length(axis.whole + axis.rest), LTC_TINY);
    let low = ltc_precise_dot(p, axis) * per_length;
    let high = ltc_precise_dot(q, axis) * per_length;
    return LtcCylinder(along, towards, low, high, r, outside, valid);
}

// The fraction of the lobe that sees the cylinder, in [0, 1]. With `caps` it is a closed solid, seen in every direction from
// inside; without, a tube whose inside is dark. Zero without extent.
fn ltc_cylinder(lobe: LtcLobe, p0: vec3f, p1: vec3f, radius: f32, caps: bool) -> f32 {
    let c = ltc_cylinder_view(p0, p1, radius);
    if !(c.valid && lobe.valid) {
        return 0.0;
    }
    let low_faces = c.low > 0.0;
    let high_faces = c.high < 0.0;
    // Within the mantle's infinite continuation only the end that faces the shading point is seen.
    let in_line = c.outside <= 0.0;
    if in_line && !caps {
        return 0.0;
    }
    if in_line && !(low_faces || high_faces) {
        return ltc_everywhere(lobe);
    }
    let distance = max(sqrt(max(c.outside + c.radius * c.radius, 0.0)), LTC_TINY);
    // How far the generators are that are seen edge-on, and the plane of both.
    let tangent = sqrt(max(c.outside, 0.0));
    let plane = tangent * (tangent / distance);
    var sum = 0.0;
    if !in_line {
        sum = ltc_cylinder_rectangle(lobe, c, plane, c.radius * (tangent / distance));
    }
    let towards = select(c.towards, ltc_any_tangent(c.along), dot(c.towards, c.towards) < 0.5);
    let u = towards * c.radius;
    let v = cross(c.along, u);
    for (var i = 0; i < 2; i++) {
        let height = select(c.high, c.low, i == 0);
        let faces = select(high_faces, low_faces, i == 0);
        if in_line && !faces {
            continue;
        }
        // The plane through the shading point that parts the end circle where the generators meet it.
        let normal = towards * height - c.along * plane;
        let beyond = faces && caps;
        let kept = select(select(-normal, normal, (height > 0.0) == beyond), vec3f(0.0), in_line);
        let away = height > 0.0;
        let centre = towards * distance + c.along * height;
        let part = ltc_cone_light(lobe, centre, select(v, u, away), select(u, v, away), kept);
        sum += select(part, -part, faces && !caps);
    }
    return clamp(sum, 0.0, 1.0);
}

fn ltc_cylinder_rectangle(lobe: LtcLobe, c: LtcCylinder, plane: f32, half_width: f32) -> f32 {
    let middle = c.towards * plane;
    let half = cross(c.along, c.towards) * half_width;
    var boundary = ltc_boundary();
    ltc_boundary_push(&boundary, lobe, middle + c.along * c.low - half);
    ltc_boundary_push(&boundary, lobe, middle + c.along * c.low + half);
    ltc_boundary_push(&boundary, lobe, middle + c.along * c.high + half);
    ltc_boundary_push(&boundary, lobe, middle + c.along * c.high - half);
    return ltc_fraction_of_sum(ltc_boundary_finish(&boundary, lobe));
}
