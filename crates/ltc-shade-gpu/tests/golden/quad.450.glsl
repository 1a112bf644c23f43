// Area lights by linearly transformed cosines, in closed form.
// GLSL 4.50, written by ltc 0.1.0 as
//   ltc shader --lang glsl --lights 'quad' --features 'isotropic,surface-horizon,cosine-horizon,fresnel'
//
// Shading frame: x = tangent (carries alpha_x), y = bitangent (alpha_y), z = normal, right-handed. Lights are given in
// it, relative to the shading point; flat ones counter-clockwise seen from the side that emits. `wo` is a unit vector
// towards the eye. M (target_from_cosine) takes the clamped cosine to the lobe. A light's function gives the fraction of
// the lobe that sees it, in [0, 1]; 0 for a degenerate one. Inputs are finite: NaN and infinity are the caller's to
// refuse. alpha is the GGX width, the square of perceptual roughness; widths below the smallest are raised to it:
// alpha >= 0.0001.
//
// Tables (`ltc export NAME --format ktx2 --precision f32`): 3 groups of RGBA32F texels, m00 m01 m02 m10 |
// m11 m12 m20 m21 | m22 magnitude fresnel 0, with M row-major. A last number of 1 says that the two before it are what
// a closed form leaves of them; the lookup adds it (`ltc_table::ClosedForm`).
//   isotropic: 2D array, x = alpha node, y = theta node, layer = group; LtcAxes has theta and alpha.
// LtcAxis of an axis of the manifest with `len` nodes over [from, to], u its mapping:
//   low = u(from), scale = (len - 1) / (u(to) - u(from)), last = len - 1, mapping =
//   0 for linear: u(x) = x
//   1 for sqrt: u(x) = sqrt(x)
//   2 for sqrt_one_minus_cos: u(x) = sqrt(1 - cos x)
//   3 for half_tangent: u(x) = tan(x / 2)
//   4 for grazing_half_tangent: u(x) = t / (2 - t), t = tan(x / 2)
// Four u32 or f32 each, an axis takes 16 bytes, LtcAxes 64 in the order theta, phi, alpha, lambda.
//
// Functions to call:
//   LtcLookup ltc_lookup_isotropic(sampler2DArray texture_3, LtcAxes axes, vec3 wo, float alpha)
//   vec3 ltc_reflectance(vec3 f0, float f90, float magnitude, float fresnel)
//   LtcLobe ltc_lobe(mat3x3 target_from_cosine)
//   LtcLobe ltc_cosine()
//   float ltc_quad(LtcLobe lobe, vec3 v0, vec3 v1, vec3 v2, vec3 v3)
//
// Use, once for a surface point:
//   found = ltc_lookup_isotropic(texture, axes, wo, alpha)
//   lobe = ltc_lobe(found.m), and ltc_cosine() for diffuse light
// and for each of its lights:
//   radiance * (F0 * found.magnitude + (F90 - F0) * found.fresnel) * fraction
// Paste it behind `#version 450`. Textures are parameters: pass your sampler2DArray, sampler3D or
// sampler2D.

