// Textured flat lights: where and how wide the prefiltered texture is fetched, and the fetch (Heitz et al. 2016, sections
// 5.3 and 5.4). The light is its fraction times this colour. No bindings: the textures are a parameter. Needs: math, precise, lobe.
//
// All textures are in one, four floats a texel. Row k of it is the head of texture k: its texel 0 has the number of levels and the
// second level's sigma; texels 1 + 2 l and 2 + 2 l have, of level l, the place of its first texel and the index of its last
// one, and the coordinates (u, v) of its first texel and texels a unit of u and v. Level 0 is the picture, and the sigma of
// level l is 2^(l - 1) times the second's.

struct LtcTextureFetch {
    // Coordinates, anywhere: the filtered texture is defined beyond its square.
    uv: vec2f,
    // Standard deviation of the paper's one Gaussian in units of the texture's sides.
    sigma: f32,
}

// Farther and wider than this is all the same.
const LTC_FARTHEST_UV: f32 = 1e6;
// Standard deviations of the two Gaussians over that of the paper's one: sqrt(1/2) and sqrt(5).
const LTC_NARROW_SIGMA: f32 = 0.70710678;
const LTC_WIDE_SIGMA: f32 = 2.2360680;

// (u, v) is at origin + u axis_u + v axis_v, relative to the shading point in the shading frame. The place is the shading point's
// orthogonal projection onto the light's plane in cosine space, sigma = sqrt(r^2 / 2A) with r its distance and A the
// texture's area there.
//
// Nothing is taken to cosine space: with w = axis_u x axis_v and b = transpose(M) w, the normal there up to its length,
//     u = transpose(M) (axis_v x origin) . b / b^2,    v = transpose(M) (origin x axis_u) . b / b^2,
//     sigma^2 = det(M) (w . origin)^2 / (2 |b|^3),
// which M's condition hurts less than M^-1 would.
fn ltc_texture_fetch(lobe: LtcLobe, origin: vec3f, axis_u: vec3f, axis_v: vec3f) -> LtcTextureFetch {
    let nowhere = LtcTextureFetch(vec2f(0.5), LTC_FARTHEST_UV);
    let o_scale = ltc_largest_component(origin);
    let u_scale = ltc_largest_component(axis_u);
    let v_scale = ltc_largest_component(axis_v);
    if !(min(u_scale, v_scale) > LTC_TINY) {
        return nowhere;
    }
    let o = origin / max(o_scale, LTC_TINY);
    let u = axis_u / u_scale;
    let v = axis_v / v_scale;
    let product = ltc_cross(u, v);
    let w_scale = ltc_largest_component(product);
    // Below, the cross product is rounding.
    if !(w_scale > 1e-9) {
        return nowhere;
    }
    let w = product / w_scale;
    let b = ltc_cosine_normal(lobe, w);
    let square = dot(b, b);
    if !(square > LTC_TINY) {
        return nowhere;
    }
    // How far away the light is, in lengths of its axes.
    let u_away = min(o_scale / u_scale, 1e15);
    let v_away = min(o_scale / v_scale, 1e15);
    let along_u = dot(ltc_cosine_normal(lobe, ltc_cross(v, o)), b) / square;
    let along_v = dot(ltc_cosine_normal(lobe, ltc_cross(o, u)), b) / square;
    let uv = vec2f(along_u * u_away, along_v * v_away) / w_scale;
    let length_b = sqrt(square);
    let determinant = lobe.determinant * lobe.determinant / lobe.area_scale;
    let height = abs(dot(w, o)) / length_b;
    let sigma = height * sqrt(u_away) * sqrt(v_away) * sqrt(0.5 * determinant / (length_b * w_scale));
    let farthest = vec2f(LTC_FARTHEST_UV);
    return LtcTextureFetch(clamp(uv, -farthest, farthest), min(sigma, LTC_FARTHEST_UV));
}

// One level of a texture at (u, v): bilinear between its texels, constant beyond them.
fn ltc_texture_level(textures: texture_2d<f32>, number: u32, level: u32, uv: vec2f) -> vec3f {
    let place = textureLoad(textures, vec2u(1u + 2u * level, number), 0);
    let grid = textureLoad(textures, vec2u(2u + 2u * level, number), 0);
    let at = clamp((uv - grid.xy) * grid.zw, vec2f(0.0), place.zw);
    let low = floor(at);
    let t = at - low;
    let near = vec2u(place.xy + low);
    let far = vec2u(place.xy + min(low + vec2f(1.0), place.zw));
    let below = mix(
        textureLoad(textures, near, 0).xyz,
        textureLoad(textures, vec2u(far.x, near.y), 0).xyz,
        t.x,
    );
    let above = mix(
        textureLoad(textures, vec2u(near.x, far.y), 0).xyz,
        textureLoad(textures, far, 0).xyz,
        t.x,
    );
    return mix(below, above, t.y);
}

// Texture `number` through one Gaussian: linear between levels in log sigma, and towards the picture itself, whose sigma is 0, in
// sigma. Far outside the square a wider one is taken, so that it meets the texture.
fn ltc_texture_gaussian(textures: texture_2d<f32>, number: u32, fetch: LtcTextureFetch) -> vec3f {
    let head = textureLoad(textures, vec2u(0u, number), 0);
    let outside = max(max(-fetch.uv, fetch.uv - vec2f(1.0)), vec2f(0.0));
    let ratio = max(fetch.sigma, 0.5 * max(outside.x, outside.y)) / head.y;
    let position = min(select(1.0 + log2(max(ratio, 1.0)), ratio, ratio < 1.0), head.x - 1.0);
    let finer = floor(position);
    let coarser = min(finer + 1.0, head.x - 1.0);
    let fine = ltc_texture_level(textures, number, u32(finer), fetch.uv);
    let coarse = ltc_texture_level(textures, number, u32(coarser), fetch.uv);
    return mix(fine, coarse, position - finer);
}

// The colour of texture `number`. A cosine falls on a plane as (1 + d^2 / r^2)^-2 with the distance d there, to which a narrow and
// a wide Gaussian are nearer than the paper's one, ltc_texture_gaussian(textures, number, fetch), which takes half the fetches.
fn ltc_texture_colour(textures: texture_2d<f32>, number: u32, fetch: LtcTextureFetch) -> vec3f {
    let narrow = LtcTextureFetch(fetch.uv, LTC_NARROW_SIGMA * fetch.sigma);
    let wide = LtcTextureFetch(fetch.uv, LTC_WIDE_SIGMA * fetch.sigma);
    return 0.5 * (ltc_texture_gaussian(textures, number, narrow) + ltc_texture_gaussian(textures, number, wide));
}
