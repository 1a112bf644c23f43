// The angle of an edge by a rational function: `ltc_core::Rational`, without an arc tangent. No bindings. Needs: math.

// theta / sin(theta) from its cosine, in [0, 1].
fn ltc_angle_over_sine(x: f32) -> f32 {
    return ((0.026367364 * x + 0.90948718) * x + 1.5707957) / ((0.29106499 * x + 1.2155835) * x + 1.0);
}

// The angle whose sine and cosine these are, up to one factor; sine >= 0. Relative error 7e-7 up to a right angle; beyond, by
// pi - f(-cosine), so that edges near pi keep their value.
fn ltc_edge_angle(sine: f32, cosine: f32) -> f32 {
    let length = sqrt(sine * sine + cosine * cosine);
    if !(length > LTC_TINY) {
        return 0.0;
    }
    let acute = ltc_angle_over_sine(abs(cosine) / length) * (sine / length);
    return select(acute, LTC_PI - acute, cosine < 0.0);
}