// How an axis spaces its nodes; filled from the table, see `AxisUniform` in Rust.
struct LtcAxis {
    float low;
    float scale;
    float last;
    uint mapping;
};
struct LtcAxes {
    LtcAxis theta;
    LtcAxis phi;
    LtcAxis alpha;
    LtcAxis lambda;
};
// A place along an axis: between nodes `cell` and `cell + 1`, `t` of the way.
struct LtcPlace {
    uint cell;
    float t;
};
// The three texels of an entry, or of an interpolation between entries:
// m00 m01 m02 m10, m11 m12 m20 m21, m22 magnitude fresnel 0; in a table with a closed form the third is m22, what the form leaves of both,
// and 1.
struct LtcTexels {
    vec4 g0;
    vec4 g1;
    vec4 g2;
};
struct LtcLookup {
    mat3x3 m;
    float magnitude;
    float fresnel;
};
struct LtcIsotropicPlace {
    LtcPlace theta;
    LtcPlace alpha;
};
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
// A vertex as a direction: its length means nothing.
struct LtcCorner {
    vec3 surface;
    vec3 cosine;
};
struct LtcBoundary {
    LtcCorner first;
    LtcCorner previous;
    bool started;
    LtcCorner entry;
    LtcCorner exit;
    bool has_entry;
    bool has_exit;
    float sum;
};
struct LtcArcs {
    float sum;
    vec3 exit;
    vec3 entry;
    vec2 cosine_exit;
    vec2 cosine_entry;
    vec2 crossings;
    bool half_turn;
};
const float LTC_PI = 3.1415927;
const float LTC_TINY = 1e-37;
const float LTC_ALPHA_MIN = 0.0001;
const uint LTC_LINEAR = 0u;
const uint LTC_SQRT = 1u;
const uint LTC_SQRT_ONE_MINUS_COS = 2u;
const uint LTC_HALF_TANGENT = 3u;
const uint LTC_GRAZING_HALF_TANGENT = 4u;
const vec2 LTC_FORM_M1_ = vec2(7.5, 0.035);
const vec2 LTC_FORM_M2_ = vec2(0.5, 0.4);
const float LTC_FORM_LEAST_M = 1e-6;
const vec3 LTC_FORM_MAGNITUDE = vec3(-0.471, -0.924, 0.032);
const vec4 LTC_FORM_FRESNEL = vec4(0.869, 0.118, -0.293, -1.372);


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

LtcPlace ltc_place(LtcAxis axis, float coordinate) {
    float position = clamp(((coordinate - axis.low) * axis.scale), 0.0, axis.last);
    float cell = min(floor(position), (axis.last - 1.0));
    return LtcPlace(uint(cell), (position - cell));
}

// For every quantity but theta; the mappings by sine and cosine are for theta alone.
LtcPlace ltc_place_of_value(LtcAxis axis, float value) {
    LtcPlace _e9 = ltc_place(axis, ((axis.mapping == LTC_SQRT) ? sqrt(max(value, 0.0)) : value));
    return _e9;
}

// The place of the polar angle of the unit vector wo, without the cancellation that acos and 1 - cos have near 0.
LtcPlace ltc_place_of_theta(LtcAxis axis, vec3 wo) {
    float cosine = max(wo.z, 0.0);
    float squared_sine = ((wo.x * wo.x) + (wo.y * wo.y));
    if ((axis.mapping == LTC_SQRT_ONE_MINUS_COS)) {
        LtcPlace _e19 = ltc_place(axis, sqrt((squared_sine / (1.0 + cosine))));
        return _e19;
    }
    if ((axis.mapping == LTC_HALF_TANGENT)) {
        LtcPlace _e27 = ltc_place(axis, (sqrt(squared_sine) / (1.0 + cosine)));
        return _e27;
    }
    if ((axis.mapping == LTC_GRAZING_HALF_TANGENT)) {
        float sine = sqrt(squared_sine);
        LtcPlace _e38 = ltc_place(axis, (sine / ((2.0 + (2.0 * cosine)) - sine)));
        return _e38;
    }
    float _e40 = ltc_atan2(sqrt(squared_sine), cosine);
    LtcPlace _e41 = ltc_place_of_value(axis, _e40);
    return _e41;
}

mat3x3 ltc_matrix(LtcTexels texels) {
    return mat3x3(vec3(texels.g0.x, texels.g0.w, texels.g1.z), vec3(texels.g0.y, texels.g1.x, texels.g1.w), vec3(texels.g0.z, texels.g1.y, texels.g2.x));
}

LtcTexels ltc_blend(LtcTexels a, LtcTexels b, float t) {
    return LtcTexels(mix(a.g0, b.g0, t), mix(a.g1, b.g1, t), mix(a.g2, b.g2, t));
}

// The nearest node to a place.
LtcPlace ltc_nearest(LtcPlace place) {
    return LtcPlace(place.cell, ((place.t > 0.5) ? 1.0 : 0.0));
}

uint ltc_nearest_node(LtcPlace place) {
    return (place.cell + ((place.t > 0.5) ? 1u : 0u));
}

// Whether the matrix is a lobe's: det M > 0. Entries have it, but very thin lobes that lie askew to each other may
// interpolate to a matrix without; the nearest entry answers then, as on the CPU.
bool ltc_regular(LtcTexels texels) {
    mat3x3 _e1 = ltc_matrix(texels);
    return (dot(_e1[0], cross(_e1[1], _e1[2])) > 0.0);
}

