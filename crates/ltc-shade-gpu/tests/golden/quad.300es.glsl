// Area lights by linearly transformed cosines, in closed form.
// GLSL ES 3.00, written by ltc 0.1.0 as
//   ltc shader --lang glsl-es --lights 'quad' --features 'rational-edges'
// Without surface-horizon: light from below the surface leaks into tilted lobes.
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
//   LtcLobe ltc_lobe(mat3x3 target_from_cosine)
//   LtcLobe ltc_cosine()
//   float ltc_quad(LtcLobe lobe, vec3 v0, vec3 v1, vec3 v2, vec3 v3)
//
// Use, once for a surface point:
//   lobe = ltc_lobe(M), and ltc_cosine() for diffuse light
// Paste it behind `#version 300 es`. Textures are parameters: pass your sampler2DArray, sampler3D or
// sampler2D, with NEAREST filters unless hardware-filtering was asked for.


precision highp float;
precision highp int;

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

// theta / sin(theta) from its cosine, in [0, 1].
float ltc_angle_over_sine(float x) {
    return (((((0.026367364 * x) + 0.9094872) * x) + 1.5707957) / ((((0.29106498 * x) + 1.2155834) * x) + 1.0));
}

// The angle whose sine and cosine these are, up to one factor; sine >= 0. Relative error 7e-7 up to a right angle; beyond, by
// pi - f(-cosine), so that edges near pi keep their value.
float ltc_edge_angle(float sine, float cosine) {
    float length_ = sqrt(((sine * sine) + (cosine * cosine)));
    if (!((length_ > LTC_TINY))) {
        return 0.0;
    }
    float _e12 = ltc_angle_over_sine((abs(cosine) / length_));
    float acute = (_e12 * (sine / length_));
    return ((cosine < 0.0) ? (LTC_PI - acute) : acute);
}

