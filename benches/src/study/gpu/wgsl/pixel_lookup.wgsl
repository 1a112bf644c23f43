// The lobe in four numbers that hang on all of it: the cosines, in cosine space, of three directions about the mirrored view.
fn pixel(at: vec2u, index: u32) -> vec4f {
    let p = timed_input[index];
    let found = timed_find(p);
    let mirror = vec3f(-p.wo.xy, p.wo.z);
    return vec4f(
        normalize(timed_to_cosine(found.lobe, mirror)).z,
        normalize(timed_to_cosine(found.lobe, mirror + vec3f(0.3, 0.0, 0.1))).z,
        normalize(timed_to_cosine(found.lobe, mirror + vec3f(0.0, 0.3, 0.1))).z,
        found.reflectance,
    );
}
