// The angle of an edge, exact. No bindings. Needs: math.

// The angle whose sine and cosine these are, up to one factor; sine >= 0.
fn ltc_edge_angle(sine: f32, cosine: f32) -> f32 {
    return ltc_atan2(sine, cosine);
}

// theta / sin(theta) from its cosine, in [0, 1]: relative error 2e-8 before rounding.
fn ltc_angle_over_sine(cosine: f32) -> f32 {
    return ((0.18455717 * cosine + 1.3306760) * cosine + 1.5707963)
        / (((0.040163346 * cosine + 0.56211384) * cosine + 1.4837523) * cosine + 1.0);
}
