// Area lights by linearly transformed cosines, in closed form.
// Metal Shading Language 2.0, written by ltc 0.1.0 as
//   ltc shader --lang msl --lights 'line' --features 'surface-horizon'
// Without cosine-horizon: what lies below the horizon of cosine space counts negatively.
//
// Shading frame: x = tangent (carries alpha_x), y = bitangent (alpha_y), z = normal, right-handed. Lights are given in
// it, relative to the shading point; flat ones counter-clockwise seen from the side that emits. `wo` is a unit vector
// towards the eye. M (target_from_cosine) takes the clamped cosine to the lobe. A light's function gives the fraction of
// the lobe that sees it, in [0, 1]; 0 for a degenerate one. Inputs are finite: NaN and infinity are the caller's to
// refuse. alpha is the GGX width, the square of perceptual roughness; widths below the smallest are raised to it:
// alpha >= 0.0001.
//
// Functions to call:
//   LtcLobe ltc_lobe(metal::float3x3 target_from_cosine)
//   LtcLobe ltc_cosine()
//   float ltc_line(LtcLobe lobe, metal::float3 p0, metal::float3 p1, float radius)
//
// Use, once for a surface point:
//   lobe = ltc_lobe(M), and ltc_cosine() for diffuse light
// Include it, once for a .metal file; textures and samplers are parameters. Structs that are passed by
// reference are `thread` variables of the caller. Compile without fast math, or test that NaN stays out.

// language: metal2.0
#include <metal_stdlib>
#include <simd/simd.h>

using metal::uint;

// A vector as a sum, the first part of multiples of 2^-11.
struct LtcSplit {
    metal::float3 whole;
    metal::float3 rest;
};
struct LtcLobe {
    metal::float3x3 target_from_cosine;
    metal::float3x3 rows;
    float determinant;
    float area_scale;
    bool valid;
    char _pad5[7];
};
struct LtcSegment {
    metal::float3 p0;
    metal::float3 p1;
    metal::packed_float3 normal;
    float moment;
    float shrink;
    bool valid;
    char _pad6[11];
};
// What is left of a segment above the horizons, in cosine space.
struct LtcKept {
    metal::float3 q0;
    metal::packed_float3 q1;
    float share;
};
constant float LTC_PI = 3.1415927;
constant float LTC_TINY = 0.0000000000000000000000000000000000001;
constant float LTC_SMALL_SQUARE = 0.000000000000000000000001;

float ltc_largest_component(
    metal::float3 v
) {
    metal::float3 a = metal::abs(v);
    return metal::max(a.x, metal::max(a.y, a.z));
}

// The unit vector of v, or zero for a vector that has no direction.
metal::float3 ltc_unit_or_zero(
    metal::float3 v
) {
    float _e1 = ltc_largest_component(v);
    if (!((_e1 > LTC_TINY))) {
        return metal::float3(0.0);
    }
    metal::float3 u = v / metal::float3(_e1);
    return u / metal::float3(metal::length(u));
}

// Four-quadrant arc tangent of y / x, in [-pi, pi]; 0 for (0, 0). Absolute error below 3e-7.
//
// WGSL allows the built-in atan2 an error of 4096 ulp (5e-4): this one is as good on every device. The polynomial is a
// minimax fit of atan(t) / t on [0, tan(pi / 8)], relative error 2.1e-8.
float ltc_atan2(
    float y,
    float x
) {
    float angle = {};
    float low = metal::min(metal::abs(x), metal::abs(y));
    float high = metal::max(metal::abs(x), metal::abs(y));
    if (!((high > LTC_TINY))) {
        return 0.0;
    }
    bool past_eighth = low > (0.41421357 * high);
    float t = (past_eighth ? (low - high) : low) / (past_eighth ? (low + high) : high);
    float s = t * t;
    float series = s * (-0.3333295 + (s * (0.1997771 + (s * (-0.13877678 + (s * 0.0805372))))));
    angle = (t + (t * series)) + (past_eighth ? 0.7853982 : 0.0);
    float _e39 = angle;
    float _e41 = angle;
    angle = (metal::abs(y) > metal::abs(x)) ? (1.5707964 - _e41) : _e39;
    float _e47 = angle;
    float _e49 = angle;
    angle = (x < 0.0) ? (LTC_PI - _e49) : _e47;
    float _e54 = angle;
    float _e55 = angle;
    return (y < 0.0) ? -(_e55) : _e54;
}

// The largest power of two that is not above the magnitude; 0 below the smallest normal number. Scaling by it rounds nothing.
float ltc_floor_power_of_two(
    float x
) {
    return as_type<float>(as_type<uint>(x) & 2139095040u);
}

// The same, in a way that algebra does not see through. For magnitudes up to 1e30.
metal::float3 ltc_apart(
    metal::float3 v
) {
    return metal::max(v, metal::float3(-1000000000000000000000000000000.0));
}