// The magnitude and Fresnel term of `texels` with the matrix of `other`.
LtcTexels ltc_with_matrix(LtcTexels texels, LtcTexels other) {
    return LtcTexels(other.g0, other.g1, vec4(other.g2.x, texels.g2.yzw));
}

// The weight of the upper or lower node of a place.
float ltc_weight(LtcPlace place, uint upper) {
    return ((upper == 1u) ? place.t : (1.0 - place.t));
}

// The weights of four neighbours: neither node upper, that of a, that of b, both.
vec4 ltc_weights(LtcPlace a, LtcPlace b) {
    vec2 low = (vec2((1.0 - a.t), a.t) * (1.0 - b.t));
    vec2 high = (vec2((1.0 - a.t), a.t) * b.t);
    return vec4(low, high);
}

// The place in texels, for a filtering fetch.
float ltc_texel(LtcPlace place) {
    return ((float(place.cell) + place.t) + 0.5);
}

// `wo` is a unit vector in the shading frame.
LtcIsotropicPlace ltc_isotropic_place(LtcAxes axes, vec3 wo, float alpha) {
    LtcPlace _e4 = ltc_place_of_theta(axes.theta, wo);
    LtcPlace _e6 = ltc_place_of_value(axes.alpha, alpha);
    return LtcIsotropicPlace(_e4, _e6);
}

// Turns the entry, which is for phi = 0, to the azimuth of `wo`: M(phi) = R(phi) M(0) R(-phi). For wo along the normal,
// which has no azimuth, every turn is the same lobe and none is taken.
LtcLookup ltc_isotropic_decode(LtcTexels texels, vec3 wo) {
    vec3 _e5 = ltc_unit_or_zero(vec3(wo.xy, 0.0));
    vec2 azimuth = ((dot(_e5, _e5) > 0.5) ? _e5.xy : vec2(1.0, 0.0));
    mat3x3 turn = mat3x3(vec3(azimuth.x, azimuth.y, 0.0), vec3(-(azimuth.y), azimuth.x, 0.0), vec3(0.0, 0.0, 1.0));
    mat3x3 _e28 = ltc_matrix(texels);
    mat3x3 m = ((turn * _e28) * transpose(turn));
    return LtcLookup(m, texels.g2.y, texels.g2.z);
}

// Between four neighbours of one layer.
vec4 ltc_fetch_four_layer(sampler2DArray texture_, uvec2 at, uint layer, vec4 weights) {
    vec4 _e6 = texelFetch(texture_, ivec3(at, layer), 0);
    vec4 _e14 = texelFetch(texture_, ivec3((at + uvec2(1u, 0u)), layer), 0);
    vec4 _e23 = texelFetch(texture_, ivec3((at + uvec2(0u, 1u)), layer), 0);
    vec4 _e32 = texelFetch(texture_, ivec3((at + uvec2(1u, 1u)), layer), 0);
    return ((((weights.x * _e6) + (weights.y * _e14)) + (weights.z * _e23)) + (weights.w * _e32));
}

LtcTexels ltc_fetch_isotropic(sampler2DArray texture_1, LtcIsotropicPlace place) {
    uvec2 at = uvec2(place.alpha.cell, place.theta.cell);
    vec4 _e9 = ltc_weights(place.alpha, place.theta);
    vec4 _e11 = ltc_fetch_four_layer(texture_1, at, 0u, _e9);
    vec4 _e13 = ltc_fetch_four_layer(texture_1, at, 1u, _e9);
    vec4 _e15 = ltc_fetch_four_layer(texture_1, at, 2u, _e9);
    return LtcTexels(_e11, _e13, _e15);
}

// The nearest entry alone.
LtcTexels ltc_fetch_nearest_isotropic(sampler2DArray texture_2, LtcIsotropicPlace place) {
    uint _e3 = ltc_nearest_node(place.alpha);
    uint _e5 = ltc_nearest_node(place.theta);
    uvec2 at = uvec2(_e3, _e5);
    vec4 _e9 = texelFetch(texture_2, ivec3(at, 0), 0);
    vec4 _e12 = texelFetch(texture_2, ivec3(at, 1), 0);
    vec4 _e15 = texelFetch(texture_2, ivec3(at, 2), 0);
    return LtcTexels(_e9, _e12, _e15);
}

