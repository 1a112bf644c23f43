// The reflected sum over all lights, and the fractions of the first, second and last.
fn pixel(at: vec2u, index: u32) -> vec4f {
    let p = timed_input[index];
    let found = timed_find(p);
    var sum = 0.0;
    var first = 0.0;
    var second = 0.0;
    var last = 0.0;
    for (var i = 0u; i < timed_lights.x; i++) {
        last = timed_fraction(found.lobe, p.position, i);
        sum += last;
        if i == 0u {
            first = last;
        }
        if i == 1u {
            second = last;
        }
    }
    return vec4f(sum * found.reflectance, first, second, last);
}
