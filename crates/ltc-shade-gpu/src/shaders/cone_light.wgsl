// The part of a lobe within a cone over an ellipse: what disk, ellipse, sphere and cylinder have in common. No bindings.
// Needs: math, lobe, cone, cone_region.

const LTC_BELOW: i32 = -1;
const LTC_ACROSS: i32 = 0;
const LTC_ABOVE: i32 = 1;

// Where an ellipse lies with respect to a plane through the shading point, from the heights of its centre and of the ends of
// two conjugate half-axes.
fn ltc_place_of_ellipse(centre: f32, u: f32, v: f32) -> i32 {
    // Nearer to touching than this only rounding tells.
    let reach = (u * u + v * v) * 0.99999905;
    if centre * centre < reach {
        return LTC_ACROSS;
    }
    return select(LTC_BELOW, LTC_ABOVE, centre > 0.0);
}

// The fraction of the lobe in the cone over centre + u cos t + v sin t, cut by the horizons, before it is clamped; u x v points
// away from the shading point. Where `kept` is not zero, only what has a positive product with it counts.
fn ltc_cone_light(lobe: LtcLobe, centre: vec3f, u: vec3f, v: vec3f, kept: vec3f) -> f32 {
    let size = max(ltc_largest_component(centre), max(ltc_largest_component(u), ltc_largest_component(v)));
    if !(size > LTC_TINY && lobe.valid) {
        return 0.0;
    }
    let shrink = 1.0 / size;
    let target_c = centre * shrink;
    let target_u = u * shrink;
    let target_v = v * shrink;
    var surface = LTC_ABOVE;
//#if surface_horizon
    surface = ltc_place_of_ellipse(target_c.z, target_u.z, target_v.z);
    if surface == LTC_BELOW {
        return 0.0;
    }
//#endif
    var c = ltc_cosine_from_target(lobe, target_c);
    var cu = ltc_cosine_from_target(lobe, target_u);
    var cv = ltc_cosine_from_target(lobe, target_v);
    let cosine_size = max(ltc_largest_component(c), max(ltc_largest_component(cu), ltc_largest_component(cv)));
    let again = 1.0 / max(cosine_size, LTC_TINY);
    c *= again;
    cu *= again;
    cv *= again;
    var cosine = LTC_ABOVE;
//#if cosine_horizon
    cosine = ltc_place_of_ellipse(c.z, cu.z, cv.z);
    if cosine == LTC_BELOW {
        return 0.0;
    }
//#endif
    let cone = ltc_cone(c, cu, cv);
    if !cone.valid {
        return 0.0;
    }
    let up = vec3f(0.0, 0.0, 1.0);
    let parted = any(kept != vec3f(0.0));
    if surface == LTC_ABOVE && cosine == LTC_ABOVE && !parted {
        return ltc_cone_uncut(cone, up);
    }
    let axes = ltc_cone_axes(cone);
    if !axes.valid {
        return 0.0;
    }
    return ltc_cone_cut(lobe, cone, axes, surface == LTC_ACROSS, cosine == LTC_ACROSS, kept);
}

fn ltc_cone_cut(
    lobe: LtcLobe,
    cone: LtcCone,
    axes: LtcConeAxes,
    by_surface: bool,
    by_cosine: bool,
    kept: vec3f,
) -> f32 {
    let to_axes = mat3x3f(axes.e1, axes.e2, axes.e3);
    let up = vec3f(0.0, 0.0, 1.0) * to_axes;
    var planes = LtcRegion(axes.widths, up, ltc_keep_all(), ltc_keep_all(), ltc_keep_all());
    if by_cosine {
        planes.plane_2 = ltc_half_space(axes.widths, up);
    }
    if by_surface {
        // A plane's normal goes to cosine space by the transpose of M. The two horizons of an upright lobe are one.
        let ground = ltc_cosine_normal(lobe, vec3f(0.0, 0.0, 1.0));
        if !(by_cosine && all(ground.xy == vec2f(0.0))) {
            planes.plane_1 = ltc_half_space(axes.widths, ltc_unit_or_zero(ground) * to_axes);
        }
    }
    if any(kept != vec3f(0.0)) {
        planes.plane_0 = ltc_half_space(axes.widths, ltc_unit_or_zero(ltc_cosine_normal(lobe, kept)) * to_axes);
    }
    // The first plane is to be one that cuts.
    if planes.plane_0.effect == LTC_KEEPS_ALL {
        planes.plane_0 = planes.plane_1;
        planes.plane_1 = ltc_keep_all();
    }
    if planes.plane_0.effect == LTC_KEEPS_ALL {
        planes.plane_0 = planes.plane_2;
        planes.plane_2 = ltc_keep_all();
    }
    if ltc_region_whole(planes) {
        return ltc_cone_uncut(cone, vec3f(0.0, 0.0, 1.0));
    }
    return ltc_region_integral(planes);
}
