// Strip lights: thin rectangles as lines (Heitz and Hill 2017, section 1.6, corrected: the factor is |normal . u|, u towards the
// line). No bindings. Needs: segment, facing.

// min(1, width * integral of D(w) |w . normal| / |p|^2 dl). The part of `normal` along the line is dropped.
fn ltc_strip(
    lobe: LtcLobe,
    p0: vec3f,
    p1: vec3f,
    width: f32,
    normal: vec3f,
//#if two_sided
    two_sided: bool,
//#endif
) -> f32 {
//#ifnot two_sided
    const two_sided = false;
//#endif
    let segment = ltc_segment(p0, p1);
    let axis = ltc_unit_or_zero(segment.p1 - segment.p0);
    let unit = ltc_unit_or_zero(normal);
    let across = unit - axis * dot(unit, axis);
    // What is left of a parallel normal is rounding error, whose direction means nothing.
    if !(length(across) > 2e-6) {
        return 0.0;
    }
    let facing = -dot(ltc_unit_or_zero(across), ltc_towards_line(segment));
    // Below 8 epsilon rounding decides which side is seen: that is edge-on.
    if !(ltc_emits_towards(facing, two_sided) && abs(facing) > 9.5367432e-7) {
        return 0.0;
    }
    return clamp(width * segment.shrink * abs(facing) * ltc_segment_integral(segment, lobe), 0.0, 1.0);
}
