// Round cylinders of any width by their true silhouette. No bindings. Needs: math, frame, boundary, cone_light.
//
// The silhouette is the rectangle between the two generators that are seen edge-on, and beside it the segments of both end
// circles beyond the rectangle; without caps the near part of an end that faces the shading point is taken away instead.

// A cylinder from the shading point, lengths over its largest.
struct LtcCylinder {
    // Unit vector from the first end to the second.
    along: vec3f,
    // From the shading point to the nearest point of the axis' line.
    offset: vec3f,
    // Where the ends are along the axis, ascending.
    low: f32,
    high: f32,
    radius: f32,
    valid: bool,
}

fn ltc_cylinder_view(p0: vec3f, p1: vec3f, radius: f32) -> LtcCylinder {
    let size = max(max(ltc_largest_component(p0), ltc_largest_component(p1)), radius);
    let shrink = 1.0 / max(size, LTC_TINY);
    let a = p0 * shrink;
    let b = p1 * shrink;
    let along = ltc_unit_or_zero(b - a);
    // along x (p x along): without the cancellation of p - along (p.along).
    let nearer = select(b, a, dot(a, a) <= dot(b, b));
    let offset = cross(along, ltc_cross(nearer, along));
    let valid = radius > 0.0 && size > LTC_TINY && dot(along, along) > 0.5;
    return LtcCylinder(along, offset, dot(a, along), dot(b, along), radius * shrink, valid);
}

// What the end circle at `height` along the axis adds, of its part with a positive product with `kept`.
fn ltc_cylinder_end(lobe: LtcLobe, c: LtcCylinder, height: f32, across: vec3f, kept: vec3f) -> f32 {
    let u = across * c.radius;
    let v = cross(c.along, across) * c.radius;
    let away = height > 0.0;
    return ltc_cone_light(lobe, c.offset + c.along * height, select(v, u, away), select(u, v, away), kept);
}

// The fraction of the lobe that sees the cylinder, in [0, 1]. With `caps` it is a closed solid, seen in every direction from
// inside; without, a tube whose inside is dark. Zero without extent.
fn ltc_cylinder(lobe: LtcLobe, p0: vec3f, p1: vec3f, radius: f32, caps: bool) -> f32 {
    let c = ltc_cylinder_view(p0, p1, radius);
    if !(c.valid && lobe.valid) {
        return 0.0;
    }
    let distance = length(c.offset);
    let low_faces = c.low > 0.0;
    let high_faces = c.high < 0.0;
    if distance <= c.radius {
        if !caps {
            return 0.0;
        }
        if !(low_faces || high_faces) {
            return ltc_everywhere(lobe);
        }
        let height = select(c.high, c.low, low_faces);
        return clamp(ltc_cylinder_end(lobe, c, height, ltc_any_tangent(c.along), vec3f(0.0)), 0.0, 1.0);
    }
    let towards = c.offset / distance;
    // How far the generators are that are seen edge-on, and the plane of both.
    let tangent = sqrt((distance - c.radius) * (distance + c.radius));
    let plane = tangent * (tangent / distance);
    var sum = ltc_cylinder_rectangle(lobe, c, towards, plane, c.radius * (tangent / distance));
    for (var i = 0; i < 2; i++) {
        let height = select(c.high, c.low, i == 0);
        let faces = select(high_faces, low_faces, i == 0);
        // The plane through the shading point that parts the end circle where the generators meet it.
        let normal = towards * height - c.along * plane;
        let beyond = faces && caps;
        let kept = select(-normal, normal, (height > 0.0) == beyond);
        let part = ltc_cylinder_end(lobe, c, height, towards, kept);
        sum += select(part, -part, faces && !caps);
    }
    return clamp(sum, 0.0, 1.0);
}

fn ltc_cylinder_rectangle(lobe: LtcLobe, c: LtcCylinder, towards: vec3f, plane: f32, half_width: f32) -> f32 {
    let middle = towards * plane;
    let half = cross(c.along, towards) * half_width;
    var boundary = ltc_boundary();
    ltc_boundary_push(&boundary, lobe, middle + c.along * c.low - half);
    ltc_boundary_push(&boundary, lobe, middle + c.along * c.low + half);
    ltc_boundary_push(&boundary, lobe, middle + c.along * c.high + half);
    ltc_boundary_push(&boundary, lobe, middle + c.along * c.high - half);
    return ltc_fraction_of_sum(ltc_boundary_finish(&boundary, lobe));
}
