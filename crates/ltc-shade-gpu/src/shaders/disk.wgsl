// Flat circular lights. No bindings. Needs: math, frame, facing, cone_light.

// The fraction of the lobe that sees the disk, in [0, 1]; the front is where `normal`, of any length, points. Zero without area,
// for a shading point in its plane, and behind a one-sided one.
fn ltc_disk(
    lobe: LtcLobe,
    centre: vec3f,
    normal: vec3f,
    radius: f32,
//#if two_sided
    two_sided: bool,
//#endif
) -> f32 {
//#ifnot two_sided
    const two_sided = false;
//#endif
    let n = ltc_unit_or_zero(normal);
    let c = centre / max(ltc_largest_component(centre), LTC_TINY);
    let facing = ltc_facing(n, c, length(c));
    if !ltc_emits_towards(facing, two_sided) {
        return 0.0;
    }
    // u x v points away from the shading point.
    let away = select(n, -n, facing > 0.0);
    let u = ltc_any_tangent(away);
    return clamp(ltc_cone_light(lobe, centre, u * radius, cross(away, u) * radius, vec3f(0.0)), 0.0, 1.0);
}
