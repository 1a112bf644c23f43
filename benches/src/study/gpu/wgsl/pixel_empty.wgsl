// What every form does beside its work: read a pixel, write one.
fn pixel(at: vec2u, index: u32) -> vec4f {
    let p = timed_input[index];
    return vec4f(p.position.xy + p.wo.xy, p.wo.z + p.alpha_x, p.alpha_y);
}
