// Heitz et al. 2016, section 5.1: the quad in cosine space, clipped to its horizon by sixteen cases, and the sum over its edges. Not
// clipped to the surface's horizon.

struct PublishedPolygon {
    n: u32,
    p0: vec3f,
    p1: vec3f,
    p2: vec3f,
    p3: vec3f,
    p4: vec3f,
}

// Where the edge between a, above, and b, below, meets the horizon.
fn published_cut(a: vec3f, b: vec3f) -> vec3f {
    return b * a.z - a * b.z;
}

fn published_clip(a: vec3f, b: vec3f, c: vec3f, d: vec3f) -> PublishedPolygon {
    let o = vec3f(0.0);
    let above = vec4f(a.z, b.z, c.z, d.z) > vec4f(0.0);
    switch dot(select(vec4u(0u), vec4u(1u, 2u, 4u, 8u), above), vec4u(1u)) {
        case 1u: { return PublishedPolygon(3u, a, published_cut(a, b), published_cut(a, d), a, o); }
        case 2u: { return PublishedPolygon(3u, published_cut(b, a), b, published_cut(b, c), published_cut(b, a), o); }
        case 3u: { return PublishedPolygon(4u, a, b, published_cut(b, c), published_cut(a, d), a); }
        case 4u: { return PublishedPolygon(3u, published_cut(c, b), c, published_cut(c, d), published_cut(c, b), o); }
        case 6u: { return PublishedPolygon(4u, published_cut(b, a), b, c, published_cut(c, d), published_cut(b, a)); }
        case 7u: { return PublishedPolygon(5u, a, b, c, published_cut(c, d), published_cut(a, d)); }
        case 8u: { return PublishedPolygon(3u, published_cut(d, c), d, published_cut(d, a), published_cut(d, c), o); }
        case 9u: { return PublishedPolygon(4u, a, published_cut(a, b), published_cut(d, c), d, a); }
        case 11u: { return PublishedPolygon(5u, a, b, published_cut(b, c), published_cut(d, c), d); }
        case 12u: { return PublishedPolygon(4u, published_cut(d, a), published_cut(c, b), c, d, published_cut(d, a)); }
        case 13u: { return PublishedPolygon(5u, a, published_cut(a, b), published_cut(c, b), c, d); }
        case 14u: { return PublishedPolygon(5u, published_cut(b, a), b, c, d, published_cut(d, a)); }
        case 15u: { return PublishedPolygon(4u, a, b, c, d, a); }
        default: { return PublishedPolygon(0u, o, o, o, o, o); }
    }
}

fn timed_fraction(lobe: TimedLobe, position: vec3f, light: u32) -> f32 {
    let clipped = published_clip(
        lobe.inverse * (timed_points[4u * light].xyz - position),
        lobe.inverse * (timed_points[4u * light + 1u].xyz - position),
        lobe.inverse * (timed_points[4u * light + 2u].xyz - position),
        lobe.inverse * (timed_points[4u * light + 3u].xyz - position),
    );
    if clipped.n == 0u {
        return 0.0;
    }
    let p0 = normalize(clipped.p0);
    let p1 = normalize(clipped.p1);
    let p2 = normalize(clipped.p2);
    let p3 = normalize(clipped.p3);
    var sum = published_edge(p0, p1).z + published_edge(p1, p2).z + published_edge(p2, p3).z;
    if clipped.n >= 4u {
        let p4 = normalize(clipped.p4);
        sum += published_edge(p3, p4).z;
        if clipped.n == 5u {
            sum += published_edge(p4, p0).z;
        }
    }
    // The lights face the floor; which way round their corners look hangs on the sign of det M.
    return abs(sum);
}