// The table's answer for the unit vector `wo`, in the shading frame.
LtcLookup ltc_lookup_isotropic(sampler2DArray texture_3, LtcAxes axes, vec3 wo, float alpha) {
    LtcTexels texels = LtcTexels(vec4(0.0), vec4(0.0), vec4(0.0));
    LtcIsotropicPlace _e4 = ltc_isotropic_place(axes, wo, alpha);
    LtcTexels _e5 = ltc_fetch_isotropic(texture_3, _e4);
    texels = _e5;
    LtcTexels _e7 = texels;
    bool _e8 = ltc_regular(_e7);
    if (!(_e8)) {
        LtcTexels _e10 = texels;
        LtcTexels _e11 = ltc_fetch_nearest_isotropic(texture_3, _e4);
        LtcTexels _e12 = ltc_with_matrix(_e10, _e11);
        texels = _e12;
    }
    LtcTexels _e13 = texels;
    LtcLookup _e14 = ltc_isotropic_decode(_e13, wo);
    return _e14;
}

// Directional reflectance F0 * n + (F90 - F0) * f, with n = integral of rho cos at F = 1 and f the same weighted by
// (1 - wo.wh)^5. Never below 0.
vec3 ltc_reflectance(vec3 f0, float f90, float magnitude, float fresnel) {
    return max(((f0 * magnitude) + ((vec3(f90) - f0) * fresnel)), vec3(0.0));
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
    vec3 _e8 = ltc_cosine_normal(lobe, vec3(0.0, 0.0, 1.0));
    vec3 _e9 = ltc_unit_or_zero(_e8);
    float tilt = _e9.z;
    return clamp((0.5 + (0.5 * tilt)), 0.0, 1.0);
}

// The angle whose sine and cosine these are, up to one factor; sine >= 0.
float ltc_edge_angle(float sine, float cosine) {
    float _e2 = ltc_atan2(sine, cosine);
    return _e2;
}

LtcBoundary ltc_boundary() {
    LtcCorner none = LtcCorner(vec3(0.0), vec3(0.0));
    return LtcBoundary(none, none, false, none, none, false, false, 0.0);
}

LtcCorner ltc_corner(LtcLobe lobe, vec3 vertex) {
    float _e2 = ltc_largest_component(vertex);
    vec3 surface = (vertex * (1.0 / _e2));
    vec3 _e6 = ltc_cosine_from_target(lobe, surface);
    return LtcCorner(surface, _e6);
}

// Azimuth in [-pi, pi] from its sine and cosine.
float ltc_azimuth(float sine, float cosine) {
    float _e2 = ltc_atan2(sine, cosine);
    return _e2;
}

// Products of a, above, and b, below, whose cross product is `normal`, with the point abs(b.z) * a + abs(a.z) * b between
// them on the horizon. It is also parallel to normal x z; of both forms the one that does not cancel is taken.
vec2 ltc_horizon_cosines(vec3 a, vec3 b, vec3 normal, float length_) {
    vec2 steep = vec2(((a.x * normal.y) - (a.y * normal.x)), ((b.x * normal.y) - (b.y * normal.x)));
    float cosine = dot(a, b);
    vec2 flat_ = vec2(((a.z * cosine) - (b.z * dot(a, a))), ((a.z * dot(b, b)) - (b.z * cosine)));
    return ((dot(normal.xy, normal.xy) > ((0.01 * length_) * length_)) ? steep : flat_);
}

