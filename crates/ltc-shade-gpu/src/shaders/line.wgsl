// Line lights: thin cylinders without caps, by the line approximation (Heitz and Hill 2017, eq. 1.6 to 1.26). No bindings.
// Needs: segment.

// min(1, R * integral of D(w) 2 |w x w_t| / |p|^2 dl); ends relative to the shading point, in the shading frame. For a cylinder
// that looks much narrower than the lobe. Zero for one without extent and for a line through the shading point.
fn ltc_line(lobe: LtcLobe, p0: vec3f, p1: vec3f, radius: f32) -> f32 {
    return clamp(ltc_line_unclamped(lobe, p0, p1, radius), 0.0, 1.0);
}

fn ltc_line_unclamped(lobe: LtcLobe, p0: vec3f, p1: vec3f, radius: f32) -> f32 {
    let segment = ltc_segment(p0, p1);
    return 2.0 * (radius * segment.shrink) * ltc_segment_integral(segment, lobe);
}
