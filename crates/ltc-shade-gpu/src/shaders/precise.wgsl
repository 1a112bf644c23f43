// Products whose leading digits cancel. No bindings.
//
// The twelve leading digits of a factor are split off by a mask, so that products of leading parts are exact and nothing hangs
// on how a sum is rounded. But compilers put parts together again where algebra allows: Mesa's turns a b + a c into a (b + c).
// What is exact goes through `ltc_apart` before it meets the rest.

// The same, in a way that algebra does not see through. For magnitudes up to 1e30.
fn ltc_apart(v: vec3f) -> vec3f {
    return max(v, vec3f(-1e30));
}

fn ltc_leading(v: vec3f) -> vec3f {
    return bitcast<vec3f>(bitcast<vec3u>(v) & vec3u(0xfffff000u));
}

// a * b - c * d to some 2^-36 of the products.
fn ltc_product_differences(a: vec3f, b: vec3f, c: vec3f, d: vec3f) -> vec3f {
    let a_high = ltc_leading(a);
    let b_high = ltc_leading(b);
    let c_high = ltc_leading(c);
    let d_high = ltc_leading(d);
    let a_low = a - a_high;
    let b_low = b - b_high;
    let c_low = c - c_high;
    let d_low = d - d_high;
    let middle = (a_high * b_low - c_high * d_low) + (a_low * b_high - c_low * d_high);
    return ltc_apart(a_high * b_high - c_high * d_high) + (middle + (a_low * b_low - c_low * d_low));
}

// The cross product, each component to its own last digits where they do not cancel by more than 2^12.
fn ltc_cross(a: vec3f, b: vec3f) -> vec3f {
    return ltc_product_differences(a.yzx, b.zxy, a.zxy, b.yzx);
}

// The nearest multiples of 2^-11. Of numbers up to 1, sums of products of these are exact, whatever their order: what is left
// beside them is small.
fn ltc_whole(v: vec3f) -> vec3f {
    return round(v * 2048.0) * 0.00048828125;
}

// A vector as a sum, the first part of multiples of 2^-11.
struct LtcSplit {
    whole: vec3f,
    rest: vec3f,
}

fn ltc_split(v: vec3f) -> LtcSplit {
    let whole = ltc_whole(v);
    return LtcSplit(whole, v - whole);
}

fn ltc_split_sum(large: vec3f, small: vec3f) -> LtcSplit {
    let exact = ltc_apart(large);
    let whole = ltc_whole(exact + small);
    return LtcSplit(whole, (exact - whole) + small);
}

// |a|^2 - |b|^2 to some 2^-33, coordinates and lengths up to about 1.
fn ltc_difference_of_squares(a: LtcSplit, b: LtcSplit) -> f32 {
    let middle = dot(a.whole, a.rest) - dot(b.whole, b.rest);
    let small = dot(a.rest, a.rest) - dot(b.rest, b.rest);
    let exact = ltc_apart(vec3f(dot(a.whole, a.whole) - dot(b.whole, b.whole)));
    return exact.x + (2.0 * middle + small);
}

// a . b to some 2^-33, coordinates up to 1.
fn ltc_precise_dot(a: LtcSplit, b: LtcSplit) -> f32 {
    let small = dot(a.whole, b.rest) + dot(a.rest, b.whole) + dot(a.rest, b.rest);
    return ltc_apart(vec3f(dot(a.whole, b.whole))).x + small;
}