metal::float3 ltc_leading(
    metal::float3 v
) {
    return as_type<metal::float3>(as_type<metal::uint3>(v) & metal::uint3(4294963200u));
}

// a * b - c * d to some 2^-36 of the products.
metal::float3 ltc_product_differences(
    metal::float3 a,
    metal::float3 b,
    metal::float3 c,
    metal::float3 d
) {
    metal::float3 _e4 = ltc_leading(a);
    metal::float3 _e5 = ltc_leading(b);
    metal::float3 _e6 = ltc_leading(c);
    metal::float3 _e7 = ltc_leading(d);
    metal::float3 a_low = a - _e4;
    metal::float3 b_low = b - _e5;
    metal::float3 c_low = c - _e6;
    metal::float3 d_low = d - _e7;
    metal::float3 middle = ((_e4 * b_low) - (_e6 * d_low)) + ((a_low * _e5) - (c_low * _e7));
    metal::float3 _e22 = ltc_apart((_e4 * _e5) - (_e6 * _e7));
    return _e22 + (middle + ((a_low * b_low) - (c_low * d_low)));
}

// The cross product, each component to its own last digits where they do not cancel by more than 2^12.
metal::float3 ltc_cross(
    metal::float3 a,
    metal::float3 b
) {
    metal::float3 _e6 = ltc_product_differences(a.yzx, b.zxy, a.zxy, b.yzx);
    return _e6;
}

// The nearest multiples of 2^-11. Of numbers up to 1, sums of products of these are exact, whatever their order: what is left
// beside them is small.
metal::float3 ltc_whole(
    metal::float3 v
) {
    return metal::rint(v * 2048.0) * 0.00048828125;
}

LtcSplit ltc_split(
    metal::float3 v
) {
    metal::float3 _e1 = ltc_whole(v);
    return LtcSplit {_e1, v - _e1};
}

LtcSplit ltc_split_sum(
    metal::float3 large,
    metal::float3 small
) {
    metal::float3 _e2 = ltc_apart(large);
    metal::float3 _e4 = ltc_whole(_e2 + small);
    return LtcSplit {_e4, (_e2 - _e4) + small};
}

// |a|^2 - |b|^2 to some 2^-33, coordinates and lengths up to about 1.
float ltc_difference_of_squares(
    LtcSplit a,
    LtcSplit b
) {
    float middle = metal::dot(a.whole, a.rest) - metal::dot(b.whole, b.rest);
    float small = metal::dot(a.rest, a.rest) - metal::dot(b.rest, b.rest);
    metal::float3 _e24 = ltc_apart(metal::float3(metal::dot(a.whole, a.whole) - metal::dot(b.whole, b.whole)));
    return _e24.x + ((2.0 * middle) + small);
}

// a . b to some 2^-33, coordinates up to 1.
float ltc_precise_dot(
    LtcSplit a,
    LtcSplit b
) {
    float small = (metal::dot(a.whole, b.rest) + metal::dot(a.rest, b.whole)) + metal::dot(a.rest, b.rest);
    metal::float3 _e17 = ltc_apart(metal::float3(metal::dot(a.whole, b.whole)));
    return _e17.x + small;
}

float ltc_largest_entry(
    metal::float3x3 m
) {
    float _e2 = ltc_largest_component(m[0]);
    float _e4 = ltc_largest_component(m[1]);
    float _e6 = ltc_largest_component(m[2]);
    return metal::max(_e2, metal::max(_e4, _e6));
}

// `target_from_cosine` may have any scale. Once for all lights of a point.
LtcLobe ltc_lobe(
    metal::float3x3 target_from_cosine
) {
    float _e1 = ltc_largest_entry(target_from_cosine);
    metal::float3x3 m = target_from_cosine * (1.0 / metal::max(_e1, LTC_TINY));
    metal::float3 _e9 = ltc_cross(m[1], m[2]);
    metal::float3 _e12 = ltc_cross(m[2], m[0]);
    metal::float3 _e15 = ltc_cross(m[0], m[1]);
    metal::float3x3 cofactors = metal::float3x3(_e9, _e12, _e15);
    float determinant = metal::dot(m[0], cofactors[0]);
    float _e20 = ltc_largest_entry(cofactors);
    float scale = 1.0 / metal::max(_e20, LTC_TINY);
    float scaled = determinant * scale;
    return LtcLobe {m, cofactors * scale, scaled, scaled * scale, scaled > 0.0};
}

// The clamped cosine itself, Lambert's lobe.
LtcLobe ltc_cosine(
) {
    metal::float3x3 identity = metal::float3x3(metal::float3(1.0, 0.0, 0.0), metal::float3(0.0, 1.0, 0.0), metal::float3(0.0, 0.0, 1.0));
    return LtcLobe {identity, identity, 1.0, 1.0, true};
}

