//! Deferred shading: GPU against `ltc_core` and `ltc_table` in f64.

use glam::{DVec3, Vec3};
use ltc_core::{Alpha, Horizon, Ltc, Matrix, ShadingFrame, Sides, reflectance};
use ltc_shade_gpu::{
    AreaLight, BakedSlices, Filtering, Gpu, GpuError, LightShape, Shader, ShadingOptions, SurfacePoint,
    TableTextures, Tables,
};
use ltc_table::{Mapping, Query, Table};

use crate::support::{gpu, random};
use crate::tables;

/// What the workspace promises for one light of unit radiance.
const TOLERANCE_PER_LIGHT: f64 = 1e-4;

struct Both {
    isotropic: Table,
    anisotropic: Table,
}

impl Both {
    fn new() -> Self {
        let anisotropic = tables::anisotropic(Mapping::SqrtOneMinusCos, Mapping::Sqrt);
        Self { isotropic: tables::isotropic(), anisotropic }
    }

    fn shade(&self, gpu: &Gpu, points: &[SurfacePoint], lights: &[AreaLight]) -> Vec<[f32; 3]> {
        let isotropic = TableTextures::upload(gpu, &self.isotropic).unwrap();
        let anisotropic = TableTextures::upload(gpu, &self.anisotropic).unwrap();
        let tables =
            Tables { isotropic: Some(&isotropic), anisotropic: Some(&anisotropic), ..Tables::default() };
        Shader::new(gpu).unwrap().shade(gpu, tables, points, lights).unwrap()
    }

    /// The same in f64 on the CPU.
    fn expected(&self, point: &SurfacePoint, lights: &[AreaLight]) -> DVec3 {
        let frame = ShadingFrame::<f64>::new(point.normal.as_dvec3(), point.tangent.as_dvec3()).unwrap();
        let wo = frame.shading_from_world(point.wo.as_dvec3());
        let query = Query {
            theta: wo.truncate().length().atan2(wo.z.max(0.0)),
            phi: wo.y.atan2(wo.x),
            alpha_x: f64::from(point.alpha_x),
            alpha_y: f64::from(point.alpha_y),
        };
        let table = if point.isotropic { &self.isotropic } else { &self.anisotropic };
        let found = table.lookup(&query).unwrap();
        let lobe = Ltc::<f64>::new(glam::DMat3::from_row_array(found.lobes[0].m)).unwrap();
        let specular = point
            .f0
            .as_dvec3()
            .to_array()
            .map(|f0| reflectance(f0, f64::from(point.f90), found.magnitude, found.fresnel));
        let mut sum = DVec3::ZERO;
        for light in lights {
            let light_here = seen_from(&light.shape, |v, is_point| {
                let from = if is_point { point.position.as_dvec3() } else { DVec3::ZERO };
                frame.shading_from_world(v.as_dvec3() - from).as_vec3()
            });
            let fraction = |lobe: &Ltc<f64>| light_here.integrate(lobe, Horizon::BOTH).unwrap();
            let reflected = DVec3::from_array(specular) * fraction(&lobe)
                + point.albedo.as_dvec3() * fraction(&Ltc::cosine());
            sum += light.radiance.as_dvec3() * reflected;
        }
        sum
    }
}

fn direction(rng: &mut impl FnMut() -> f64) -> Vec3 {
    loop {
        let v = DVec3::new(rng() - 0.5, rng() - 0.5, rng() - 0.5);
        if (0.01..0.25).contains(&v.length_squared()) {
            return v.as_vec3();
        }
    }
}

/// The shape with its points and directions moved; the closure learns which it has.
fn seen_from(shape: &LightShape, to: impl Fn(Vec3, bool) -> Vec3) -> LightShape {
    let mut shape = shape.clone();
    match &mut shape {
        LightShape::Quad { corners, .. } => corners.iter_mut().for_each(|p| *p = to(*p, true)),
        LightShape::Polygon { vertices, .. } => vertices.iter_mut().for_each(|p| *p = to(*p, true)),
        LightShape::Line { p0, p1, .. } | LightShape::Cylinder { p0, p1, .. } => {
            [*p0, *p1] = [*p0, *p1].map(|p| to(p, true));
        }
        LightShape::Strip { p0, p1, normal, .. } => {
            [*p0, *p1] = [*p0, *p1].map(|p| to(p, true));
            *normal = to(*normal, false);
        }
        LightShape::Disk { center, normal, .. } => {
            (*center, *normal) = (to(*center, true), to(*normal, false));
        }
        LightShape::Ellipse { center, axis_u, axis_v, .. } => {
            *center = to(*center, true);
            [*axis_u, *axis_v] = [*axis_u, *axis_v].map(|v| to(v, false));
        }
        LightShape::Sphere { center, .. } => *center = to(*center, true),
    }
    shape
}

