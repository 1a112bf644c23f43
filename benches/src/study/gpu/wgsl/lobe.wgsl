alias TimedLobe = LtcLobe;

struct TimedFound {
    lobe: LtcLobe,
    reflectance: f32,
}

fn timed_to_cosine(lobe: LtcLobe, v: vec3f) -> vec3f {
    return ltc_cosine_from_target(lobe, v);
}
