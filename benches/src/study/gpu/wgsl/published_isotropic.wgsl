// Heitz et al. 2016, section 4: four numbers of the inverse matrix, and in a second texture the norm, by two filtered fetches at
// (sqrt(alpha), sqrt(1 - cos(theta))), here in the layout that the authors' files have. The frame turns to the view.

@group(1) @binding(3) var published_inverse: texture_2d<f32>;
@group(1) @binding(4) var published_norm: texture_2d<f32>;
@group(1) @binding(5) var published_filter: sampler;

fn timed_find(p: TimedPixel) -> TimedFound {
    let size = vec2f(textureDimensions(published_inverse));
    let uv = vec2f(sqrt(p.alpha_x), sqrt(1.0 - p.wo.z));
    let at = (uv * (size - 1.0) + 0.5) / size;
    let t = textureSampleLevel(published_inverse, published_filter, at, 0.0);
    let norm = textureSampleLevel(published_norm, published_filter, at, 0.0);
    let inverse = mat3x3f(t.x, 0.0, t.y, 0.0, 1.0, 0.0, t.z, 0.0, t.w);
    let tangent = normalize(vec3f(p.wo.xy, 0.0));
    let turn = mat3x3f(tangent, vec3f(-tangent.y, tangent.x, 0.0), vec3f(0.0, 0.0, 1.0));
    let lobe = TimedLobe(inverse * transpose(turn), inverse);
    return TimedFound(lobe, timed_reflectance(norm.x, norm.y));
}