// A direction of the lobe's space in cosine space, up to its length.
metal::float3 ltc_cosine_from_target(
    LtcLobe lobe,
    metal::float3 v
) {
    return v * lobe.rows;
}

// The normal of a plane through the origin in cosine space, up to its length.
metal::float3 ltc_cosine_normal(
    LtcLobe lobe,
    metal::float3 normal
) {
    return normal * lobe.target_from_cosine;
}

// The fraction of the lobe above the horizons: of a light in every direction. In cosine space the surface's horizon is a
// plane whose normal has the angle gamma to z; between both the cosine integrates to (1 + cos gamma) / 2.
float ltc_everywhere(
    LtcLobe lobe
) {
    if (!(lobe.valid)) {
        return 0.0;
    }
    metal::float3 _e8 = ltc_cosine_normal(lobe, metal::float3(0.0, 0.0, 1.0));
    metal::float3 _e9 = ltc_unit_or_zero(_e8);
    float tilt = _e9.z;
    return metal::clamp(tilt, 0.0, 1.0);
}

LtcSegment ltc_segment(
    metal::float3 p0,
    metal::float3 p1
) {
    bool local = {};
    float _e2 = ltc_largest_component(p0);
    float _e3 = ltc_largest_component(p1);
    float _e5 = ltc_floor_power_of_two(metal::max(_e2, _e3));
    if (!((_e5 > LTC_TINY))) {
        return LtcSegment {p0, p1, metal::float3(0.0), 1.0, 1.0, false};
    }
    float shrink = 1.0 / _e5;
    metal::float3 a = p0 * shrink;
    metal::float3 b = p1 * shrink;
    metal::float3 plain = metal::cross(a, b);
    if (metal::dot(plain, plain) > ((0.001 * metal::dot(a, a)) * metal::dot(b, b))) {
        local = metal::dot(plain, plain) >= LTC_SMALL_SQUARE;
    } else {
        local = false;
    }
    bool _e33 = local;
    if (_e33) {
        return LtcSegment {a, b, plain, 1.0, shrink, true};
    }
    metal::float3 _e37 = ltc_cross(a, b);
    if (metal::dot(_e37, _e37) >= LTC_SMALL_SQUARE) {
        return LtcSegment {a, b, _e37, 1.0, shrink, true};
    }
    metal::float3 _e44 = ltc_unit_or_zero(_e37);
    return LtcSegment {a, b, _e44, metal::dot(_e37, _e44), shrink, metal::dot(_e44, _e44) > 0.5};
}

// Unit vector from the shading point towards the nearest point of the line.
metal::float3 ltc_towards_line(
    LtcSegment segment
) {
    metal::float3 _e6 = ltc_unit_or_zero(metal::cross(segment.p1 - segment.p0, segment.normal));
    return _e6;
}

// Moves the end that lies below z = 0, if any, onto it. The moment p0 x p1 says where: the point is
// (z x moment) / (z1 - z0), which cancels nowhere.
LtcKept ltc_clip_above(
    metal::float3 p0,
    metal::float3 p1,
    metal::float3 moment
) {
    metal::bool2 sunk = metal::float2(p0.z, p1.z) < metal::float2(0.0);
    bool crosses = sunk.x != sunk.y;
    float inverse_rise = 1.0 / (crosses ? (p1.z - p0.z) : 1.0);
    metal::float3 crossing = metal::float3(-(moment.y) * inverse_rise, moment.x * inverse_rise, 0.0);
    float kept = (sunk.x ? p1.z : -(p0.z)) * inverse_rise;
    float share = (metal::max(p0.z, p1.z) <= 0.0) ? 0.0 : (crosses ? kept : 1.0);
    return LtcKept {(sunk.x & crosses) ? crossing : p0, (sunk.y & crosses) ? crossing : p1, share};
}

// `moment` is that of the whole segment in cosine space.
LtcKept ltc_kept(
    LtcSegment segment,
    LtcLobe lobe,
    metal::float3 moment
) {
    LtcKept kept = {};
    kept = LtcKept {segment.p0, segment.p1, 1.0};
    LtcKept _e13 = ltc_clip_above(segment.p0, segment.p1, segment.normal * segment.moment);
    kept = _e13;
    metal::float3 _e15 = kept.q0;
    metal::float3 _e16 = ltc_cosine_from_target(lobe, _e15);
    metal::float3 _e18 = kept.q1;
    metal::float3 _e19 = ltc_cosine_from_target(lobe, _e18);
    float _e21 = kept.share;
    kept = LtcKept {_e16, _e19, _e21};
    LtcKept _e23 = kept;
    return _e23;
}

