// Area lights by linearly transformed cosines, in closed form.
// GLSL ES 3.00, written by ltc 0.1.0 as
//   ltc shader --lang glsl-es --lights '' --features 'textured'
//
// Shading frame: x = tangent (carries alpha_x), y = bitangent (alpha_y), z = normal, right-handed. Lights are given in
// it, relative to the shading point; flat ones counter-clockwise seen from the side that emits. `wo` is a unit vector
// towards the eye. M (target_from_cosine) takes the clamped cosine to the lobe. A light's function gives the fraction of
// the lobe that sees it, in [0, 1]; 0 for a degenerate one. Inputs are finite: NaN and infinity are the caller's to
// refuse. alpha is the GGX width, the square of perceptual roughness; widths below the smallest are raised to it:
// alpha >= 0.0001.
//
// Textures (`ltc_shade_gpu::TextureAtlas`): all of them, filtered, in one 2D texture of RGBA32F, fetched without a sampler.
// Row k is the head of texture k: texel 0 has the number of levels and the second level's sigma; texels 1 + 2l and 2 + 2l
// have of level l (x and y of its first texel, texels in a row - 1, rows - 1) and (u and v of its first texel, texels a unit
// of u, of v). (u, v) lies at origin + u axis_u + v axis_v, given as lights are; a light that the texture fills has its origin
// at the first corner, axis_u towards the second, axis_v towards the last. From behind it is mirrored.
//
// Functions to call:
//   LtcTextureFetch ltc_texture_fetch(LtcLobe lobe, vec3 origin, vec3 axis_u, vec3 axis_v)
//   vec3 ltc_texture_colour(highp sampler2D textures, uint number, LtcTextureFetch fetch)
//   vec3 ltc_texture_gaussian(highp sampler2D textures, uint number, LtcTextureFetch fetch)
//   LtcLobe ltc_lobe(mat3x3 target_from_cosine)
//   LtcLobe ltc_cosine()
//
// Use, once for a surface point:
//   lobe = ltc_lobe(M), and ltc_cosine() for diffuse light
// The fraction of a textured quad or polygon is multiplied with its colour, for each lobe:
//   ltc_texture_colour(textures, number, ltc_texture_fetch(lobe, origin, axis_u, axis_v))
// ltc_texture_gaussian, with the same parameters, takes half the fetches and is farther off.
// Paste it behind `#version 300 es`. Textures are parameters: pass your sampler2DArray, sampler3D or
// sampler2D, with NEAREST filters unless hardware-filtering was asked for.


precision highp float;
precision highp int;
precision highp sampler2D;

// A vector as a sum, the first part of multiples of 2^-11.
struct LtcSplit {
    vec3 whole;
    vec3 rest;
};
struct LtcLobe {
    mat3x3 target_from_cosine;
    mat3x3 rows;
    float determinant_;
    float area_scale;
    bool valid;
};
struct LtcTextureFetch {
    vec2 uv;
    float sigma;
};
const float LTC_PI = 3.1415927;
const float LTC_TINY = 1e-37;
const float LTC_FARTHEST_UV = 1000000.0;
const float LTC_NARROW_SIGMA = 0.70710677;
const float LTC_WIDE_SIGMA = 2.236068;


float ltc_largest_component(vec3 v) {
    vec3 a = abs(v);
    return max(a.x, max(a.y, a.z));
}

// The unit vector of v, or zero for a vector that has no direction.
vec3 ltc_unit_or_zero(vec3 v) {
    float _e1 = ltc_largest_component(v);
    if (!((_e1 > LTC_TINY))) {
        return vec3(0.0);
    }
    vec3 u = (v / vec3(_e1));
    return (u / vec3(length(u)));
}

