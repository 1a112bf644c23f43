//! Every hazard of light geometry by name, over every shape where it applies and in both precisions, each with its defined
//! answer. `docs/stability.md` lists them.

#![expect(clippy::unwrap_used, reason = "a test fails by a panic")]

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DMat3, DVec3, dvec3};
use ltc_core::{AnyLight, Horizon, InputError, Ltc, Matrix, Real, ShadingFrame, Sides, Vector};

macro_rules! in_both_precisions {
    ($($hazard:ident),+ $(,)?) => {
        mod f32 { $(#[test] fn $hazard() { super::$hazard::<f32>(); })+ }
        mod f64 { $(#[test] fn $hazard() { super::$hazard::<f64>(); })+ }
    };
}

in_both_precisions!(
    view_parallel_to_the_normal,
    edge_ends_equal,
    edge_ends_antipodal,
    an_edge_of_nearly_half_a_turn,
    point_in_the_plane_of_a_flat_light,
    point_on_the_surface_of_a_solid,
    point_inside_a_solid,
    light_below_the_horizon,
    light_partly_below_the_horizon,
    light_behind_its_own_face,
    non_convex_and_self_touching,
    no_area_no_length_no_radius,
    line_through_the_shading_point,
    line_ever_nearer_to_the_shading_point,
    ends_on_one_ray,
    ellipse_whose_cubic_has_coincident_roots,
    disk_edge_on_and_nearly_so,
    near_and_far,
    narrowest_and_widest_lobes,
    ever_more_anisotropic_lobe,
    grazing_lobe,
    determinant_to_zero_and_condition_1e8,
    nan_and_infinity,
    leak_below_the_horizon,
);

const COSINE: DMat3 = DMat3::IDENTITY;

fn tilted() -> DMat3 {
    DMat3::from_cols(dvec3(0.4, 0.1, 0.0), dvec3(0.0, 0.3, -0.1), dvec3(0.3, 0.2, 0.9))
}

fn try_fraction<R: Real>(m: DMat3, light: &AnyLight, horizon: Horizon) -> Result<f64, InputError> {
    let m = m.to_row_array().map(R::of);
    let ltc = Ltc::<R>::new(R::Mat3::from_row_array(m))?;
    Ok(light.integrate(&ltc, horizon)?.to_f64())
}

fn fraction<R: Real>(m: DMat3, light: &AnyLight) -> f64 {
    try_fraction::<R>(m, light, Horizon::BOTH).unwrap()
}

/// `of_f32` or `of_f64`.
fn pick<R: Real>(of_f32: f64, of_f64: f64) -> f64 {
    if R::EPSILON.to_f64() > 1e-10 { of_f32 } else { of_f64 }
}

/// What rounding of moderate numbers costs.
fn rounding<R: Real>() -> f64 {
    pick::<R>(5e-6, 1e-12)
}

#[track_caller]
fn assert_near<R: Real>(m: DMat3, light: &AnyLight, expected: f64, tolerance: f64) {
    let value = fraction::<R>(m, light);
    assert!((value - expected).abs() <= tolerance, "{value}, not {expected}: {light:?}");
}

#[track_caller]
fn assert_dark<R: Real>(light: &AnyLight) {
    for m in [COSINE, tilted()] {
        assert_eq!(fraction::<R>(m, light), 0.0, "{light:?}");
    }
}

fn polygon(vertices: &[DVec3]) -> AnyLight {
    AnyLight::Polygon { vertices: vertices.iter().map(DVec3::to_array).collect(), sides: Sides::Two }
}

/// The rectangle around `centre` with half-axes `u` and `v`.
fn rectangle(centre: DVec3, u: DVec3, v: DVec3) -> AnyLight {
    polygon(&[centre - u - v, centre + u - v, centre + u + v, centre - u + v])
}

fn disk(centre: DVec3, normal: DVec3, radius: f64) -> AnyLight {
    AnyLight::Disk { center: centre.to_array(), normal: normal.to_array(), radius, sides: Sides::Two }
}

fn ellipse(centre: DVec3, u: DVec3, v: DVec3) -> AnyLight {
    let [center, axis_u, axis_v] = [centre, u, v].map(|p| p.to_array());
    AnyLight::Ellipse { center, axis_u, axis_v, sides: Sides::Two }
}

fn sphere(centre: DVec3, radius: f64) -> AnyLight {
    AnyLight::Sphere { center: centre.to_array(), radius }
}

fn line(p0: DVec3, p1: DVec3, radius: f64) -> AnyLight {
    AnyLight::Line { p0: p0.to_array(), p1: p1.to_array(), radius }
}

fn strip(p0: DVec3, p1: DVec3, normal: DVec3, width: f64) -> AnyLight {
    let [p0, p1, normal] = [p0, p1, normal].map(|p| p.to_array());
    AnyLight::Strip { p0, p1, width, normal, sides: Sides::Two }
}

fn cylinder(p0: DVec3, p1: DVec3, radius: f64, caps: bool) -> AnyLight {
    AnyLight::Cylinder { p0: p0.to_array(), p1: p1.to_array(), radius, caps }
}

/// One flat light of each shape around `centre`, `u` and `v` being half-axes at right angles.
fn flat(centre: DVec3, u: DVec3, v: DVec3) -> Vec<AnyLight> {
    let normal = u.cross(v);
    vec![
        rectangle(centre, u, v),
        disk(centre, normal, u.length()),
        ellipse(centre, u, v),
        strip(centre - u, centre + u, normal, v.length()),
    ]
}

/// One light of each shape, the thin ones thin.
fn all(centre: DVec3, size: f64) -> Vec<AnyLight> {
    let (u, v) = (dvec3(1.0, 0.0, 0.0) * size, dvec3(0.0, 0.6, 0.8) * size);
    let mut lights = flat(centre, u, v);
    let ends = [centre - u, centre + u];
    lights.extend([
        line(ends[0], ends[1], 0.02 * size),
        cylinder(ends[0], ends[1], 0.5 * size, false),
        cylinder(ends[0], ends[1], 0.5 * size, true),
        sphere(centre, size),
    ]);
    lights
}

/// There is no tangent in the view direction: any will do, and a light is seen the same in every such frame.
fn view_parallel_to_the_normal<R: Real>() {
    let vector = |v: DVec3| R::Vec3::new(R::of(v.x), R::of(v.y), R::of(v.z));
    for normal in [DVec3::Z, dvec3(0.6, 0.0, 0.8), dvec3(-0.3, 0.4, -0.2)] {
        for view in [normal, normal * -2.0, DVec3::ZERO] {
            let frame = ShadingFrame::<R>::from_normal_and_view(vector(normal), vector(view)).unwrap();
            let axes = [frame.tangent(), frame.bitangent(), frame.normal()];
            for (i, a) in axes.iter().enumerate() {
                for (j, b) in axes.iter().enumerate() {
                    let expected = f64::from(u8::from(i == j));
                    assert!((a.dot(*b).to_f64() - expected).abs() < 4.0 * R::EPSILON.to_f64());
                }
            }
            // r²/(r² + d²) of a disk along the normal.
            let place = |axis: R::Vec3| axis.dot(vector(normal)).to_f64() / normal.length();
            let centre = DVec3::from_array(axes.map(place)) * 2.0;
            assert_near::<R>(COSINE, &disk(centre, centre, 1.0), 0.2, rounding::<R>());
        }
    }
}

/// An edge without length adds nothing.
fn edge_ends_equal<R: Real>() {
    let [a, b, c] = [dvec3(-0.2, -0.3, 1.0), dvec3(0.9, -0.3, 1.1), dvec3(0.9, 0.5, 1.2)];
    for m in [COSINE, tilted()] {
        let value = fraction::<R>(m, &polygon(&[a, b, c]));
        assert!(value > 0.01);
        for repeated in [vec![a, a, b, c], vec![a, b, b, b, c], vec![a, b, c, a], vec![a, b, c, c]] {
            assert_near::<R>(m, &polygon(&repeated), value, rounding::<R>());
        }
    }
}

/// An edge, line or strip from a point to its opposite passes through the shading point: 0.
fn edge_ends_antipodal<R: Real>() {
    for (p, q) in [(dvec3(1.0, 2.0, 2.0), DVec3::Y), (DVec3::X, DVec3::Z)] {
        assert_dark::<R>(&polygon(&[p, -p, q - p, q + p]));
        assert_dark::<R>(&line(p, -p, 0.1));
        assert_dark::<R>(&strip(p, -p, p.any_orthogonal_vector(), 0.1));
        assert_dark::<R>(&cylinder(p, -p, 0.1, false));
    }
}

/// Right under an edge of a square that is much nearer than wide. A rational edge term loses most of that edge.
fn an_edge_of_nearly_half_a_turn<R: Real>() {
    // Form factor seen from below the corner of a parallel rectangle a × b at distance 1.
    let corner = |a: f64, b: f64| {
        let (x, y) = ((1.0 + a * a).sqrt(), (1.0 + b * b).sqrt());
        (a / x * (b / x).atan() + b / y * (a / y).atan()) / TAU
    };
    for height in [1e-1, 1e-3, 1e-5, 1e-7] {
        let light = rectangle(dvec3(0.0, 1.0, height), DVec3::X, DVec3::Y);
        let expected = 2.0 * corner(1.0 / height, 2.0 / height);
        assert_near::<R>(COSINE, &light, expected, rounding::<R>());
    }
}

/// Seen from its own plane a flat light has no solid angle, wherever in the plane the point is: inside, on an edge, on a
/// vertex, or beside it.
fn point_in_the_plane_of_a_flat_light<R: Real>() {
    for (y, z) in [(0.0, 0.0), (1.0, 0.5), (0.0, 1.0), (1.0, 1.0), (0.0, 3.0), (4.0, 0.25)] {
        for light in flat(dvec3(0.0, y, z), DVec3::Y, DVec3::Z) {
            assert_dark::<R>(&light);
        }
    }
    let [a, b, c] = [dvec3(0.0, -0.5, 1.0), DVec3::ZERO, dvec3(0.0, 0.5, 1.0)];
    assert_dark::<R>(&polygon(&[a, b, c]));
}

/// The surface counts as inside.
fn point_on_the_surface_of_a_solid<R: Real>() {
    let all_of_it = rounding::<R>();
    for centre in [DVec3::Z, DVec3::X, dvec3(0.0, -1.0, 0.0)] {
        assert_near::<R>(COSINE, &sphere(centre, 1.0), 1.0, all_of_it);
        let across = dvec3(centre.y, centre.z, centre.x);
        assert_near::<R>(COSINE, &cylinder(centre - across, centre + across, 1.0, true), 1.0, all_of_it);
        assert_dark::<R>(&cylinder(centre - across, centre + across, 1.0, false));
    }
}

/// Everything above the surface is seen from inside a closed solid, `½ (1 + m₂₂/‖(m₂₀, m₂₁, m₂₂)‖)` of a lobe; a tube is dark
/// inside.
fn point_inside_a_solid<R: Real>() {
    let centre = dvec3(0.1, 0.2, -0.1);
    for m in [COSINE, tilted()] {
        let row = m.row(2);
        let above = 0.5 * (1.0 + row.z / row.length());
        assert_near::<R>(m, &sphere(centre, 1.0), above, rounding::<R>());
        let ends = [centre - DVec3::X, centre + DVec3::X];
        assert_near::<R>(m, &cylinder(ends[0], ends[1], 1.0, true), above, rounding::<R>());
    }
    assert_dark::<R>(&cylinder(centre - DVec3::X, centre + DVec3::X, 1.0, false));
}

fn light_below_the_horizon<R: Real>() {
    for centre in [dvec3(0.3, 0.2, -2.0), dvec3(3.0, 0.0, -1.0), dvec3(-5.0, 4.0, -1.5)] {
        for light in all(centre, 1.0) {
            assert_dark::<R>(&light);
        }
    }
    // In it.
    for light in flat(dvec3(3.0, 0.0, 0.0), DVec3::X, DVec3::Y) {
        assert_dark::<R>(&light);
    }
    assert_dark::<R>(&line(dvec3(3.0, -1.0, 0.0), dvec3(3.0, 1.0, 0.0), 0.1));
}

/// The part above counts.
fn light_partly_below_the_horizon<R: Real>() {
    let (centre, tolerance) = (dvec3(2.0, 0.3, 0.0), 10.0 * rounding::<R>());
    let up = DVec3::Z;
    let upper = centre + up * 0.5;
    for m in [COSINE, tilted()] {
        let same = |whole: &AnyLight, half: &AnyLight, tolerance: f64| {
            let value = fraction::<R>(m, half);
            assert!(value > 1e-4, "{half:?}");
            assert_near::<R>(m, whole, value, tolerance);
        };
        same(&rectangle(centre, DVec3::Y, up), &rectangle(upper, DVec3::Y, up * 0.5), tolerance);
        same(&line(centre - up, centre + up, 0.1), &line(centre, centre + up, 0.1), tolerance);
        let wall = |p0, p1| strip(p0, p1, DVec3::X, 0.1);
        same(&wall(centre - up, centre + up), &wall(centre, centre + up), tolerance);
        for caps in [false, true] {
            let upright = |p0, p1| cylinder(p0, p1, 0.5, caps);
            same(&upright(centre - up, centre + up), &upright(centre, centre + up), tolerance);
        }
        // Half an ellipse as a polygon.
        let rim: Vec<DVec3> = (0..=4000)
            .map(|i| {
                let (sin, cos) = (PI * f64::from(i) / 4000.0).sin_cos();
                centre + DVec3::Y * cos + up * sin
            })
            .collect();
        same(&disk(centre, DVec3::X, 1.0), &polygon(&rim), tolerance + 1e-6);
        same(&ellipse(centre, DVec3::Y, up), &polygon(&rim), tolerance + 1e-6);
    }
    // Of half a sphere Lambert sees (σ − sin σ cos σ)/π.
    let sigma = 0.5_f64.asin();
    let expected = (sigma - 0.5 * sigma.cos()) / PI;
    assert_near::<R>(COSINE, &sphere(dvec3(0.0, 2.0, 0.0), 1.0), expected, rounding::<R>());
}

/// A one-sided light is dark from behind.
fn light_behind_its_own_face<R: Real>() {
    let (centre, u, v) = (dvec3(0.2, 0.1, 1.5), DVec3::X * 0.5, DVec3::Y * 0.5);
    for (front, back) in flat(centre, v, u).into_iter().zip(flat(centre, u, v)) {
        let [front, back] = [front, back].map(|light| match light {
            AnyLight::Polygon { vertices, .. } => AnyLight::Polygon { vertices, sides: Sides::One },
            AnyLight::Disk { center, normal, radius, .. } => {
                AnyLight::Disk { center, normal, radius, sides: Sides::One }
            }
            AnyLight::Ellipse { center, axis_u, axis_v, .. } => {
                AnyLight::Ellipse { center, axis_u, axis_v, sides: Sides::One }
            }
            AnyLight::Strip { p0, p1, width, normal, .. } => {
                AnyLight::Strip { p0, p1, width, normal, sides: Sides::One }
            }
            other => other,
        });
        assert_dark::<R>(&back);
        assert!(fraction::<R>(COSINE, &front) > 0.01, "{front:?}");
    }
}

fn non_convex_and_self_touching<R: Real>() {
    let at = |x: f64, y: f64| dvec3(x, y, 1.0);
    let ell = polygon(&[at(0.0, 0.0), at(2.0, 0.0), at(2.0, 1.0), at(1.0, 1.0), at(1.0, 2.0), at(0.0, 2.0)]);
    let parts = [
        polygon(&[at(0.0, 0.0), at(2.0, 0.0), at(2.0, 1.0), at(0.0, 1.0)]),
        polygon(&[at(0.0, 1.0), at(1.0, 1.0), at(1.0, 2.0), at(0.0, 2.0)]),
    ];
    // Two triangles that share a corner, wound the same way.
    let bow =
        polygon(&[at(0.0, 0.0), at(1.0, -1.0), at(1.0, 1.0), at(0.0, 0.0), at(-1.0, 1.0), at(-1.0, -1.0)]);
    let wings = [
        polygon(&[at(0.0, 0.0), at(1.0, -1.0), at(1.0, 1.0)]),
        polygon(&[at(0.0, 0.0), at(-1.0, 1.0), at(-1.0, -1.0)]),
    ];
    for m in [COSINE, tilted()] {
        for (whole, parts) in [(&ell, &parts), (&bow, &wings)] {
            let sum = parts.iter().map(|part| fraction::<R>(m, part)).sum();
            assert_near::<R>(m, whole, sum, rounding::<R>());
        }
    }
}

fn no_area_no_length_no_radius<R: Real>() {
    let (p, q, normal) = (dvec3(0.1, 0.2, 1.0), dvec3(0.6, -0.3, 1.5), DVec3::X);
    for light in [
        polygon(&[p, p, p]),
        polygon(&[p, q, p]),
        polygon(&[p, q, q, p]),
        disk(p, normal, 0.0),
        ellipse(p, q, DVec3::ZERO),
        ellipse(p, q, q * 2.0),
        sphere(p, 0.0),
        line(p, q, 0.0),
        line(p, p, 0.1),
        strip(p, q, normal, 0.0),
        strip(p, p, normal, 0.1),
        cylinder(p, q, 0.0, true),
        cylinder(p, p, 0.1, true),
        sphere(DVec3::ZERO, 0.0),
        polygon(&[DVec3::ZERO; 4]),
    ] {
        assert_dark::<R>(&light);
    }
}

/// The line's integral is 0 there; a solid has the point inside.
fn line_through_the_shading_point<R: Real>() {
    let p = dvec3(0.5, 0.25, 1.0);
    for (p0, p1) in [(p, -p), (p * 2.0, p * -0.5), (DVec3::ZERO, p)] {
        assert_dark::<R>(&line(p0, p1, 0.1));
        assert_dark::<R>(&strip(p0, p1, DVec3::X, 0.1));
        assert_dark::<R>(&cylinder(p0, p1, 0.1, false));
        assert_near::<R>(COSINE, &cylinder(p0, p1, 0.1, true), 1.0, rounding::<R>());
    }
}

/// Of a long line overhead Lambert sees radius over distance, however small the distance.
fn line_ever_nearer_to_the_shading_point<R: Real>() {
    for exponent in [1, 3, 6, 9, 12, 20] {
        let height = 10f64.powi(-exponent);
        let at = |x: f64| dvec3(x, 0.0, height);
        // What is missing beyond the ends is of the order of the height's cube.
        let expected = 0.01;
        let tolerance = rounding::<R>() + height.powi(3);
        assert_near::<R>(COSINE, &line(at(-1.0), at(1.0), 0.01 * height), expected, tolerance);
        assert_near::<R>(COSINE, &strip(at(-1.0), at(1.0), DVec3::Z, 0.02 * height), expected, tolerance);
    }
}

/// Both ends in one direction: a line and a tube show nothing, a closed cylinder its end.
fn ends_on_one_ray<R: Real>() {
    for p in [dvec3(0.5, -0.25, 1.0), DVec3::Z, dvec3(2.0, 1.0, 0.5)] {
        assert_dark::<R>(&line(p, p * 2.0, 0.1));
        assert_dark::<R>(&strip(p, p * 2.0, p.any_orthogonal_vector(), 0.1));
        assert_dark::<R>(&cylinder(p, p * 2.0, 0.1, false));
        for m in [COSINE, tilted()] {
            let end = fraction::<R>(m, &disk(p, p, 0.1));
            assert_near::<R>(m, &cylinder(p, p * 2.0, 0.1, true), end, rounding::<R>());
        }
    }
}

/// A round cone around any axis has two equal roots; a point nearly in the plane of an ellipse has others. r²/(r² + d²) along
/// the normal, times the cosine.
fn ellipse_whose_cubic_has_coincident_roots<R: Real>() {
    for axis in [DVec3::Z, dvec3(0.6, 0.0, 0.8), dvec3(0.0, -0.28, 0.96)] {
        for radius in [1e-3, 0.2] {
            let expected = radius * radius / (1.0 + radius * radius) * axis.z;
            let (u, v) = axis.any_orthonormal_pair();
            for stretch in [1.0, 1.0 + 1e-12, 1.0 + 1e-7] {
                let tolerance = rounding::<R>() + (stretch - 1.0);
                assert_near::<R>(
                    COSINE,
                    &ellipse(axis, u * radius * stretch, v * radius),
                    expected,
                    tolerance,
                );
            }
            assert_near::<R>(COSINE, &disk(axis, axis, radius), expected, rounding::<R>());
        }
    }
    // The lobe can make the cone round, too: cosine space squeezes this one.
    let m = DMat3::from_diagonal(dvec3(0.25, 0.5, 1.0));
    let light = ellipse(DVec3::Z, DVec3::X * 0.25, DVec3::Y * 0.5);
    assert_near::<R>(m, &light, 0.5, rounding::<R>());
}

/// Exactly edge-on: 0. Beside an upright disk's plane by h: in proportion to h; right under a disk by h: nearly all.
fn disk_edge_on_and_nearly_so<R: Real>() {
    for light in
        [disk(dvec3(0.0, 0.3, 2.0), DVec3::X, 1.0), ellipse(dvec3(0.0, 0.3, 2.0), DVec3::Y, DVec3::Z)]
    {
        assert_dark::<R>(&light);
    }
    let beside = |h: f64| fraction::<R>(COSINE, &disk(dvec3(h, 0.3, 2.0), DVec3::X, 1.0)) / h;
    let slope = beside(1e-3);
    assert!(slope > 0.1 && slope < 1.0, "{slope}");
    for h in [1e-4, 1e-5, 1e-6, 1e-7] {
        assert!((beside(h) / slope - 1.0).abs() < 1e-3, "{h}: {} {slope}", beside(h));
        assert_near::<R>(COSINE, &disk(DVec3::Z * h, DVec3::Z, 1.0), 1.0 / (1.0 + h * h), rounding::<R>());
        // Beside the plane of the disk, not under it.
        assert_near::<R>(COSINE, &disk(dvec3(1.5, 0.0, h), DVec3::Z, 1.0), 0.0, h + rounding::<R>());
    }
}

/// Only ratios of lengths matter.
fn near_and_far<R: Real>() {
    for m in [COSINE, tilted()] {
        let values: Vec<f64> =
            all(dvec3(0.4, 0.3, 2.5), 1.0).iter().map(|light| fraction::<R>(m, light)).collect();
        for exponent in [-12, -6, -3, 3, 6, 12] {
            let scale = 10f64.powi(exponent);
            for (light, value) in all(dvec3(0.4, 0.3, 2.5) * scale, scale).iter().zip(&values) {
                assert!(*value > 1e-3);
                assert_near::<R>(m, light, *value, rounding::<R>());
            }
        }
        // A light of size 1 that is 1e6 away: its solid angle of some 1e-12, not noise.
        for light in all(dvec3(0.6e6, 0.0, 0.8e6), 1.0) {
            let value = fraction::<R>(m, &light);
            assert!((1e-15..1e-10).contains(&value), "{value:e}: {light:?}");
        }
    }
}

/// The narrowest lobe is in the light or beside it; the widest is the cosine.
fn narrowest_and_widest_lobes<R: Real>() {
    let needle = DMat3::from_diagonal(dvec3(1e-4, 1e-4, 1.0));
    for light in [
        rectangle(DVec3::Z * 2.0, DVec3::X, DVec3::Y),
        disk(DVec3::Z * 2.0, DVec3::Z, 1.0),
        ellipse(DVec3::Z * 2.0, DVec3::X, DVec3::Y * 0.5),
        sphere(DVec3::Z * 2.0, 1.0),
        cylinder(dvec3(-1.0, 0.0, 2.0), dvec3(1.0, 0.0, 2.0), 0.5, false),
        line(dvec3(-1.0, 0.0, 2.0), dvec3(1.0, 0.0, 2.0), 0.5),
    ] {
        assert_near::<R>(needle, &light, 1.0, 1e-6 + rounding::<R>());
    }
    for light in all(dvec3(3.0, 3.0, 3.0), 1.0) {
        assert_near::<R>(needle, &light, 0.0, 1e-6);
    }
    assert_near::<R>(COSINE, &disk(DVec3::Z, DVec3::Z, 1.0), 0.5, rounding::<R>());
}

/// λ → 0: the lobe becomes a fan in a plane, of density cos/2 over the angle in it.
fn ever_more_anisotropic_lobe<R: Real>() {
    for ratio in [1e-2, 1e-4, 1e-6] {
        let m = DMat3::from_diagonal(dvec3(1.0, ratio, 1.0));
        let expected = 0.5_f64.atan().sin();
        let tolerance = 3.0 * ratio + rounding::<R>();
        for light in [
            rectangle(DVec3::Z, DVec3::X * 0.5, DVec3::Y * 0.5),
            disk(DVec3::Z, DVec3::Z, 0.5),
            ellipse(DVec3::Z, DVec3::X * 0.5, DVec3::Y * 0.3),
        ] {
            assert_near::<R>(m, &light, expected, tolerance);
        }
        // Beside the plane.
        assert_near::<R>(m, &rectangle(dvec3(0.0, 2.0, 1.0), DVec3::X, DVec3::Y), 0.0, tolerance);
        assert_near::<R>(m, &sphere(dvec3(0.0, 2.0, 1.0), 1.0), 0.0, tolerance);
    }
}

/// θ → 90°: half of the lobe is below the surface, and never counts.
fn grazing_lobe<R: Real>() {
    for below in [1.0, 1e-2, 0.0] {
        let m = DMat3::from_rotation_y(FRAC_PI_2 - f64::to_radians(below))
            * DMat3::from_diagonal(dvec3(0.1, 0.1, 1.0));
        let row = m.row(2);
        let above = 0.5 * (1.0 + row.z / row.length());
        assert_near::<R>(m, &sphere(DVec3::ZERO, 1.0), above, rounding::<R>());
        // A wall across the lobe, from far below to far above.
        let wall = rectangle(dvec3(1.0, 0.0, 0.0), DVec3::Y * 1e4, DVec3::Z * 1e4);
        assert_near::<R>(m, &wall, above, 1e-6 + rounding::<R>());
        assert_near::<R>(m, &disk(dvec3(1.0, 0.0, 0.0), DVec3::X, 1e4), above, 1e-6 + rounding::<R>());
    }
}

/// A matrix of condition 1e8 answers, or is refused in words; one without an inverse is refused.
fn determinant_to_zero_and_condition_1e8<R: Real>() {
    for small in [1e-6, 1e-8] {
        let needle = DMat3::from_diagonal(dvec3(small, small, 1.0));
        for light in [
            rectangle(DVec3::Z, DVec3::X * 0.5, DVec3::Y * 0.5),
            disk(DVec3::Z, DVec3::Z, 0.5),
            ellipse(DVec3::Z, DVec3::X * 0.5, DVec3::Y * 0.2),
            sphere(DVec3::Z, 0.5),
            cylinder(dvec3(-1.0, 0.0, 1.0), dvec3(1.0, 0.0, 1.0), 0.5, true),
        ] {
            // What is missing is the square of the lobe's width over the light's.
            assert_near::<R>(needle, &light, 1.0, 30.0 * small * small + rounding::<R>());
        }
        for light in all(dvec3(3.0, 3.0, 3.0), 1.0) {
            assert_near::<R>(needle, &light, 0.0, rounding::<R>());
        }
    }
    let singular = DMat3::from_diagonal(dvec3(0.0, 1.0, 1.0));
    let mirrored = DMat3::from_diagonal(dvec3(1.0, 1.0, -1.0));
    for m in [DMat3::ZERO, singular, mirrored] {
        let refused = try_fraction::<R>(m, &sphere(DVec3::Z, 0.5), Horizon::BOTH);
        assert!(matches!(refused, Err(InputError::SingularMatrix { .. })), "{refused:?}");
    }
}

/// An error that says which number.
fn nan_and_infinity<R: Real>() {
    let p = dvec3(0.5, 0.2, 1.0);
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let q = dvec3(0.1, bad, 1.0);
        for light in [
            polygon(&[p, q, DVec3::Z]),
            line(p, q, 0.1),
            line(p, p, bad),
            strip(q, p, DVec3::X, 0.1),
            strip(-p, p, q, 0.1),
            strip(-p, p, DVec3::X, bad),
            cylinder(q, p, 0.1, true),
            cylinder(-p, p, bad, true),
            disk(q, DVec3::Z, 1.0),
            disk(p, q, 1.0),
            disk(p, DVec3::Z, bad),
            ellipse(q, DVec3::X, DVec3::Y),
            ellipse(p, q, DVec3::Y),
            sphere(q, 1.0),
            sphere(p, bad),
        ] {
            let refused = try_fraction::<R>(COSINE, &light, Horizon::BOTH);
            let is_named =
                matches!(refused, Err(InputError::NotFinite { .. } | InputError::OutOfRange { .. }));
            assert!(is_named, "{refused:?}: {light:?}");
        }
        let mut m = COSINE;
        m.x_axis.y = bad;
        let refused = try_fraction::<R>(m, &sphere(p, 0.1), Horizon::BOTH);
        assert!(matches!(refused, Err(InputError::NotFinite { .. })), "{refused:?}");
    }
    for light in [line(p, -p, -1.0), sphere(p, -1.0), disk(p, p, -1.0), cylinder(p, -p, -1.0, true)] {
        let refused = try_fraction::<R>(COSINE, &light, Horizon::BOTH);
        assert!(matches!(refused, Err(InputError::OutOfRange { .. })), "{refused:?}: {light:?}");
    }
    assert!(try_fraction::<R>(COSINE, &polygon(&[p, -p]), Horizon::BOTH).is_err());
    assert!(try_fraction::<R>(COSINE, &disk(p, DVec3::ZERO, 1.0), Horizon::BOTH).is_err());
}

/// A lobe that dips below the surface sees a light there, if it is cut in cosine space alone.
fn leak_below_the_horizon<R: Real>() {
    let m = DMat3::from_rotation_y(1.3) * DMat3::from_diagonal(dvec3(0.3, 0.3, 1.0));
    for light in all(dvec3(4.0, 0.0, -2.0), 1.0) {
        let leak = try_fraction::<R>(m, &light, Horizon::COSINE).unwrap();
        assert!(leak > 1e-4, "{leak}: {light:?}");
        assert_eq!(fraction::<R>(m, &light), 0.0, "{light:?}");
    }
}