// A length whose square may underflow.
float ltc_length(
    metal::float3 v
) {
    float _e1 = ltc_largest_component(v);
    return (_e1 > LTC_TINY) ? (_e1 * metal::length(v / metal::float3(metal::max(_e1, LTC_TINY)))) : 0.0;
}

// (c_z / d) (angle - sin angle) + tan(angle / 2) (q0_z / |q0| + q1_z / |q1|) (1 / |q0| + 1 / |q1|), the angle being that
// between q0 and q1, sine = |q0 x q1|, nearness = c_z / d with d the distance of the line, c towards its nearest point.
float ltc_cosine_along(
    metal::float3 q0,
    metal::float3 q1,
    float sine,
    float nearness
) {
    metal::float2 near = {};
    bool local_1 = {};
    metal::float2 squares = metal::float2(metal::dot(q0, q0), metal::dot(q1, q1));
    near = metal::rsqrt(squares);
    if (!((metal::min(squares.x, squares.y) > 0.000000000000000000000000000001))) {
        float _e15 = ltc_length(q0);
        float _e16 = ltc_length(q1);
        if (_e15 > 0.0) {
            local_1 = _e16 > 0.0;
        } else {
            local_1 = false;
        }
        bool _e24 = local_1;
        if (!(_e24)) {
            return 0.0;
        }
        near = metal::float2(1.0) / metal::float2(_e15, _e16);
    }
    float _e32 = near.x;
    float _e35 = near.y;
    float cosine = metal::dot(q0 * _e32, q1 * _e35);
    float _e39 = near.x;
    float _e42 = near.y;
    float unit_sine = (sine * _e39) * _e42;
    bool acute = cosine >= 0.0;
    float half_tangent = (acute ? unit_sine : (1.0 - cosine)) / (acute ? (1.0 + cosine) : unit_sine);
    float _e55 = near.x;
    float _e59 = near.y;
    float _e64 = near.x;
    float _e66 = near.y;
    float ends = (half_tangent * ((q0.z * _e55) + (q1.z * _e59))) * (_e64 + _e66);
    float x = metal::abs(cosine);
    float g = ((((0.084654704 * x) + 0.5184987) * x) + 0.5707963) / ((((((0.088782445 * x) + 0.7727517) * x) + 1.6603152) * x) + 1.0);
    float less = ((unit_sine * unit_sine) * half_tangent) * g;
    float rest = LTC_PI - (unit_sine * (2.0 + ((1.0 - x) * g)));
    return (nearness * (acute ? less : rest)) + ends;
}

// The integral of D(w) |w x w_t| / |p|^2 dl along the segment, per scaled length: half of eq. 1.6. Of what is above the
// horizons.
float ltc_segment_integral(
    LtcSegment segment,
    LtcLobe lobe
) {
    bool local_2 = {};
    if (segment.valid) {
        local_2 = lobe.valid;
    } else {
        local_2 = false;
    }
    bool _e7 = local_2;
    if (!(_e7)) {
        return 0.0;
    }
    metal::float3 _e11 = ltc_cosine_normal(lobe, segment.normal);
    float squared_width = metal::dot(_e11, _e11);
    float stretch = segment.moment * lobe.area_scale;
    metal::float3 _e19 = ltc_cosine_from_target(lobe, segment.p1 - segment.p0);
    LtcKept _e21 = ltc_kept(segment, lobe, _e11 * stretch);
    float nearness = (((_e19.x * _e11.y) - (_e19.y * _e11.x)) / squared_width) / stretch;
    float sine = (_e21.share * stretch) * metal::sqrt(squared_width);
    float stretched = metal::sqrt(metal::dot(segment.normal, segment.normal) / squared_width) * lobe.determinant;
    float _e44 = ltc_cosine_along(_e21.q0, _e21.q1, sine, nearness);
    float integral = (stretched * _e44) * 0.15915494;
    bool valid = ((segment.valid & lobe.valid) & (squared_width > 0.0)) & (stretch > 0.0);
    return ((valid & (_e21.share > 0.0)) & (sine > 0.0)) ? integral : 0.0;
}

float ltc_line_unclamped(
    LtcLobe lobe,
    metal::float3 p0,
    metal::float3 p1,
    float radius
) {
    LtcSegment _e4 = ltc_segment(p0, p1);
    float _e9 = ltc_segment_integral(_e4, lobe);
    return (2.0 * (radius * _e4.shrink)) * _e9;
}

// min(1, R * integral of D(w) 2 |w x w_t| / |p|^2 dl); ends relative to the shading point, in the shading frame. For a cylinder
// that looks much narrower than the lobe. Zero for one without extent and for a line through the shading point.
float ltc_line(
    LtcLobe lobe,
    metal::float3 p0,
    metal::float3 p1,
    float radius
) {
    float _e4 = ltc_line_unclamped(lobe, p0, p1, radius);
    return metal::clamp(_e4, 0.0, 1.0);
}
