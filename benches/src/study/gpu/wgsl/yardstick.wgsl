// What takes as long as the device is slow: a chain of products and sums, each waiting for the one before, from what is read.
fn pixel(at: vec2u, index: u32) -> vec4f {
    let p = timed_input[index];
    var x = p.alpha_x;
    for (var i = 0u; i < 200u; i++) {
        x = x * 0.999 + p.alpha_y;
    }
    return vec4f(x, p.position);
}