// The integral along the great circle from a to b, whose cross product is `normal` times `scale` > 0; its part below the
// horizon dropped onto the horizon. Equal and antipodal ends span no plane and give 0.
float ltc_arc(vec3 a, vec3 b, vec3 normal, float scale) {
    vec3 _e4 = ltc_unit_or_zero(normal);
    float length_1 = (dot(normal, _e4) * scale);
    if (!((length_1 > 0.0))) {
        return 0.0;
    }
    bool a_above = (a.z >= 0.0);
    bool b_above = (b.z >= 0.0);
    if ((a_above != b_above)) {
        vec3 upper = (a_above ? a : b);
        vec3 lower = (a_above ? b : a);
        vec3 oriented = (a_above ? _e4 : -(_e4));
        vec2 _e23 = ltc_horizon_cosines(upper, lower, (oriented * length_1), length_1);
        float _e27 = ltc_edge_angle((upper.z * length_1), _e23.x);
        float above = (_e27 * oriented.z);
        float _e36 = ltc_azimuth(((-(lower.z) * length_1) * oriented.z), _e23.y);
        return (a_above ? (above + _e36) : -((above + _e36)));
    }
    if (!(a_above)) {
        float _e47 = ltc_azimuth((length_1 * _e4.z), dot(a.xy, b.xy));
        return _e47;
    }
    float _e49 = ltc_edge_angle(length_1, dot(a, b));
    return (_e49 * _e4.z);
}

// The integral along the edge from a to b, nothing cut by the surface.
float ltc_edge(LtcLobe lobe, LtcCorner a, LtcCorner b, float kept) {
    vec3 _e6 = ltc_cross(a.surface, b.surface);
    vec3 _e7 = ltc_cosine_normal(lobe, _e6);
    float _e12 = ltc_arc(a.cosine, b.cosine, _e7, (lobe.area_scale * kept));
    return _e12;
}

// Where the arc from a to b crosses the surface's horizon.
LtcCorner ltc_horizon_corner(LtcCorner a, LtcCorner b) {
    float to_b = abs(b.surface.z);
    float to_a = abs(a.surface.z);
    vec3 point = ((a.surface * to_b) + (b.surface * to_a));
    return LtcCorner(vec3(point.xy, 0.0), ((a.cosine * to_b) + (b.cosine * to_a)));
}

// The arc from `exit` to `entry` along the surface's horizon.
float ltc_boundary_close(LtcLobe lobe, LtcCorner exit, LtcCorner entry) {
    vec3 _e5 = ltc_cross(exit.surface, entry.surface);
    float up = _e5.z;
    vec3 _e12 = ltc_cosine_normal(lobe, vec3(0.0, 0.0, up));
    float _e14 = ltc_arc(exit.cosine, entry.cosine, _e12, lobe.area_scale);
    return _e14;
}

// Adds the edge from a to b, cut by the surface's horizon: what keeps lights below it from leaking into a tilted lobe.
void ltc_boundary_edge(inout LtcBoundary boundary, LtcLobe lobe, LtcCorner a, LtcCorner b) {
    bool local = false;
    vec3 begin = vec3(0.0);
    vec3 to = vec3(0.0);
    float kept = 1.0;
    bool a_above = (a.surface.z >= 0.0);
    bool b_above = (b.surface.z >= 0.0);
    if (!(a_above)) {
        local = b_above;
    } else {
        local = true;
    }
    bool _e16 = local;
    if (!(_e16)) {
        return;
    }
    vec3 _e20 = ltc_cross(a.surface, b.surface);
    vec3 _e21 = ltc_cosine_normal(lobe, _e20);
    begin = a.cosine;
    to = b.cosine;
    if ((a_above != b_above)) {
        LtcCorner _e29 = ltc_horizon_corner(a, b);
        if (a_above) {
            to = _e29.cosine;
            kept = a.surface.z;
            boundary.exit = _e29;
            boundary.has_exit = true;
        } else {
            begin = _e29.cosine;
            kept = b.surface.z;
            bool _e40 = boundary.has_exit;
            if (_e40) {
                float _e42 = boundary.sum;
                LtcCorner _e44 = boundary.exit;
                float _e45 = ltc_boundary_close(lobe, _e44, _e29);
                boundary.sum = (_e42 + _e45);
                boundary.has_exit = false;
            } else {
                boundary.entry = _e29;
                boundary.has_entry = true;
            }
        }
    }
    float _e53 = boundary.sum;
    vec3 _e54 = begin;
    vec3 _e55 = to;
    float _e57 = kept;
    float _e59 = ltc_arc(_e54, _e55, _e21, (lobe.area_scale * _e57));
    boundary.sum = (_e53 + _e59);
    return;
}

