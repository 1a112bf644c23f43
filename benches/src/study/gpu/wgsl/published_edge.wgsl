// The edge of a polygon over the clamped cosine, by the rational function in wide use: (a x b) theta / sin(theta) / (2 pi), for unit
// vectors (Heitz et al. 2016, eq. 11).
fn published_edge(a: vec3f, b: vec3f) -> vec3f {
    let x = dot(a, b);
    let y = abs(x);
    let v = (0.8543985 + (0.4965155 + 0.0145206 * y) * y) / (3.4175940 + (4.1616724 + y) * y);
    let turns = select(0.5 * inverseSqrt(max(1.0 - x * x, 1e-7)) - v, v, x > 0.0);
    return cross(a, b) * turns;
}
