// What a formula says of magnitude and Fresnel term, `ltc_table::ClosedForm`, so that tables need only hold the rest. No bindings.
// Needs: constants, table.

// `ClosedForm::GgxSmith`: magnitude and Fresnel term for the unit vector `wo` in the shading frame.
fn ltc_ggx_smith(wo: vec3f, alpha_x: f32, alpha_y: f32) -> vec2f {
    let directions = wo.xy * wo.xy;
    let squares = vec2f(alpha_x * alpha_x, alpha_y * alpha_y);
    // Squared widths along the view and across it.
    let along = dot(squares, directions);
    let across = dot(squares, directions.yx);
    let cosine = max(wo.z, 0.0);
    let m1 = max(cosine + sqrt(cosine * cosine + LTC_FORM_M1.x * along + LTC_FORM_M1.y * across), LTC_FORM_LEAST_M);
    let m2 = max(cosine + sqrt(cosine * cosine + LTC_FORM_M2.x * along + LTC_FORM_M2.y * across), LTC_FORM_LEAST_M);
    let g1 = 2.0 * cosine / m1;
    let g2 = 2.0 * cosine / m2;
    let h1 = 1.0 - g1;
    let h2 = 1.0 - g2;
    let magnitude = LTC_FORM_MAGNITUDE.x * g1 * h1 + LTC_FORM_MAGNITUDE.y * g2 * h2 * h2 * across
        + LTC_FORM_MAGNITUDE.z * (squares.x + squares.y);
    let v = max(0.0, 1.0 - 0.5 * m1);
    let fresnel = v * v * v * v * (LTC_FORM_FRESNEL.x
        + v * g1 * (LTC_FORM_FRESNEL.y + h1 * (LTC_FORM_FRESNEL.z + LTC_FORM_FRESNEL.w * across)));
    return vec2f(magnitude, fresnel);
}

// Magnitude and Fresnel term of what was interpolated: the last number says whether it is what the closed form leaves of them.
fn ltc_channels(texels: LtcTexels, wo: vec3f, alpha_x: f32, alpha_y: f32) -> vec2f {
    let found = texels.g2.yz;
    if !(texels.g2.w > 0.5) {
        return found;
    }
    return clamp(found + ltc_ggx_smith(wo, alpha_x, alpha_y), vec2f(0.0), vec2f(1.0));
}