LtcBoundary ltc_boundary() {
    LtcCorner none = LtcCorner(vec3(0.0), vec3(0.0));
    return LtcBoundary(none, none, false, 0.0);
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

// The integral along the great circle from a to b, whose cross product is `normal` times `scale` > 0; its part below the
// horizon dropped onto the horizon. Equal and antipodal ends span no plane and give 0.
float ltc_arc(vec3 a, vec3 b, vec3 normal, float scale) {
    vec3 _e4 = ltc_unit_or_zero(normal);
    float length_1 = (dot(normal, _e4) * scale);
    if (!((length_1 > 0.0))) {
        return 0.0;
    }
    float _e12 = ltc_edge_angle(length_1, dot(a, b));
    return (_e12 * _e4.z);
}

// The integral along the edge from a to b, nothing cut by the surface.
float ltc_edge(LtcLobe lobe, LtcCorner a, LtcCorner b, float kept) {
    vec3 _e6 = ltc_cross(a.surface, b.surface);
    vec3 _e7 = ltc_cosine_normal(lobe, _e6);
    float _e12 = ltc_arc(a.cosine, b.cosine, _e7, (lobe.area_scale * kept));
    return _e12;
}

// Adds the edge from a to b, cut by the surface's horizon: what keeps lights below it from leaking into a tilted lobe.
void ltc_boundary_edge(inout LtcBoundary boundary, LtcLobe lobe, LtcCorner a, LtcCorner b) {
    float _e5 = boundary.sum;
    float _e7 = ltc_edge(lobe, a, b, 1.0);
    boundary.sum = (_e5 + _e7);
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
    bool _e3 = boundary.started;
    if (!(_e3)) {
        return 0.0;
    }
    LtcCorner _e7 = boundary.previous;
    LtcCorner _e9 = boundary.first;
    ltc_boundary_edge(boundary, lobe, _e7, _e9);
    float _e11 = boundary.sum;
    return _e11;
}

// The integral over the inside, as a fraction, from the sum of a flat outline that winds positively, before it is clamped.
float ltc_fraction_of_sum(float sum) {
    float turns = (sum / 6.2831855);
    return turns;
}

bool ltc_emits_towards(float facing, bool two_sided) {
    bool local = false;
    bool local_1 = false;
    if (!((facing > 0.0))) {
        if (two_sided) {
            local_1 = (facing < 0.0);
        } else {
            local_1 = false;
        }
        bool _e12 = local_1;
        local = _e12;
    } else {
        local = true;
    }
    bool _e14 = local;
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
    float _e11 = part.x;
    vec3 begin = (a + (_e11 * edge));
    float _e15 = part.y;
    vec3 end = (a + (_e15 * edge));
    float _e20 = part.y;
    float _e22 = part.x;
    vec3 normal = (cross(a, edge) * (_e20 - _e22));
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
    float _e65 = arcs.sum;
    bool _e71 = hidden;
    arcs.sum = (_e65 + (_e71 ? 0.0 : ((normal.z * numerator) / max(denominator, 1e-36))));
    bool _e77 = arcs.half_turn;
    bool _e82 = hidden;
    arcs.half_turn = (_e77 || ((obtuse && (sine < (0.02 * radius))) && !(_e82)));
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
    LtcArcs _e39 = arcs;
    return _e39;
}

// The fraction of the lobe that sees the quad, in [0, 1]; corners counter-clockwise seen from the emitting side, relative to
// the shading point in the shading frame. Zero for a degenerate quad, for a shading point in its plane, and behind a
// one-sided one.
float ltc_quad(LtcLobe lobe, vec3 v0, vec3 v1, vec3 v2, vec3 v3) {
    bool local_2 = false;
    vec3 a = vec3(0.0);
    vec3 b = vec3(0.0);
    vec3 c = vec3(0.0);
    vec3 d = vec3(0.0);
    bool local_3 = false;
    bool local_4 = false;
    bool local_5 = false;
    LtcBoundary boundary = LtcBoundary(LtcCorner(vec3(0.0), vec3(0.0)), LtcCorner(vec3(0.0), vec3(0.0)), false, 0.0);
    int i = 0;
    float _e6 = ltc_largest_component(v0);
    float _e7 = ltc_largest_component(v1);
    float _e9 = ltc_largest_component(v2);
    float _e10 = ltc_largest_component(v3);
    float scale = max(max(_e6, _e7), max(_e9, _e10));
    if ((scale > LTC_TINY)) {
        local_2 = lobe.valid;
    } else {
        local_2 = false;
    }
    bool _e19 = local_2;
    if (!(_e19)) {
        return 0.0;
    }
    a = (v0 / vec3(scale));
    b = (v1 / vec3(scale));
    c = (v2 / vec3(scale));
    d = (v3 / vec3(scale));
    vec3 _e34 = c;
    vec3 _e35 = a;
    vec3 _e37 = d;
    vec3 _e38 = b;
    vec3 area = cross((_e34 - _e35), (_e37 - _e38));
    vec3 _e41 = a;
    float height = dot(area, _e41);
    float size = dot(area, area);
    if ((size > 1e-6)) {
        local_3 = ((height * height) > (1e-6 * size));
    } else {
        local_3 = false;
    }
    bool _e53 = local_3;
    if (_e53) {
        if ((height > 0.0)) {
            local_4 = true;
        } else {
            local_4 = false;
        }
        bool _e60 = local_4;
        if (_e60) {
            return 0.0;
        }
        vec3 _e62 = a;
        vec3 _e63 = b;
        vec3 _e64 = c;
        vec3 _e65 = d;
        LtcArcs _e66 = ltc_quad_arcs(lobe, _e62, _e63, _e64, _e65);
        if (!(_e66.half_turn)) {
            local_5 = (max(_e66.crossings.x, _e66.crossings.y) <= 2.0);
        } else {
            local_5 = false;
        }
        bool _e79 = local_5;
        if (_e79) {
            return clamp((((height < 0.0) ? -(_e66.sum) : _e66.sum) / 6.2831855), 0.0, 1.0);
        }
    }
    vec3 _e91 = c;
    vec3 _e92 = a;
    vec3 _e94 = d;
    vec3 _e95 = b;
    vec3 _e97 = ltc_cross((_e91 - _e92), (_e94 - _e95));
    vec3 _e98 = a;
    float _e100 = ltc_facing(_e97, _e98, 1.0);
    bool _e101 = ltc_emits_towards(_e100, false);
    if (!(_e101)) {
        return 0.0;
    }
    LtcBoundary _e104 = ltc_boundary();
    boundary = _e104;
    bool loop_init = true;
    while(true) {
        if (!loop_init) {
            int _e117 = i;
            i = (_e117 + 1);
        }
        loop_init = false;
        int _e108 = i;
        if ((_e108 < 4)) {
        } else {
            break;
        }
        {
            vec3 _e111 = a;
            ltc_boundary_push(boundary, lobe, _e111);
            vec3 moved = a;
            vec3 _e113 = b;
            a = _e113;
            vec3 _e114 = c;
            b = _e114;
            vec3 _e115 = d;
            c = _e115;
            d = moved;
        }
    }
    float _e119 = ltc_boundary_finish(boundary, lobe);
    float _e124 = ltc_fraction_of_sum(((_e100 > 0.0) ? -(_e119) : _e119));
    return clamp(_e124, 0.0, 1.0);
}