// Four-quadrant arc tangent of y / x, in [-pi, pi]; 0 for (0, 0). Absolute error below 3e-7.
//
// WGSL allows the built-in atan2 an error of 4096 ulp (5e-4): this one is as good on every device. The polynomial is a
// minimax fit of atan(t) / t on [0, tan(pi / 8)], relative error 2.1e-8.
float ltc_atan2(float y, float x) {
    float angle = 0.0;
    float low = min(abs(x), abs(y));
    float high = max(abs(x), abs(y));
    if (!((high > LTC_TINY))) {
        return 0.0;
    }
    bool past_eighth = (low > (0.41421357 * high));
    float t = ((past_eighth ? (low - high) : low) / (past_eighth ? (low + high) : high));
    float s = (t * t);
    float series = (s * (-0.3333295 + (s * (0.1997771 + (s * (-0.13877678 + (s * 0.0805372)))))));
    angle = ((t + (t * series)) + (past_eighth ? 0.7853982 : 0.0));
    float _e39 = angle;
    float _e41 = angle;
    angle = ((abs(y) > abs(x)) ? (1.5707964 - _e41) : _e39);
    float _e47 = angle;
    float _e49 = angle;
    angle = ((x < 0.0) ? (LTC_PI - _e49) : _e47);
    float _e54 = angle;
    float _e55 = angle;
    return ((y < 0.0) ? -(_e55) : _e54);
}

// The largest power of two that is not above the magnitude; 0 below the smallest normal number. Scaling by it rounds nothing.
float ltc_floor_power_of_two(float x) {
    return uintBitsToFloat((floatBitsToUint(x) & 2139095040u));
}

// The same, in a way that algebra does not see through. For magnitudes up to 1e30.
vec3 ltc_apart(vec3 v) {
    return max(v, vec3(-1e30));
}

vec3 ltc_leading(vec3 v) {
    return uintBitsToFloat((floatBitsToUint(v) & uvec3(4294963200u)));
}

// a * b - c * d to some 2^-36 of the products.
vec3 ltc_product_differences(vec3 a, vec3 b, vec3 c, vec3 d) {
    vec3 _e4 = ltc_leading(a);
    vec3 _e5 = ltc_leading(b);
    vec3 _e6 = ltc_leading(c);
    vec3 _e7 = ltc_leading(d);
    vec3 a_low = (a - _e4);
    vec3 b_low = (b - _e5);
    vec3 c_low = (c - _e6);
    vec3 d_low = (d - _e7);
    vec3 middle = (((_e4 * b_low) - (_e6 * d_low)) + ((a_low * _e5) - (c_low * _e7)));
    vec3 _e22 = ltc_apart(((_e4 * _e5) - (_e6 * _e7)));
    return (_e22 + (middle + ((a_low * b_low) - (c_low * d_low))));
}

// The cross product, each component to its own last digits where they do not cancel by more than 2^12.
vec3 ltc_cross(vec3 a, vec3 b) {
    vec3 _e6 = ltc_product_differences(a.yzx, b.zxy, a.zxy, b.yzx);
    return _e6;
}

// The nearest multiples of 2^-11. Of numbers up to 1, sums of products of these are exact, whatever their order: what is left
// beside them is small.
vec3 ltc_whole(vec3 v) {
    return (roundEven((v * 2048.0)) * 0.00048828125);
}

LtcSplit ltc_split(vec3 v) {
    vec3 _e1 = ltc_whole(v);
    return LtcSplit(_e1, (v - _e1));
}

LtcSplit ltc_split_sum(vec3 large, vec3 small) {
    vec3 _e2 = ltc_apart(large);
    vec3 _e4 = ltc_whole((_e2 + small));
    return LtcSplit(_e4, ((_e2 - _e4) + small));
}

// |a|^2 - |b|^2 to some 2^-33, coordinates and lengths up to about 1.
float ltc_difference_of_squares(LtcSplit a, LtcSplit b) {
    float middle = (dot(a.whole, a.rest) - dot(b.whole, b.rest));
    float small = (dot(a.rest, a.rest) - dot(b.rest, b.rest));
    vec3 _e24 = ltc_apart(vec3((dot(a.whole, a.whole) - dot(b.whole, b.whole))));
    return (_e24.x + ((2.0 * middle) + small));
}

// a . b to some 2^-33, coordinates up to 1.
float ltc_precise_dot(LtcSplit a, LtcSplit b) {
    float small = ((dot(a.whole, b.rest) + dot(a.rest, b.whole)) + dot(a.rest, b.rest));
    vec3 _e17 = ltc_apart(vec3(dot(a.whole, b.whole)));
    return (_e17.x + small);
}

