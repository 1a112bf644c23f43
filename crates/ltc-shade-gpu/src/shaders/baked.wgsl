// Slices of an anisotropic table, each of one pair of widths: what is left to look up is the view. Between the slice's nodes it is
// the table's own interpolation, with a quarter of its fetches. No bindings. Needs: table, fold, closed_form.
//
// Texture: 2D array, x = phi nodes, y = theta nodes, layer = slice + slices * group of four channels.

struct LtcBakedPlace {
    theta: LtcPlace,
    phi: LtcPlace,
    fold: LtcFold,
}

// `wo` is a unit vector in the shading frame; the widths are those that the slice was baked for. Of `axes` theta and phi are used.
fn ltc_baked_place(axes: LtcAxes, wo: vec3f, alpha_x: f32, alpha_y: f32) -> LtcBakedPlace {
    let fold = ltc_fold(wo, alpha_x, alpha_y);
    let phi = ltc_place_of_value(axes.phi, ltc_folded_azimuth(fold, wo));
    return LtcBakedPlace(ltc_place_of_theta(axes.theta, wo), phi, fold);
}
