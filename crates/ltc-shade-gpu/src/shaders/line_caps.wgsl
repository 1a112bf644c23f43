// Thin cylinders with caps, these as points (Heitz and Hill 2017, eq. 1.33 and 1.34). No bindings. Needs: line.

// The fraction of a disk's area above z = 0: nothing jumps as a cap rises above the surface's horizon.
fn ltc_disk_above(z: f32, normal_z: f32, radius: f32) -> f32 {
    let reach = radius * sqrt(max(1.0 - normal_z * normal_z, 0.0));
    if z >= reach {
        return 1.0;
    }
    if z <= -reach {
        return 0.0;
    }
    let x = z / reach;
    let y = sqrt(max((1.0 - x) * (1.0 + x), 0.0));
    return clamp(0.5 + (ltc_atan2(x, y) + x * y) / LTC_PI, 0.0, 1.0);
}

// pi R^2 D(w_p) max(0, w_p . inward) / |p|^2. With q = M^-1 p it is R^2 q_z max(0, p . inward) / (det M |q|^4).
fn ltc_cap(lobe: LtcLobe, p: vec3f, inward: vec3f, radius: f32) -> f32 {
    let facing = dot(p, inward);
    let q = ltc_cosine_from_target(lobe, p);
    let distance = ltc_length(q);
    if !(facing > 0.0 && q.z > 0.0 && distance > LTC_TINY) {
        return 0.0;
    }
    let size = radius / distance;
    // |q| is here the determinant times M^-1 p's; of the four powers one remains with the determinant of M itself.
    let density = (q.z / distance) * (size * size) * (facing / distance) * lobe.determinant * lobe.area_scale;
//#if surface_horizon
    return density * ltc_disk_above(p.z, inward.z, radius);
//#else
    return density;
//#endif
}

// As `ltc_line`, and its caps.
fn ltc_line_with_caps(lobe: LtcLobe, p0: vec3f, p1: vec3f, radius: f32) -> f32 {
    let scale = ltc_floor_power_of_two(max(ltc_largest_component(p0), ltc_largest_component(p1)));
    let axis = ltc_unit_or_zero(p1 - p0);
    if !(scale > LTC_TINY && lobe.valid && dot(axis, axis) > 0.5) {
        return 0.0;
    }
    let shrink = 1.0 / scale;
    let caps = ltc_cap(lobe, p0 * shrink, axis, radius * shrink) + ltc_cap(lobe, p1 * shrink, -axis, radius * shrink);
    return clamp(ltc_line_unclamped(lobe, p0, p1, radius) + caps, 0.0, 1.0);
}
