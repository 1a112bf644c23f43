// Heitz and Hill 2017, listings 1.5 to 1.7 with l * l for the listings' 1 * 1 and l for their 1 in the first. Clipped to the horizon
// of cosine space alone.

fn published_fpo(d: f32, l: f32) -> f32 {
    return l / (d * (d * d + l * l)) + atan(l / d) / (d * d);
}

fn published_fwt(d: f32, l: f32) -> f32 {
    return l * l / (d * (d * d + l * l));
}

fn published_diffuse_line(q1: vec3f, q2: vec3f) -> f32 {
    var p1 = q1;
    var p2 = q2;
    let wt = normalize(p2 - p1);
    if p1.z <= 0.0 && p2.z <= 0.0 {
        return 0.0;
    }
    if p1.z < 0.0 {
        p1 = (p1 * p2.z - p2 * p1.z) / (p2.z - p1.z);
    }
    if p2.z < 0.0 {
        p2 = (-p1 * p2.z + p2 * p1.z) / (-p2.z + p1.z);
    }
    let l1 = dot(p1, wt);
    let l2 = dot(p2, wt);
    let po = p1 - l1 * wt;
    let d = length(po);
    let i = (published_fpo(d, l2) - published_fpo(d, l1)) * po.z + (published_fwt(d, l2) - published_fwt(d, l1)) * wt.z;
    return i / 3.1415927;
}

fn timed_fraction(lobe: TimedLobe, position: vec3f, light: u32) -> f32 {
    let p1 = timed_points[2u * light].xyz - position;
    let p2 = timed_points[2u * light + 1u].xyz - position;
    let diffuse = published_diffuse_line(lobe.inverse * p1, lobe.inverse * p2);
    let ortho = normalize(cross(p1, p2));
    let width = 1.0 / length(transpose(lobe.m) * ortho);
    return min(1.0, timed_points[2u * light].w * width * diffuse);
}
