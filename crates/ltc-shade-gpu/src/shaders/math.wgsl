// Arithmetic with defined results everywhere. No bindings.

const LTC_PI: f32 = 3.1415927;
// Near the smallest normal number. Some hardware flushes what is smaller to zero, so that dividing by it is not safe.
const LTC_TINY: f32 = 1e-37;

fn ltc_largest_component(v: vec3f) -> f32 {
    let a = abs(v);
    return max(a.x, max(a.y, a.z));
}

// The unit vector of v, or zero for a vector that has no direction.
fn ltc_unit_or_zero(v: vec3f) -> vec3f {
    let scale = ltc_largest_component(v);
    if !(scale > LTC_TINY) {
        return vec3f(0.0);
    }
    let u = v / scale;
    return u / length(u);
}

// Four-quadrant arc tangent of y / x, in [-pi, pi]; 0 for (0, 0). Absolute error below 3e-7.
//
// WGSL allows the built-in atan2 an error of 4096 ulp (5e-4): this one is as good on every device. The polynomial is a
// minimax fit of atan(t) / t on [0, tan(pi / 8)], relative error 2.1e-8.
fn ltc_atan2(y: f32, x: f32) -> f32 {
    let low = min(abs(x), abs(y));
    let high = max(abs(x), abs(y));
    if !(high > LTC_TINY) {
        return 0.0;
    }
    // Above tan(pi / 8), atan(t) = pi / 4 + atan((t - 1) / (t + 1)).
    let past_eighth = low > 0.41421357 * high;
    let t = select(low, low - high, past_eighth) / select(high, low + high, past_eighth);
    let s = t * t;
    let series = s * (-0.33332949 + s * (0.19977710 + s * (-0.13877678 + s * 0.08053720)));
    var angle = t + t * series + select(0.0, 0.25 * LTC_PI, past_eighth);
    angle = select(angle, 0.5 * LTC_PI - angle, abs(y) > abs(x));
    angle = select(angle, LTC_PI - angle, x < 0.0);
    return select(angle, -angle, y < 0.0);
}

// The largest power of two that is not above the magnitude; 0 below the smallest normal number. Scaling by it rounds nothing.
fn ltc_floor_power_of_two(x: f32) -> f32 {
    return bitcast<f32>(bitcast<u32>(x) & 0x7f800000u);
}
