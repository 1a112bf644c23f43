// The cone of directions over an ellipse, and its axes by confocal coordinates. No bindings. Needs: math, precise.
//
// In axes along the half-axes r1 >= r2 and the normal, with the centre at (x, y, h), the ellipse's confocal ellipsoid through
// the origin belongs to the one root lambda > 0 of
//     x^2 / (lambda + r1^2) + y^2 / (lambda + r2^2) + h^2 / lambda = 1,
// and its normal g = (x / (lambda + r1^2), y / (lambda + r2^2), h / lambda) is the cone's axis. All terms are positive: neither
// coincident eigenvalues of the cone's quadric nor an ellipse that is seen edge-on, near by or far away cancel digits. The
// half-axes themselves are not needed.

struct LtcCone {
    c: vec3f,
    u: vec3f,
    v: vec3f,
    // |u x v|
    area: f32,
    // Distance of the plane.
    h: f32,
    lambda: f32,
    // lambda^2 + lambda (u^2 + v^2) + |u x v|^2
    d: f32,
    // Not of unit length.
    g: vec3f,
    // Its part in the ellipse's plane: near the plane the other one would drown products with u and v in rounding.
    g_in_plane: vec3f,
    // False without area.
    valid: bool,
}

// (root P + W) / (root^2 + root T + A^2) + H / root = 1, with all coefficients >= 0.
struct LtcConfocal {
    // T
    trace: f32,
    // A^2
    determinant: f32,
    // P
    offset: f32,
    // W
    crossed: f32,
    twice_crossed: f32,
    // H > 0
    height: f32,
}

// The root > 0 of w / (root + p) + hh / root = 1.
fn ltc_one_pole(w: f32, p: f32, hh: f32) -> f32 {
    let half = 0.5 * (w + hh - p);
    let product = hh * p;
    let root = sqrt(half * half + product);
    return select(product / max(root - half, LTC_TINY), half + root, half >= 0.0);
}

fn ltc_confocal_denominator(e: LtcConfocal, root: f32) -> f32 {
    return root * (root + e.trace) + e.determinant;
}

// The first term is replaced by w / (root + p) with the same value and slope; the quadratic that is left has a closed form. For a
// circle this is exact at once, for a distant ellipse nearly so; it converges quadratically.
fn ltc_confocal_root(e: LtcConfocal) -> f32 {
    let pole = select(0.0, e.trace - e.crossed / max(e.offset, LTC_TINY), e.offset > LTC_TINY);
    var root = ltc_one_pole(e.offset, max(pole, 0.0), e.height);
    for (var i = 0; i < 16; i++) {
        let numerator = root * e.offset + e.crossed;
        let slope = root * (root * e.offset + 2.0 * e.crossed) + e.twice_crossed;
        if !(slope > LTC_TINY) {
            break;
        }
        let weight = numerator / slope;
        // Above 0 but for rounding.
        let next_pole = max(ltc_confocal_denominator(e, root) * weight - root, 0.0);
        let next = ltc_one_pole(numerator * weight, next_pole, e.height);
        let moved = abs(next - root);
        root = next;
        if moved <= 3e-4 * root {
            break;
        }
    }
    // H / root is one of the terms that sum to 1.
    return max(root, e.height);
}

