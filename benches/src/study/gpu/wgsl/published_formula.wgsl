// The lobe of the scene's formula, both ways, at no cost of inverting.
fn timed_find(p: TimedPixel) -> TimedFound {
    let m = timed_matrix(p);
    let inverse = transpose(mat3x3f(m[0] / (p.alpha_x * p.alpha_x), m[1] / (p.alpha_y * p.alpha_y), m[2]));
    return TimedFound(TimedLobe(inverse, m), 1.0);
}
