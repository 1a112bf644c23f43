// Derivatives of what is known, one triangle over the whole target.

@vertex
fn everywhere(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    let corner = vec2f(f32((index << 1u) & 2u), f32(index & 2u));
    return vec4f(corner * 2.0 - 1.0, 0.0, 1.0);
}

@fragment
fn slopes(@builtin(position) at: vec4f) -> @location(0) vec4f {
    return vec4f(dpdx(3.0 * at.x), dpdy(5.0 * at.y), dpdx(at.y), fwidth(at.x));
}
