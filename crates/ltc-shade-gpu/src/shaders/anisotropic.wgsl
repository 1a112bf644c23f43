// The anisotropic table: coordinates. No bindings. Needs: table, fold, closed_form.
//
// Texture: 3D, x = lambda nodes, y = alpha nodes, z = phi node + phis * (theta node + thetas * group of four channels).

struct LtcAnisotropicPlace {
    theta: LtcPlace,
    phi: LtcPlace,
    alpha: LtcPlace,
    lambda: LtcPlace,
    fold: LtcFold,
}

// `wo` is a unit vector in the shading frame.
fn ltc_anisotropic_place(axes: LtcAxes, wo: vec3f, alpha_x: f32, alpha_y: f32) -> LtcAnisotropicPlace {
    let fold = ltc_fold(wo, alpha_x, alpha_y);
    let alpha = max(alpha_x, alpha_y);
    return LtcAnisotropicPlace(
        ltc_place_of_theta(axes.theta, wo),
        ltc_place_of_value(axes.phi, ltc_folded_azimuth(fold, wo)),
        ltc_place_of_value(axes.alpha, alpha),
        ltc_place_of_value(axes.lambda, min(alpha_x, alpha_y) / max(alpha, LTC_TINY)),
        fold,
    );
}

fn ltc_anisotropic_nearest(place: LtcAnisotropicPlace) -> LtcAnisotropicPlace {
    return LtcAnisotropicPlace(
        ltc_nearest(place.theta),
        ltc_nearest(place.phi),
        ltc_nearest(place.alpha),
        ltc_nearest(place.lambda),
        place.fold,
    );
}
