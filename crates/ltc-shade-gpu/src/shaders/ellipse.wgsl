// Flat elliptical lights. No bindings. Needs: math, precise, facing, cone_light.

// The fraction of the lobe that sees the ellipse centre + axis_u cos t + axis_v sin t, in [0, 1]; the front is where
// axis_u x axis_v points. Zero without area, for a shading point in its plane, and behind a one-sided one.
fn ltc_ellipse(
    lobe: LtcLobe,
    centre: vec3f,
    axis_u: vec3f,
    axis_v: vec3f,
//#if two_sided
    two_sided: bool,
//#endif
) -> f32 {
//#ifnot two_sided
    const two_sided = false;
//#endif
    let size = max(ltc_largest_component(centre), max(ltc_largest_component(axis_u), ltc_largest_component(axis_v)));
    let shrink = 1.0 / max(size, LTC_TINY);
    let c = centre * shrink;
    let facing = ltc_facing(ltc_cross(axis_u * shrink, axis_v * shrink), c, length(c));
    if !ltc_emits_towards(facing, two_sided) {
        return 0.0;
    }
    let front = facing > 0.0;
    let u = select(axis_u, axis_v, front);
    let v = select(axis_v, axis_u, front);
    return clamp(ltc_cone_light(lobe, centre, u, v, vec3f(0.0)), 0.0, 1.0);
}