// Adds a vertex. One at the shading point has no direction: leaving it out is the limit of a corner that is cut off.
void ltc_boundary_push(inout LtcBoundary boundary, LtcLobe lobe, vec3 vertex) {
    float _e3 = ltc_largest_component(vertex);
    if (!((_e3 > LTC_TINY))) {
        return;
    }
    LtcCorner _e7 = ltc_corner(lobe, vertex);
    bool _e9 = boundary.started;
    if (_e9) {
        LtcCorner _e11 = boundary.previous;
        ltc_boundary_edge(boundary, lobe, _e11, _e7);
    } else {
        boundary.first = _e7;
        boundary.started = true;
    }
    boundary.previous = _e7;
    return;
}

// The sum over all edges, closed.
float ltc_boundary_finish(inout LtcBoundary boundary, LtcLobe lobe) {
    bool local_1 = false;
    bool _e3 = boundary.started;
    if (!(_e3)) {
        return 0.0;
    }
    LtcCorner _e7 = boundary.previous;
    LtcCorner _e9 = boundary.first;
    ltc_boundary_edge(boundary, lobe, _e7, _e9);
    bool _e11 = boundary.has_exit;
    if (_e11) {
        bool _e15 = boundary.has_entry;
        local_1 = _e15;
    } else {
        local_1 = false;
    }
    bool _e17 = local_1;
    if (_e17) {
        float _e19 = boundary.sum;
        LtcCorner _e21 = boundary.exit;
        LtcCorner _e23 = boundary.entry;
        float _e24 = ltc_boundary_close(lobe, _e21, _e23);
        boundary.sum = (_e19 + _e24);
    }
    float _e27 = boundary.sum;
    return _e27;
}

// The integral over the inside, as a fraction, from the sum of a flat outline that winds positively, before it is clamped.
float ltc_fraction_of_sum(float sum) {
    float turns = (sum / 6.2831855);
    return ((turns < -0.25) ? (turns + 1.0) : turns);
}

bool ltc_emits_towards(float facing, bool two_sided) {
    bool local_2 = false;
    bool local_3 = false;
    if (!((facing > 0.0))) {
        if (two_sided) {
            local_3 = (facing < 0.0);
        } else {
            local_3 = false;
        }
        bool _e12 = local_3;
        local_2 = _e12;
    } else {
        local_2 = true;
    }
    bool _e14 = local_2;
    return _e14;
}

// The distance of the shading point in front of the plane with this normal through `point`, times the normal's length;
// exactly 0 where rounding decides the side: within 8 epsilon of `reach`, how far what defines the plane is away.
float ltc_facing(vec3 normal, vec3 point, float reach) {
    float facing = -(dot(normal, point));
    return ((abs(facing) > ((9.536743e-7 * reach) * length(normal))) ? facing : 0.0);
}

