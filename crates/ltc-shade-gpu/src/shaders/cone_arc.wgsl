// Integrals along the boundary of a cut cone. No bindings. Needs: math.

// artanh(k m) / k for k^2 = kk in [0, 1), |k m| <= 1.
fn ltc_artanh_over(kk: f32, m: f32) -> f32 {
    let square = kk * m * m;
    if square < 0.04 {
        // The next term is square^5 / 11: 1e-8.
        let series = 0.33333333 + square * (0.2 + square * (0.14285714 + square * 0.11111111));
        return m * (1.0 + square * series);
    }
    let k = sqrt(kk);
    let x = min(k * abs(m), 0.99999988);
    return sign(m) * 0.5 * log((1.0 + x) / (1.0 - x)) / k;
}

// arctan(q y, x) / q for q^2 = qq >= 0: of two arguments, q y and x.
fn ltc_arctan_over(qq: f32, y: f32, x: f32) -> f32 {
    if qq <= 1e-30 {
        return y;
    }
    let q = sqrt(qq);
    return ltc_atan2(q * y, x) / q;
}

// The integral of (r x dr).n / |r|^2 along r = (A cos t, B sin t, 1) counter-clockwise, in closed form:
//     integral of (-n1 B cos t - n2 A sin t + n3 A B) / (1 + A^2 cos^2 t + B^2 sin^2 t) dt.
// The first term is an artanh of sin t, the second an arctan of cos t, the third an angle. Each is taken as one function of
// both ends, (cos t, sin t), so that short arcs keep their digits. `quarters` is how far it is from the one to the other.
fn ltc_ellipse_arc(widths: vec2f, n: vec3f, start: vec2f, end: vec2f, quarters: f32) -> f32 {
    let a = widths.x;
    let b = widths.y;
    let alpha = sqrt(1.0 + a * a);
    let beta = sqrt(1.0 + b * b);
    let gap = (a - b) * (a + b);
    let ratio = beta / alpha;
    let kk = gap / (alpha * alpha);
    let divisor = kk * (1.0 - start.y * end.y) + ratio * ratio;
    let cosine = ltc_artanh_over(kk, (end.y - start.y) / max(divisor, LTC_TINY));
    let qq = gap / (beta * beta);
    let sine = ltc_arctan_over(qq, end.x - start.x, 1.0 + qq * start.x * end.x);
    let turned = ltc_atan2(
        ratio * (start.x * end.y - start.y * end.x),
        start.x * end.x + ratio * ratio * start.y * end.y,
    );
    var even = turned;
    if turned < 0.0 {
        even = select(0.0, turned + 2.0 * LTC_PI, quarters > 1.0);
    } else if quarters > 3.0 {
        even = 2.0 * LTC_PI;
    }
    return n.y * (a / (beta * beta)) * sine - n.x * (b / (alpha * alpha)) * cosine
        + n.z * (a / alpha) * (b / beta) * even;
}

// Angle from p to q counter-clockwise around the unit vector `normal`. No chord of a cone is longer than pi: what rounding
// makes negative near pi is taken as such.
fn ltc_angle_around(normal: vec3f, p: vec3f, q: vec3f) -> f32 {
    let begin = ltc_unit_or_zero(p);
    let to = ltc_unit_or_zero(q);
    let angle = ltc_atan2(dot(normal, cross(begin, to)), dot(begin, to));
    return select(angle, angle + 2.0 * LTC_PI, angle < -0.5 * LTC_PI);
}
