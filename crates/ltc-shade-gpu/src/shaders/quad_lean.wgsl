// Flat convex lights of four corners, by straight code alone. No bindings. Needs: math, lobe, quad_arcs.
//
// The integral is that of `quad_careful`, cut by the same horizons. What is left out is its care for what is rare: an arc is good to some
// 1e-7 of the whole lobe, however small the light, so that tiny lights keep fewer digits; and a shading point in the light's plane is
// given what one of its sides sees, or nothing.

// The fraction of the lobe that sees the quad, in [0, 1]; corners counter-clockwise seen from the emitting side, relative to the
// shading point in the shading frame, no angle between edges above half a turn. Zero for a degenerate quad and behind a one-sided one.
fn ltc_quad(
    lobe: LtcLobe,
    v0: vec3f,
    v1: vec3f,
    v2: vec3f,
    v3: vec3f,
//#if two_sided
    two_sided: bool,
//#endif
) -> f32 {
    let scale = max(
        max(ltc_largest_component(v0), ltc_largest_component(v1)),
        max(ltc_largest_component(v2), ltc_largest_component(v3)),
    );
    if !(scale > LTC_TINY && lobe.valid) {
        return 0.0;
    }
//#if surface_horizon
    if max(max(v0.z, v1.z), max(v2.z, v3.z)) <= 0.0 {
        return 0.0;
    }
//#endif
    let shrink = 1.0 / scale;
    let sum = ltc_quad_arcs(lobe, v0 * shrink, v1 * shrink, v2 * shrink, v3 * shrink).sum;
//#if two_sided
    let seen = select(-sum, abs(sum), two_sided);
//#else
    let seen = -sum;
//#endif
    return clamp(seen / (2.0 * LTC_PI), 0.0, 1.0);
}