// Adds the arc from `a` along `edge`, in cosine space, whose ends have these heights above the surface.
void ltc_arcs_add(inout LtcArcs arcs, vec3 a, vec3 edge, vec2 heights) {
    vec2 part = vec2(0.0, 1.0);
    bool hidden = false;
    bvec2 sunk = lessThan(heights, vec2(0.0));
    hidden = (sunk.x && sunk.y);
    bool sinks = (sunk.x != sunk.y);
    float at = (heights.x / (sinks ? (heights.x - heights.y) : 1.0));
    vec3 cut = (a + (at * edge));
    vec3 _e30 = arcs.entry;
    arcs.entry = ((sunk.x && sinks) ? cut : _e30);
    vec3 _e36 = arcs.exit;
    arcs.exit = ((sunk.y && sinks) ? cut : _e36);
    float _e42 = arcs.crossings.x;
    arcs.crossings.x = (_e42 + (sinks ? 1.0 : 0.0));
    part = vec2(((sunk.x && sinks) ? at : 0.0), ((sunk.y && sinks) ? at : 1.0));
    vec2 _e57 = part;
    vec2 lifted = (a.zz + (_e57 * edge.z));
    bvec2 below = lessThan(lifted, vec2(0.0));
    bool _e67 = hidden;
    bool sets = ((below.x != below.y) && !(_e67));
    float _e71 = part.x;
    float _e73 = part.y;
    float _e75 = part.x;
    float place = (_e71 + ((_e73 - _e75) * (lifted.x / (sets ? (lifted.x - lifted.y) : 1.0))));
    vec2 crossing = (a.xy + (place * edge.xy));
    vec2 _e92 = arcs.cosine_entry;
    arcs.cosine_entry = ((below.x && sets) ? crossing : _e92);
    vec2 _e98 = arcs.cosine_exit;
    arcs.cosine_exit = ((below.y && sets) ? crossing : _e98);
    float _e104 = arcs.crossings.y;
    arcs.crossings.y = (_e104 + (sets ? 1.0 : 0.0));
    float _e110 = part.x;
    float _e115 = part.y;
    part = vec2(((below.x && sets) ? place : _e110), ((below.y && sets) ? place : _e115));
    bool _e120 = hidden;
    hidden = (_e120 || (below.x && below.y));
    float _e126 = part.x;
    vec3 begin = (a + (_e126 * edge));
    float _e130 = part.y;
    vec3 end = (a + (_e130 * edge));
    float _e135 = part.y;
    float _e137 = part.x;
    vec3 normal = (cross(a, edge) * (_e135 - _e137));
    float along = dot(begin, end);
    float radius = sqrt((dot(begin, begin) * dot(end, end)));
    float sine = sqrt(dot(normal, normal));
    float x = abs(along);
    float square = (radius * radius);
    float over = ((((0.18455717 * x) + (1.330676 * radius)) * x) + (1.5707963 * square));
    float under = ((((((0.040163346 * x) + (0.5621138 * radius)) * x) + (1.4837523 * square)) * x) + (square * radius));
    bool obtuse = (along < 0.0);
    float numerator = (obtuse ? ((LTC_PI * under) - (over * sine)) : over);
    float denominator = (obtuse ? (under * sine) : under);
    float _e180 = arcs.sum;
    bool _e186 = hidden;
    arcs.sum = (_e180 + (_e186 ? 0.0 : ((normal.z * numerator) / max(denominator, 1e-36))));
    bool _e192 = arcs.half_turn;
    bool _e197 = hidden;
    arcs.half_turn = (_e192 || ((obtuse && (sine < (0.02 * radius))) && !(_e197)));
    return;
}

// All arcs of the quad; its largest coordinate is about 1.
LtcArcs ltc_quad_arcs(LtcLobe lobe, vec3 v0, vec3 v1, vec3 v2, vec3 v3) {
    LtcArcs arcs = LtcArcs(0.0, vec3(0.0), vec3(0.0), vec2(0.0), vec2(0.0), vec2(0.0), false);
    vec3 none = vec3(0.0);
    arcs = LtcArcs(0.0, none, none, none.xy, none.xy, none.xy, false);
    vec3 _e14 = ltc_cosine_from_target(lobe, v0);
    vec3 _e16 = ltc_cosine_from_target(lobe, (v1 - v0));
    vec3 _e18 = ltc_cosine_from_target(lobe, (v2 - v1));
    vec3 _e20 = ltc_cosine_from_target(lobe, (v3 - v2));
    vec3 b = (_e14 + _e16);
    vec3 c = (b + _e18);
    ltc_arcs_add(arcs, _e14, _e16, vec2(v0.z, v1.z));
    ltc_arcs_add(arcs, b, _e18, vec2(v1.z, v2.z));
    ltc_arcs_add(arcs, c, _e20, vec2(v2.z, v3.z));
    ltc_arcs_add(arcs, (c + _e20), -(((_e16 + _e18) + _e20)), vec2(v3.z, v0.z));
    vec3 _e40 = arcs.exit;
    vec3 _e42 = arcs.entry;
    vec3 _e44 = arcs.exit;
    ltc_arcs_add(arcs, _e40, (_e42 - _e44), vec2(0.0));
    vec2 _e49 = arcs.cosine_exit;
    vec3 exit = vec3(_e49, 0.0);
    vec2 _e53 = arcs.cosine_entry;
    ltc_arcs_add(arcs, exit, (vec3(_e53, 0.0) - exit), vec2(0.0));
    LtcArcs _e59 = arcs;
    return _e59;
}

