// Spherical lights, which emit outwards and inwards. No bindings. Needs: math, precise, frame, cone_light.

// The fraction of the lobe that sees the sphere, in [0, 1]: from inside or on the surface all of it above the horizons. Zero for
// radius 0.
fn ltc_sphere(lobe: LtcLobe, centre: vec3f, radius: f32) -> f32 {
    let size = 2.0 * ltc_floor_power_of_two(max(ltc_largest_component(centre), radius));
    if !(radius > 0.0 && size > LTC_TINY) {
        return 0.0;
    }
    let c = centre / size;
    let r = radius / size;
    // The square of the tangent's length: near the surface it is a small difference.
    let outside = ltc_difference_of_squares(ltc_split(c), ltc_split(vec3f(r, 0.0, 0.0)));
    if outside <= 0.0 {
        return ltc_everywhere(lobe);
    }
    // It fills the cone over the circle where tangents touch it, here at another size.
    let tangent = sqrt(outside);
    let towards = ltc_unit_or_zero(c);
    let u = ltc_any_tangent(towards);
    return clamp(ltc_cone_light(lobe, towards * tangent, u * r, cross(towards, u) * r, vec3f(0.0)), 0.0, 1.0);
}