fn unit_color(rng: &mut impl FnMut() -> f64) -> Vec3 {
    DVec3::new(rng(), rng(), rng()).as_vec3()
}

/// Points anywhere in a box, seen from anywhere above their surface; every fourth one isotropic, and among all every width
/// order and tangents that are rotated, slanted, zero or parallel to the normal.
fn points(count: usize, rng: &mut impl FnMut() -> f64) -> Vec<SurfacePoint> {
    (0..count)
        .map(|i| {
            let normal = direction(rng);
            let wo = direction(rng);
            let isotropic = i % 4 == 0;
            let alpha_x = (0.02 + 0.98 * rng()) as f32;
            // Without a direction of its own, a tangent means nothing to an anisotropic material.
            let tangent = match (isotropic, i % 16) {
                (true, 4) => Vec3::ZERO,
                (true, 8) => normal * 3.0,
                _ => direction(rng),
            };
            SurfacePoint {
                position: direction(rng) * 4.0,
                normal,
                tangent,
                wo: if wo.dot(normal) < 0.0 { -wo } else { wo },
                alpha_x,
                alpha_y: if isotropic { alpha_x } else { (0.02 + 0.98 * rng()) as f32 },
                isotropic,
                slice: None,
                f0: unit_color(rng),
                f90: rng() as f32,
                albedo: if i % 3 == 0 { Vec3::ZERO } else { unit_color(rng) },
            }
        })
        .collect()
}

/// Lights of all shapes in turn.
fn lights(count: usize, rng: &mut impl FnMut() -> f64) -> Vec<AreaLight> {
    (0..count).map(|i| AreaLight::new(shape(i, rng), unit_color(rng))).collect()
}

fn shape(i: usize, rng: &mut impl FnMut() -> f64) -> LightShape {
    let (center, u, v) = (direction(rng) * 6.0, direction(rng) * 4.0, direction(rng) * 4.0);
    let sides = if i.is_multiple_of(2) { Sides::Two } else { Sides::One };
    let corners = [center - u - v, center + u - v, center + u + v, center - u + v];
    let (p0, p1, caps) = (center - u, center + u, i.is_multiple_of(2));
    match i % 8 {
        0 => LightShape::Quad { corners, sides },
        1 => LightShape::Polygon { vertices: corners.to_vec(), sides },
        2 => LightShape::Line { p0, p1, radius: 0.01, caps },
        3 => LightShape::Strip { p0, p1, width: 0.02, normal: v, sides },
        4 => LightShape::Cylinder { p0, p1, radius: 0.2, caps },
        5 => LightShape::Disk { center, normal: u, radius: 0.7, sides },
        6 => LightShape::Ellipse { center, axis_u: u, axis_v: v, sides },
        _ => LightShape::Sphere { center, radius: 0.6 },
    }
}

/// The largest difference of a channel, and how many points are lit.
fn largest_error(
    both: &Both,
    points: &[SurfacePoint],
    lights: &[AreaLight],
    radiance: &[[f32; 3]],
) -> (f64, usize) {
    assert_eq!(points.len(), radiance.len());
    let (mut largest, mut lit) = (0.0_f64, 0);
    for (point, result) in points.iter().zip(radiance) {
        let result = Vec3::from_array(*result);
        assert!(result.min_element() >= 0.0, "{result} for {point:?}");
        let expected = both.expected(point, lights);
        largest = largest.max((expected - result.as_dvec3()).abs().max_element());
        lit += usize::from(expected.max_element() > 0.01);
    }
    (largest, lit)
}

#[test]
fn random_points_agree_with_the_cpu() {
    let Some(gpu) = gpu(Filtering::Exact) else { return };
    let both = Both::new();
    let mut rng = random(21);
    let points = points(12_000, &mut rng);
    let lights = lights(5, &mut rng);
    let radiance = both.shade(&gpu, &points, &lights);
    let (error, lit) = largest_error(&both, &points, &lights, &radiance);
    println!("shading: {lit} of {} points lit, largest error {error:.2e}", points.len());
    assert!(error <= TOLERANCE_PER_LIGHT * lights.len() as f64, "{error}");
    assert!(lit > 6_000, "{lit}");
    assert!(both.shade(&gpu, &points[..3], &[]).iter().all(|r| *r == [0.0; 3]), "no light, no radiance");
}

/// The texture unit of hardware rounds weights to 8 bits, which moves a narrow lobe by a part of its width: single points
/// may be off by several hundredths, the mean may not.
#[test]
fn hardware_filtering_shades_alike() {
    let Some(gpu) = gpu(Filtering::Hardware) else { return };
    let both = Both::new();
    let mut rng = random(22);
    let points = points(4_000, &mut rng);
    let lights = lights(2, &mut rng);
    let radiance = both.shade(&gpu, &points, &lights);
    let sum: f64 = points
        .iter()
        .zip(&radiance)
        .map(|(p, r)| (both.expected(p, &lights) - Vec3::from_array(*r).as_dvec3()).abs().element_sum() / 3.0)
        .sum();
    let mean = sum / points.len() as f64;
    println!("shading, by hardware: mean error {mean:.2e}");
    assert!(mean < 5e-3, "{mean}");
}

