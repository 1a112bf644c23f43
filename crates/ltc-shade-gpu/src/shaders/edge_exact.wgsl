// The angle of an edge, exact. No bindings. Needs: math.

// The angle whose sine and cosine these are, up to one factor; sine >= 0.
fn ltc_edge_angle(sine: f32, cosine: f32) -> f32 {
    return ltc_atan2(sine, cosine);
}