float ltc_largest_entry(mat3x3 m) {
    float _e2 = ltc_largest_component(m[0]);
    float _e4 = ltc_largest_component(m[1]);
    float _e6 = ltc_largest_component(m[2]);
    return max(_e2, max(_e4, _e6));
}

// `target_from_cosine` may have any scale. Once for all lights of a point.
LtcLobe ltc_lobe(mat3x3 target_from_cosine) {
    float _e1 = ltc_largest_entry(target_from_cosine);
    mat3x3 m = (target_from_cosine * (1.0 / max(_e1, LTC_TINY)));
    vec3 _e9 = ltc_cross(m[1], m[2]);
    vec3 _e12 = ltc_cross(m[2], m[0]);
    vec3 _e15 = ltc_cross(m[0], m[1]);
    mat3x3 cofactors = mat3x3(_e9, _e12, _e15);
    float determinant_ = dot(m[0], cofactors[0]);
    float _e20 = ltc_largest_entry(cofactors);
    float scale = (1.0 / max(_e20, LTC_TINY));
    float scaled = (determinant_ * scale);
    return LtcLobe(m, (cofactors * scale), scaled, (scaled * scale), (scaled > 0.0));
}

// The clamped cosine itself, Lambert's lobe.
LtcLobe ltc_cosine() {
    mat3x3 identity = mat3x3(vec3(1.0, 0.0, 0.0), vec3(0.0, 1.0, 0.0), vec3(0.0, 0.0, 1.0));
    return LtcLobe(identity, identity, 1.0, 1.0, true);
}

// A direction of the lobe's space in cosine space, up to its length.
vec3 ltc_cosine_from_target(LtcLobe lobe, vec3 v) {
    return (v * lobe.rows);
}

// The normal of a plane through the origin in cosine space, up to its length.
vec3 ltc_cosine_normal(LtcLobe lobe, vec3 normal) {
    return (normal * lobe.target_from_cosine);
}

// The fraction of the lobe above the horizons: of a light in every direction. In cosine space the surface's horizon is a
// plane whose normal has the angle gamma to z; between both the cosine integrates to (1 + cos gamma) / 2.
float ltc_everywhere(LtcLobe lobe) {
    if (!(lobe.valid)) {
        return 0.0;
    }
    return 1.0;
}

// (u, v) is at origin + u axis_u + v axis_v, relative to the shading point in the shading frame. The place is the shading point's
// orthogonal projection onto the light's plane in cosine space, sigma = sqrt(r^2 / 2A) with r its distance and A the
// texture's area there.
//
// Nothing is taken to cosine space: with w = axis_u x axis_v and b = transpose(M) w, the normal there up to its length,
//     u = transpose(M) (axis_v x origin) . b / b^2,    v = transpose(M) (origin x axis_u) . b / b^2,
//     sigma^2 = det(M) (w . origin)^2 / (2 |b|^3),
// which M's condition hurts less than M^-1 would.
LtcTextureFetch ltc_texture_fetch(LtcLobe lobe, vec3 origin, vec3 axis_u, vec3 axis_v) {
    LtcTextureFetch nowhere = LtcTextureFetch(vec2(0.5), 1000000.0);
    float _e8 = ltc_largest_component(origin);
    float _e9 = ltc_largest_component(axis_u);
    float _e10 = ltc_largest_component(axis_v);
    if (!((min(_e9, _e10) > LTC_TINY))) {
        return nowhere;
    }
    vec3 o = (origin / vec3(max(_e8, LTC_TINY)));
    vec3 u = (axis_u / vec3(_e9));
    vec3 v = (axis_v / vec3(_e10));
    vec3 _e23 = ltc_cross(u, v);
    float _e24 = ltc_largest_component(_e23);
    if (!((_e24 > 1e-9))) {
        return nowhere;
    }
    vec3 w = (_e23 / vec3(_e24));
    vec3 _e30 = ltc_cosine_normal(lobe, w);
    float square = dot(_e30, _e30);
    if (!((square > LTC_TINY))) {
        return nowhere;
    }
    float u_away = min((_e8 / _e9), 1000000000000000.0);
    float v_away = min((_e8 / _e10), 1000000000000000.0);
    vec3 _e41 = ltc_cross(v, o);
    vec3 _e42 = ltc_cosine_normal(lobe, _e41);
    float along_u = (dot(_e42, _e30) / square);
    vec3 _e45 = ltc_cross(o, u);
    vec3 _e46 = ltc_cosine_normal(lobe, _e45);
    float along_v = (dot(_e46, _e30) / square);
    vec2 uv = (vec2((along_u * u_away), (along_v * v_away)) / vec2(_e24));
    float length_b = sqrt(square);
    float determinant_1 = ((lobe.determinant_ * lobe.determinant_) / lobe.area_scale);
    float height = (abs(dot(w, o)) / length_b);
    float sigma = (((height * sqrt(u_away)) * sqrt(v_away)) * sqrt(((0.5 * determinant_1) / (length_b * _e24))));
    vec2 farthest = vec2(1000000.0);
    return LtcTextureFetch(clamp(uv, -(farthest), farthest), min(sigma, LTC_FARTHEST_UV));
}

