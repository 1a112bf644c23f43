// Where and how wide a textured light's prefiltered texture is fetched (Heitz et al. 2016, section 5.4). No bindings.
// Needs: math, precise, lobe.

struct LtcTextureFetch {
    // Coordinates, anywhere: the filtered texture is defined beyond its square.
    uv: vec2f,
    // Standard deviation of the filter in units of the texture's sides.
    sigma: f32,
}

const LTC_WIDEST_SIGMA: f32 = 4.0;

// (u, v) is at origin + u axis_u + v axis_v, relative to the shading point in the shading frame. The place is the shading point's
// orthogonal projection onto the light's plane in cosine space, sigma = sqrt(r^2 / 2A) with r its distance and A the
// texture's area there.
fn ltc_texture_fetch(lobe: LtcLobe, origin: vec3f, axis_u: vec3f, axis_v: vec3f) -> LtcTextureFetch {
    let middle = LtcTextureFetch(vec2f(0.5), LTC_WIDEST_SIGMA);
    let o = ltc_cosine_from_target(lobe, origin);
    let u = ltc_cosine_from_target(lobe, axis_u);
    let v = ltc_cosine_from_target(lobe, axis_v);
    let scale = max(ltc_largest_component(o), max(ltc_largest_component(u), ltc_largest_component(v)));
    if !(scale > LTC_TINY) {
        return middle;
    }
    let oo = o / scale;
    let uu = u / scale;
    let vv = v / scale;
    let product = ltc_cross(uu, vv);
    let n = ltc_unit_or_zero(product);
    let area = dot(product, n);
    if !(area * area > LTC_TINY) {
        return middle;
    }
    // -o = u x + v y + n z
    let uv = vec2f(dot(cross(vv, oo), n), dot(cross(oo, uu), n)) / area;
    let height = abs(dot(n, oo));
    return LtcTextureFetch(clamp(uv, vec2f(-1e6), vec2f(1e6)), min(height / sqrt(2.0 * area), 1e6));
}

// The coarser of the two levels of a texture array to mix, and how far towards it; the levels' sigma doubles from `finest` at
// layer 0 on, and `uv` far outside asks for a wider filter so that it meets the texture.
struct LtcTextureLevel {
    layer: u32,
    next: u32,
    t: f32,
}

fn ltc_texture_level(fetch: LtcTextureFetch, finest: f32, layers: u32) -> LtcTextureLevel {
    let outside = max(max(-fetch.uv, fetch.uv - vec2f(1.0)), vec2f(0.0));
    let sigma = max(fetch.sigma, 0.5 * max(outside.x, outside.y));
    let position = clamp(log2(max(sigma, finest) / finest), 0.0, f32(layers - 1u));
    let layer = u32(position);
    return LtcTextureLevel(layer, min(layer + 1u, layers - 1u), position - f32(layer));
}

// Where (u, v) is in a level of this sigma, which has a margin of four sigma around the texture.
fn ltc_texture_place(uv: vec2f, sigma: f32) -> vec2f {
    return (uv + vec2f(4.0 * sigma)) / (1.0 + 8.0 * sigma);
}