// The cone over c + u cos t + v sin t, whose coordinates should be near 1. u x v points away from the origin; where rounding
// says otherwise the origin is next to the ellipse's plane, on that side.
fn ltc_cone(c: vec3f, u: vec3f, v: vec3f) -> LtcCone {
    let product = ltc_cross(u, v);
    let k = ltc_unit_or_zero(product);
    let area = dot(product, k);
    let valid = area * area > LTC_TINY;
    // The floor keeps h / lambda in range; it is far below what the rounding of the input leaves of h.
    let h = max(dot(c, k), 1.4210855e-14);
    let in_plane = c - k * h;
    let u_turned = cross(k, u);
    let v_turned = cross(k, v);
    let uc = dot(u_turned, c);
    let vc = dot(v_turned, c);
    let q = u_turned * uc + v_turned * vc;
    let ellipse = LtcConfocal(
        dot(u, u) + dot(v, v),
        area * area,
        dot(in_plane, in_plane),
        uc * uc + vc * vc,
        dot(q, q),
        h * h,
    );
    let lambda = ltc_confocal_root(ellipse);
    let d = max(ltc_confocal_denominator(ellipse, lambda), LTC_TINY);
    let g_in_plane = (in_plane * lambda + q) * (1.0 / d);
    return LtcCone(in_plane + k * h, u, v, area, h, lambda, d, g_in_plane + k * (h / lambda), g_in_plane, valid);
}

// The integral of w.n / pi over the cone, nothing cut: the vector irradiance of an elliptical cone of half-widths atan A and
// atan B lies along its axis and has length A B / sqrt((1 + A^2) (1 + B^2)).
fn ltc_cone_uncut(cone: LtcCone, n: vec3f) -> f32 {
    return cone.area * (cone.h / cone.lambda) * dot(cone.g, n) / (dot(cone.g, cone.g) * sqrt(cone.d));
}

// The cone's own axes: it is over the ellipse (A cos t, B sin t, 1) in the right-handed axes e1, e2, e3.
struct LtcConeAxes {
    e1: vec3f,
    e2: vec3f,
    e3: vec3f,
    // A >= B >= 0, tangents of the half-widths.
    widths: vec2f,
    // False where rounding leaves nothing of them.
    valid: bool,
}

// The weights of u and v in the longer half-axis of u cos t + v sin t: a Jacobi rotation of the Gram matrix, divided by its
// larger entry so that nothing underflows.
fn ltc_longer_half_axis(uu: f32, vv: f32, uv: f32) -> vec2f {
    let larger = max(max(uu, vv), LTC_TINY);
    let half_gap = 0.5 * (1.0 - min(uu, vv) / larger);
    let mixed = uv / larger;
    let radius = sqrt(half_gap * half_gap + mixed * mixed);
    var turned = vec2f(1.0, 0.0);
    if radius > LTC_TINY {
        let cosine = sqrt(0.5 * (1.0 + half_gap / radius));
        turned = vec2f(cosine, mixed / (2.0 * radius * cosine));
    }
    return select(turned.yx, turned, uu >= vv);
}

// (u.g, v.g, 1) / (|g| sqrt(lambda)) is a unit vector of the Lorentz metric; the boost that belongs to it takes u and v to
// conjugate half-axes of the cross-section at right angles to g.
fn ltc_cone_axes(cone: LtcCone) -> LtcConeAxes {
    let root = sqrt(cone.lambda);
    let gamma = 1.0 / max(length(cone.g) * root, LTC_TINY);
    let bu = dot(cone.u, cone.g_in_plane) * gamma;
    let bv = dot(cone.v, cone.g_in_plane) * gamma;
    let shift = (cone.u * bu + cone.v * bv) * (1.0 / (1.0 + gamma)) - cone.c;
    let u = cone.u + shift * bu;
    let v = cone.v + shift * bv;
    let e3 = ltc_unit_or_zero(cone.g);
    let weights = ltc_longer_half_axis(dot(u, u), dot(v, v), dot(u, v));
    let rough = u * weights.x + v * weights.y;
    // Rounding can leave a little of the axis in a short half-axis.
    let longer = rough - e3 * dot(rough, e3);
    let width = length(longer);
    let e1 = ltc_unit_or_zero(longer);
    let valid = dot(e1, e1) > 0.5 && dot(e3, e3) > 0.5 && width * root > LTC_TINY;
    let a = width / max(root, LTC_TINY);
    let b = cone.area * (cone.h / max(root, LTC_TINY)) / max(width * root, LTC_TINY);
    return LtcConeAxes(e1, cross(e3, e1), e3, vec2f(a, min(a, b)), valid);
}