// One level of a texture at (u, v): bilinear between its texels, constant beyond them.
vec3 ltc_texture_level(highp sampler2D textures, uint number, uint level, vec2 uv) {
    vec4 place = texelFetch(textures, ivec2(uvec2((1u + (2u * level)), number)), 0);
    vec4 grid = texelFetch(textures, ivec2(uvec2((2u + (2u * level)), number)), 0);
    vec2 at = clamp(((uv - grid.xy) * grid.zw), vec2(0.0), place.zw);
    vec2 low = floor(at);
    vec2 t = (at - low);
    uvec2 near = uvec2((place.xy + low));
    uvec2 far = uvec2((place.xy + min((low + vec2(1.0)), place.zw)));
    vec4 _e40 = texelFetch(textures, ivec2(near), 0);
    vec4 _e46 = texelFetch(textures, ivec2(uvec2(far.x, near.y)), 0);
    vec3 below = mix(_e40.xyz, _e46.xyz, t.x);
    vec4 _e54 = texelFetch(textures, ivec2(uvec2(near.x, far.y)), 0);
    vec4 _e57 = texelFetch(textures, ivec2(far), 0);
    vec3 above = mix(_e54.xyz, _e57.xyz, t.x);
    return mix(below, above, t.y);
}

// Texture `number` through one Gaussian: linear between levels in log sigma, and towards the picture itself, whose sigma is 0, in
// sigma. Far outside the square a wider one is taken, so that it meets the texture.
vec3 ltc_texture_gaussian(highp sampler2D textures, uint number, LtcTextureFetch fetch) {
    vec4 head = texelFetch(textures, ivec2(uvec2(0u, number)), 0);
    vec2 outside = max(max(-(fetch.uv), (fetch.uv - vec2(1.0))), vec2(0.0));
    float ratio = (max(fetch.sigma, (0.5 * max(outside.x, outside.y))) / head.y);
    float position = min(((ratio < 1.0) ? ratio : (1.0 + log2(max(ratio, 1.0)))), (head.x - 1.0));
    float finer = floor(position);
    float coarser = min((finer + 1.0), (head.x - 1.0));
    vec3 _e47 = ltc_texture_level(textures, number, uint(finer), fetch.uv);
    vec3 _e50 = ltc_texture_level(textures, number, uint(coarser), fetch.uv);
    return mix(_e47, _e50, (position - finer));
}

// The colour of texture `number`. A cosine falls on a plane as (1 + d^2 / r^2)^-2 with the distance d there, to which a narrow and
// a wide Gaussian are nearer than the paper's one, ltc_texture_gaussian(textures, number, fetch), which takes half the fetches.
vec3 ltc_texture_colour(highp sampler2D textures, uint number, LtcTextureFetch fetch) {
    LtcTextureFetch narrow = LtcTextureFetch(fetch.uv, (LTC_NARROW_SIGMA * fetch.sigma));
    LtcTextureFetch wide = LtcTextureFetch(fetch.uv, (LTC_WIDE_SIGMA * fetch.sigma));
    vec3 _e13 = ltc_texture_gaussian(textures, number, narrow);
    vec3 _e14 = ltc_texture_gaussian(textures, number, wide);
    return (0.5 * (_e13 + _e14));
}

