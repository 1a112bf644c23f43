// The shading frame: x = tangent, y = bitangent, z = normal, right-handed. No bindings. Needs: math.

struct LtcFrame {
    tangent: vec3f,
    bitangent: vec3f,
    normal: vec3f,
}

// The frame of a unit normal with any tangent (Duff et al. 2017, "Building an Orthonormal Basis, Revisited").
fn ltc_any_tangent(n: vec3f) -> vec3f {
    let sign = select(1.0, -1.0, n.z < 0.0);
    let a = -1.0 / (sign + n.z);
    return vec3f(1.0 + sign * n.x * n.x * a, sign * n.x * n.y * a, -sign * n.x);
}

// The frame with this normal and with the tangent nearest to `tangent`; an arbitrary one where that is zero or parallel
// to the normal. A zero normal counts as +z.
fn ltc_frame(normal: vec3f, tangent: vec3f) -> LtcFrame {
    var n = ltc_unit_or_zero(normal);
    if dot(n, n) < 0.5 {
        n = vec3f(0.0, 0.0, 1.0);
    }
    let t = ltc_unit_or_zero(tangent);
    let in_surface = t - n * dot(t, n);
    // What is left of a parallel tangent is rounding error, whose direction means nothing.
    let keeps_a_direction = length(in_surface) > 2e-6;
    var x = ltc_any_tangent(n);
    if keeps_a_direction {
        x = ltc_unit_or_zero(in_surface);
    }
    return LtcFrame(x, cross(n, x), n);
}

fn ltc_shading_from_world(frame: LtcFrame, v: vec3f) -> vec3f {
    return vec3f(dot(v, frame.tangent), dot(v, frame.bitangent), dot(v, frame.normal));
}