#[test]
fn a_wrong_tangent_is_seen() {
    // The control of the test above: the tangents turned a little.
    let Some(gpu) = gpu(Filtering::Exact) else { return };
    let both = Both::new();
    let mut rng = random(21);
    let points = points(400, &mut rng);
    let lights = lights(2, &mut rng);
    let turned: Vec<_> = points
        .iter()
        .map(|p| SurfacePoint { tangent: p.tangent + 0.05 * p.normal.cross(p.tangent), ..*p })
        .collect();
    let radiance = both.shade(&gpu, &turned, &lights);
    assert!(largest_error(&both, &points, &lights, &radiance).0 > 10.0 * TOLERANCE_PER_LIGHT);
}

#[test]
fn views_along_the_normal_and_along_the_surface_are_defined() {
    let Some(gpu) = gpu(Filtering::Exact) else { return };
    let both = Both::new();
    let mut rng = random(3);
    let mut points = points(64, &mut rng);
    for (i, point) in points.iter_mut().enumerate() {
        let along = point.normal.cross(direction(&mut rng));
        point.wo = match i % 4 {
            0 => point.normal,
            1 => point.normal * 1e-20,
            2 => along,
            // Below the surface: as on the horizon.
            _ => along - 0.2 * point.normal,
        };
    }
    let lights = lights(3, &mut rng);
    let radiance = both.shade(&gpu, &points, &lights);
    let exact: Vec<_> = points.iter().enumerate().filter(|(i, _)| i % 4 != 1).collect();
    for (i, point) in exact {
        // An anisotropic lobe seen along the normal depends on the azimuth's rounding in this made-up table.
        if point.isotropic || i % 4 != 0 {
            let error = (both.expected(point, &lights) - Vec3::from_array(radiance[i]).as_dvec3()).abs();
            assert!(error.max_element() < 3.0 * TOLERANCE_PER_LIGHT, "{i}: {error}");
        }
    }
}

#[test]
fn lights_below_the_horizon_add_exactly_nothing() {
    let Some(gpu) = gpu(Filtering::Exact) else { return };
    let both = Both::new();
    let mut rng = random(8);
    let mut points = points(4_000, &mut rng);
    for point in &mut points {
        point.position = Vec3::ZERO;
        point.normal = Vec3::Y;
        point.wo.y = point.wo.y.abs();
    }
    let below = |y: f32| AreaLight {
        texture: None,
        shape: LightShape::Quad {
            corners: [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, z]| Vec3::new(x, y, z)),
            sides: Sides::Two,
        },
        radiance: Vec3::splat(1e6),
    };
    let dark = both.shade(&gpu, &points, &[below(-1e-3), below(-2.0)]);
    assert!(dark.iter().all(|r| *r == [0.0; 3]));
    let lit = both.shade(&gpu, &points, &[below(1e-3)]);
    assert!(lit.iter().all(|r| r[0] > 0.0), "the control: the same light above the surface");
}

#[test]
fn isotropic_points_do_without_an_isotropic_table() {
    let Some(gpu) = gpu(Filtering::Exact) else { return };
    let both = Both::new();
    let anisotropic = TableTextures::upload(&gpu, &both.anisotropic).unwrap();
    let isotropic = TableTextures::upload(&gpu, &both.isotropic).unwrap();
    let shader = Shader::new(&gpu).unwrap();
    let mut rng = random(2);
    let points = points(8, &mut rng);
    let lights = lights(1, &mut rng);
    let only = Tables { anisotropic: Some(&anisotropic), ..Tables::default() };
    let results = shader.shade(&gpu, only, &points, &lights).unwrap();
    let as_anisotropic: Vec<_> = points.iter().map(|p| SurfacePoint { isotropic: false, ..*p }).collect();
    let (error, _) = largest_error(&both, &as_anisotropic, &lights, &results);
    assert!(error < TOLERANCE_PER_LIGHT, "{error}");
    let only = Tables { isotropic: Some(&isotropic), ..Tables::default() };
    let error = shader.shade(&gpu, only, &points, &lights).unwrap_err();
    assert!(matches!(error, GpuError::MissingTable { index: 1, .. }), "{error}");
}

