// What all tables share: axes, texels, the result of a lookup. No bindings. Needs: math, constants.

// How an axis spaces its nodes; filled from the table, see `AxisUniform` in Rust.
struct LtcAxis {
    // Mapped coordinate of the first node.
    low: f32,
    // Cells per unit of the mapped coordinate.
    scale: f32,
    // Number of cells: the last node.
    last: f32,
    // LTC_LINEAR, LTC_SQRT, LTC_SQRT_ONE_MINUS_COS, LTC_HALF_TANGENT or LTC_GRAZING_HALF_TANGENT.
    mapping: u32,
}

struct LtcAxes {
    theta: LtcAxis,
    phi: LtcAxis,
    alpha: LtcAxis,
    lambda: LtcAxis,
}

// A place along an axis: between nodes `cell` and `cell + 1`, `t` of the way.
struct LtcPlace {
    cell: u32,
    t: f32,
}

// The three texels of an entry, or of an interpolation between entries:
// m00 m01 m02 m10, m11 m12 m20 m21, m22 magnitude fresnel 0; in a table with a closed form the third is m22, what the form leaves of both,
// and 1.
struct LtcTexels {
    g0: vec4f,
    g1: vec4f,
    g2: vec4f,
}

struct LtcLookup {
    // target_from_cosine in the shading frame.
    m: mat3x3f,
    magnitude: f32,
    fresnel: f32,
}

fn ltc_place(axis: LtcAxis, coordinate: f32) -> LtcPlace {
    let position = clamp((coordinate - axis.low) * axis.scale, 0.0, axis.last);
    let cell = min(floor(position), axis.last - 1.0);
    return LtcPlace(u32(cell), position - cell);
}

// For every quantity but theta; the mappings by sine and cosine are for theta alone.
fn ltc_place_of_value(axis: LtcAxis, value: f32) -> LtcPlace {
    return ltc_place(axis, select(value, sqrt(max(value, 0.0)), axis.mapping == LTC_SQRT));
}

// The place of the polar angle of the unit vector wo, without the cancellation that acos and 1 - cos have near 0.
fn ltc_place_of_theta(axis: LtcAxis, wo: vec3f) -> LtcPlace {
    let cosine = max(wo.z, 0.0);
    let squared_sine = wo.x * wo.x + wo.y * wo.y;
    if axis.mapping == LTC_SQRT_ONE_MINUS_COS {
        return ltc_place(axis, sqrt(squared_sine / (1.0 + cosine)));
    }
    if axis.mapping == LTC_HALF_TANGENT {
        return ltc_place(axis, sqrt(squared_sine) / (1.0 + cosine));
    }
    if axis.mapping == LTC_GRAZING_HALF_TANGENT {
        let sine = sqrt(squared_sine);
        return ltc_place(axis, sine / (2.0 + 2.0 * cosine - sine));
    }
    return ltc_place_of_value(axis, ltc_atan2(sqrt(squared_sine), cosine));
}

fn ltc_matrix(texels: LtcTexels) -> mat3x3f {
    return mat3x3f(
        vec3f(texels.g0.x, texels.g0.w, texels.g1.z),
        vec3f(texels.g0.y, texels.g1.x, texels.g1.w),
        vec3f(texels.g0.z, texels.g1.y, texels.g2.x),
    );
}

fn ltc_blend(a: LtcTexels, b: LtcTexels, t: f32) -> LtcTexels {
    return LtcTexels(mix(a.g0, b.g0, t), mix(a.g1, b.g1, t), mix(a.g2, b.g2, t));
}

// The nearest node to a place.
fn ltc_nearest(place: LtcPlace) -> LtcPlace {
    return LtcPlace(place.cell, select(0.0, 1.0, place.t > 0.5));
}

fn ltc_nearest_node(place: LtcPlace) -> u32 {
    return place.cell + select(0u, 1u, place.t > 0.5);
}

// Whether the matrix is a lobe's: det M > 0. Entries have it, but very thin lobes that lie askew to each other may
// interpolate to a matrix without; the nearest entry answers then, as on the CPU.
fn ltc_regular(texels: LtcTexels) -> bool {
    let m = ltc_matrix(texels);
    return dot(m[0], cross(m[1], m[2])) > 0.0;
}

// The magnitude and Fresnel term of `texels` with the matrix of `other`.
fn ltc_with_matrix(texels: LtcTexels, other: LtcTexels) -> LtcTexels {
    return LtcTexels(other.g0, other.g1, vec4f(other.g2.x, texels.g2.yzw));
}

// The weight of the upper or lower node of a place.
fn ltc_weight(place: LtcPlace, upper: u32) -> f32 {
    return select(1.0 - place.t, place.t, upper == 1u);
}

// The weights of four neighbours: neither node upper, that of a, that of b, both.
fn ltc_weights(a: LtcPlace, b: LtcPlace) -> vec4f {
    let low = vec2f(1.0 - a.t, a.t) * (1.0 - b.t);
    let high = vec2f(1.0 - a.t, a.t) * b.t;
    return vec4f(low, high);
}

// The place in texels, for a filtering fetch.
fn ltc_texel(place: LtcPlace) -> f32 {
    return f32(place.cell) + place.t + 0.5;
}
