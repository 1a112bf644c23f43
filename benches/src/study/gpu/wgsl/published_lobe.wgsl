// As published shaders have a lobe: the inverse matrix, and for lines M as well.
struct TimedLobe {
    inverse: mat3x3f,
    m: mat3x3f,
}

struct TimedFound {
    lobe: TimedLobe,
    reflectance: f32,
}

fn timed_to_cosine(lobe: TimedLobe, v: vec3f) -> vec3f {
    return lobe.inverse * v;
}