/// As many materials as a scene has, each with a slice; isotropic points among them go to their own table.
#[test]
fn baked_slices_shade_as_the_table() {
    let Some(gpu) = gpu(Filtering::Exact) else { return };
    let both = Both::new();
    let mut rng = random(17);
    let (mut points, lights) = (points(2_000, &mut rng), lights(8, &mut rng));
    let palette: Vec<SurfacePoint> = points.iter().filter(|p| !p.isotropic).take(12).copied().collect();
    let width = |x: f32| f64::from(x);
    let widths: Vec<Alpha> =
        palette.iter().map(|p| Alpha::new(width(p.alpha_x), width(p.alpha_y)).unwrap()).collect();
    for (k, point) in points.iter_mut().enumerate().filter(|(_, p)| !p.isotropic) {
        let slice = k % palette.len();
        (point.alpha_x, point.alpha_y) = (palette[slice].alpha_x, palette[slice].alpha_y);
        point.slice = Some(slice as u32);
    }
    let isotropic = TableTextures::upload(&gpu, &both.isotropic).unwrap();
    let slices = BakedSlices::bake(&gpu, &both.anisotropic, &widths).unwrap();
    // The whole table is not on the device.
    let tables = Tables { isotropic: Some(&isotropic), baked: Some(&slices), ..Tables::default() };
    let options = ShadingOptions { baked: true, ..ShadingOptions::default() };
    let shader = Shader::with(&gpu, options).unwrap();
    let results = shader.shade(&gpu, tables, &points, &lights).unwrap();
    let (error, _) = largest_error(&both, &points, &lights, &results);
    println!("with baked slices: largest error {error:.1e}");
    assert!(error < TOLERANCE_PER_LIGHT * lights.len() as f64, "{error}");

    let anisotropic = points.iter().position(|p| p.slice.is_some()).unwrap();
    let slice = points[anisotropic].slice.unwrap();
    let others = SurfacePoint { slice: Some((slice + 1) % 12), ..points[anisotropic] };
    let beyond = SurfacePoint { slice: Some(12), ..points[anisotropic] };
    for bad in [others, beyond] {
        let error = shader.shade(&gpu, tables, &[bad], &lights).unwrap_err();
        assert!(matches!(error, GpuError::WrongSlice { item: "point", index: 0, .. }), "{error}");
    }
    // Neither without slices, nor by a pipeline that was not compiled for them.
    let none = Tables { baked: None, ..tables };
    for error in [
        shader.shade(&gpu, none, &points[anisotropic..=anisotropic], &lights).unwrap_err(),
        Shader::new(&gpu)
            .unwrap()
            .shade(&gpu, tables, &points[anisotropic..=anisotropic], &lights)
            .unwrap_err(),
    ] {
        assert!(matches!(error, GpuError::MissingTable { table: "baked", .. }), "{error}");
    }
}

#[test]
fn invalid_points_and_lights_are_refused_by_index() {
    let Some(gpu) = gpu(Filtering::Exact) else { return };
    let both = Both::new();
    let anisotropic = TableTextures::upload(&gpu, &both.anisotropic).unwrap();
    let tables = Tables { anisotropic: Some(&anisotropic), ..Tables::default() };
    let shader = Shader::new(&gpu).unwrap();
    let mut rng = random(4);
    let point = points(1, &mut rng)[0];
    let light = lights(1, &mut rng).remove(0);
    for bad in [
        SurfacePoint { position: Vec3::NAN, ..point },
        SurfacePoint { normal: Vec3::ZERO, ..point },
        SurfacePoint { wo: Vec3::INFINITY, ..point },
        SurfacePoint { alpha_x: -0.1, isotropic: false, ..point },
        SurfacePoint { f0: Vec3::new(0.0, f32::NAN, 0.0), ..point },
        SurfacePoint { f90: 1.5, ..point },
        SurfacePoint { albedo: Vec3::splat(-1.0), ..point },
    ] {
        let error = shader.shade(&gpu, tables, &[point, bad], std::slice::from_ref(&light)).unwrap_err();
        assert!(matches!(error, GpuError::Input { item: "point", index: 1, .. }), "{error}");
    }
    for bad in [
        AreaLight::new(LightShape::Sphere { center: Vec3::NAN, radius: 1.0 }, light.radiance),
        AreaLight::new(LightShape::Sphere { center: Vec3::ONE, radius: -1.0 }, light.radiance),
        AreaLight { radiance: Vec3::new(-1.0, 0.0, 0.0), ..light.clone() },
    ] {
        let error = shader.shade(&gpu, tables, &[point], &[light.clone(), light.clone(), bad]).unwrap_err();
        assert!(matches!(error, GpuError::Input { item: "light", index: 2, .. }), "{error}");
    }
    let stretched = SurfacePoint { isotropic: true, alpha_x: 0.1, alpha_y: 0.2, ..point };
    let error = shader.shade(&gpu, tables, &[stretched], std::slice::from_ref(&light)).unwrap_err();
    assert!(matches!(error, GpuError::NotIsotropic { index: 0, .. }), "{error}");
}