// The fraction of the lobe that sees the quad, in [0, 1]; corners counter-clockwise seen from the emitting side, relative to
// the shading point in the shading frame. Zero for a degenerate quad, for a shading point in its plane, and behind a
// one-sided one.
float ltc_quad(LtcLobe lobe, vec3 v0, vec3 v1, vec3 v2, vec3 v3) {
    bool local_4 = false;
    bool local_5 = false;
    vec3 a = vec3(0.0);
    vec3 b = vec3(0.0);
    vec3 c = vec3(0.0);
    vec3 d = vec3(0.0);
    bool local_6 = false;
    bool local_7 = false;
    bool local_8 = false;
    LtcBoundary boundary = LtcBoundary(LtcCorner(vec3(0.0), vec3(0.0)), LtcCorner(vec3(0.0), vec3(0.0)), false, LtcCorner(vec3(0.0), vec3(0.0)), LtcCorner(vec3(0.0), vec3(0.0)), false, false, 0.0);
    int i = 0;
    float _e6 = ltc_largest_component(v0);
    float _e7 = ltc_largest_component(v1);
    float _e9 = ltc_largest_component(v2);
    float _e10 = ltc_largest_component(v3);
    float scale = max(max(_e6, _e7), max(_e9, _e10));
    bool sunk = (max(max(v0.z, v1.z), max(v2.z, v3.z)) <= 0.0);
    if (!(sunk)) {
        if ((scale > LTC_TINY)) {
            local_5 = lobe.valid;
        } else {
            local_5 = false;
        }
        bool _e31 = local_5;
        local_4 = !(_e31);
    } else {
        local_4 = true;
    }
    bool _e34 = local_4;
    if (_e34) {
        return 0.0;
    }
    a = (v0 / vec3(scale));
    b = (v1 / vec3(scale));
    c = (v2 / vec3(scale));
    d = (v3 / vec3(scale));
    vec3 _e48 = c;
    vec3 _e49 = a;
    vec3 _e51 = d;
    vec3 _e52 = b;
    vec3 area = cross((_e48 - _e49), (_e51 - _e52));
    vec3 _e55 = a;
    float height = dot(area, _e55);
    float size = dot(area, area);
    if ((size > 1e-6)) {
        local_6 = ((height * height) > (1e-6 * size));
    } else {
        local_6 = false;
    }
    bool _e67 = local_6;
    if (_e67) {
        if ((height > 0.0)) {
            local_7 = true;
        } else {
            local_7 = false;
        }
        bool _e74 = local_7;
        if (_e74) {
            return 0.0;
        }
        vec3 _e76 = a;
        vec3 _e77 = b;
        vec3 _e78 = c;
        vec3 _e79 = d;
        LtcArcs _e80 = ltc_quad_arcs(lobe, _e76, _e77, _e78, _e79);
        if (!(_e80.half_turn)) {
            local_8 = (max(_e80.crossings.x, _e80.crossings.y) <= 2.0);
        } else {
            local_8 = false;
        }
        bool _e93 = local_8;
        if (_e93) {
            return clamp((((height < 0.0) ? -(_e80.sum) : _e80.sum) / 6.2831855), 0.0, 1.0);
        }
    }
    vec3 _e105 = c;
    vec3 _e106 = a;
    vec3 _e108 = d;
    vec3 _e109 = b;
    vec3 _e111 = ltc_cross((_e105 - _e106), (_e108 - _e109));
    vec3 _e112 = a;
    float _e114 = ltc_facing(_e111, _e112, 1.0);
    bool _e115 = ltc_emits_towards(_e114, false);
    if (!(_e115)) {
        return 0.0;
    }
    LtcBoundary _e118 = ltc_boundary();
    boundary = _e118;
    bool loop_init = true;
    while(true) {
        if (!loop_init) {
            int _e131 = i;
            i = (_e131 + 1);
        }
        loop_init = false;
        int _e122 = i;
        if ((_e122 < 4)) {
        } else {
            break;
        }
        {
            vec3 _e125 = a;
            ltc_boundary_push(boundary, lobe, _e125);
            vec3 moved = a;
            vec3 _e127 = b;
            a = _e127;
            vec3 _e128 = c;
            b = _e128;
            vec3 _e129 = d;
            c = _e129;
            d = moved;
        }
    }
    float _e133 = ltc_boundary_finish(boundary, lobe);
    float _e138 = ltc_fraction_of_sum(((_e114 > 0.0) ? -(_e133) : _e133));
    return clamp(_e138, 0.0, 1.0);
}

