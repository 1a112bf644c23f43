// On which side of a flat light the shading point is. No bindings. Needs: math, precise.

fn ltc_emits_towards(facing: f32, two_sided: bool) -> bool {
    return facing > 0.0 || (two_sided && facing < 0.0);
}

// The distance of the shading point in front of the plane with this normal through `point`, times the normal's length;
// exactly 0 where rounding decides the side: within 8 epsilon of `reach`, how far what defines the plane is away.
fn ltc_facing(normal: vec3f, point: vec3f, reach: f32) -> f32 {
    let facing = -dot(normal, point);
    return select(0.0, facing, abs(facing) > 9.5367432e-7 * reach * length(normal));
}
