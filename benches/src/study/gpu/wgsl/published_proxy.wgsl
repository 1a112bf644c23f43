// Without clipping: the sphere that has the quad's vector form factor, and its clipped form factor out of a table over the cosine of
// its direction and the length of the vector (Hill and Heitz 2016; Snyder 1996).

@group(1) @binding(3) var published_sphere: texture_2d<f32>;
@group(1) @binding(4) var published_filter: sampler;

fn timed_fraction(lobe: TimedLobe, position: vec3f, light: u32) -> f32 {
    let v0 = timed_points[4u * light].xyz - position;
    let v1 = timed_points[4u * light + 1u].xyz - position;
    let v3 = timed_points[4u * light + 3u].xyz - position;
    let behind = dot(v0, cross(v1 - v0, v3 - v0)) > 0.0;
    let a = normalize(lobe.inverse * v0);
    let b = normalize(lobe.inverse * v1);
    let c = normalize(lobe.inverse * (timed_points[4u * light + 2u].xyz - position));
    let d = normalize(lobe.inverse * v3);
    // Corners are counter-clockwise seen from the floor.
    let f = -(published_edge(a, b) + published_edge(b, c) + published_edge(c, d) + published_edge(d, a));
    let length = length(f);
    let z = f.z / length;
    let size = vec2f(textureDimensions(published_sphere));
    let at = (vec2f(0.5 * z + 0.5, length) * (size - 1.0) + 0.5) / size;
    let share = textureSampleLevel(published_sphere, published_filter, at, 0.0).w;
    return select(length * share, 0.0, behind);
}
