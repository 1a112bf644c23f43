//! Forward shading against deferred shading of the same points.

use glam::{Mat4, Vec3, Vec4};
use ltc_core::{Alpha, PrefilteredTexture, Sides, TexelGrid};
use ltc_shade_gpu::{
    AreaLight, BakedSlices, Filtering, Forward, ForwardMaterial, ForwardVertex, ForwardView, Gpu, LightShape,
    LightTexture, LightTextures, Shader, ShadingOptions, SurfacePoint, TableTextures, Tables,
};
use ltc_table::Mapping;

use crate::support::gpu;
use crate::tables;

/// 1e-4, as between any two ways, of a light's radiance, which is 5: the device interpolates positions to its own precision.
const TOLERANCE: f32 = 1e-4 * 5.0;

fn floor() -> Vec<ForwardVertex> {
    let corner = |x: f32, z: f32| ForwardVertex {
        position: [x, 0.0, z],
        normal: [0.0, 1.0, 0.0],
        tangent: [1.0, 0.0, 0.3],
    };
    let [a, b, c, d] = [corner(-4.0, -4.0), corner(-4.0, 4.0), corner(4.0, 4.0), corner(4.0, -4.0)];
    vec![a, b, c, a, c, d]
}

fn lights() -> Vec<AreaLight> {
    let (p0, p1) = (Vec3::new(-1.0, 0.5, -1.0), Vec3::new(1.0, 1.5, -1.0));
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, z]| Vec3::new(x, 2.0, z));
    [
        LightShape::Quad { corners, sides: Sides::Two },
        LightShape::Line { p0, p1, radius: 0.05, caps: true },
        LightShape::Sphere { center: Vec3::new(2.0, 0.3, 1.0), radius: 0.5 },
        LightShape::Polygon {
            vertices: corners[..3].iter().map(|c| *c - Vec3::Y).collect(),
            sides: Sides::Two,
        },
    ]
    .map(|shape| AreaLight::new(shape, Vec3::new(5.0, 4.0, 3.0)))
    .to_vec()
}

/// A camera with an angle of view of 50°, depths 0.1 to 100.
fn looking(eye: Vec3, at: Vec3, aspect: f32) -> Mat4 {
    let back = (eye - at).normalize_or(Vec3::Z);
    let right = Vec3::Y.cross(back).normalize_or(Vec3::X);
    let up = back.cross(right);
    let row = |axis: Vec3| axis.extend(-axis.dot(eye));
    let view_from_world = Mat4::from_cols(row(right), row(up), row(back), Vec4::W).transpose();
    let (f, near, far) = (2.14, 0.1, 100.0);
    let clip_from_view = Mat4::from_cols(
        Vec4::new(f / aspect, 0.0, 0.0, 0.0),
        Vec4::new(0.0, f, 0.0, 0.0),
        Vec4::new(0.0, 0.0, far / (near - far), -1.0),
        Vec4::new(0.0, 0.0, near * far / (near - far), 0.0),
    );
    clip_from_view * view_from_world
}

#[test]
fn forward_is_deferred() {
    let Some(gpu) = gpu(Filtering::Exact) else { return };
    compare(&gpu, &Forward::new(&gpu).unwrap(), &Shader::new(&gpu).unwrap(), &lights(), None);
}

#[test]
fn forward_is_deferred_with_baked_slices() {
    let Some(gpu) = gpu(Filtering::Exact) else { return };
    let options = || ShadingOptions { baked: true, ..ShadingOptions::default() };
    let (forward, deferred) =
        (Forward::with(&gpu, options()).unwrap(), Shader::with(&gpu, options()).unwrap());
    compare(&gpu, &forward, &deferred, &lights(), Some(1));
}

/// A quad that its texture fills, one that it does not, a polygon, and lights without textures among them.
#[test]
fn forward_is_deferred_with_textures() {
    let Some(gpu) = gpu(Filtering::Exact) else { return };
    let with_textures = |textures| ShadingOptions { textures: Some(textures), ..ShadingOptions::default() };
    let colours: Vec<[f32; 3]> = (0..64).map(|k| [(k % 8) as f32 / 8.0, (k / 8 % 2) as f32, 0.5]).collect();
    let picture = |width, height| {
        PrefilteredTexture::new(TexelGrid { width, height, colours: &colours, coverage: None }).unwrap()
    };
    let textures = LightTextures::upload(&gpu, &[picture(8, 8), picture(4, 16)]).unwrap();
    let mut lights = lights();
    let LightShape::Quad { corners, .. } = lights[0].shape else { panic!("{:?}", lights[0]) };
    lights[0].texture = Some(LightTexture::filling(1, &corners));
    let mut slid = LightTexture::filling(0, &corners);
    slid.frame.origin += slid.frame.axis_u * 0.2 - Vec3::Y;
    lights[3].texture = Some(slid);
    lights.push(AreaLight { texture: Some(LightTexture { number: 1, ..slid }), ..lights[0].clone() });
    let (forward, deferred) = (
        Forward::with(&gpu, with_textures(textures.clone())).unwrap(),
        Shader::with(&gpu, with_textures(textures)).unwrap(),
    );
    compare(&gpu, &forward, &deferred, &lights, None);
}

/// As `f32` has them.
fn widths((x, y): (f32, f32)) -> Alpha {
    Alpha::new(f64::from(x), f64::from(y)).unwrap()
}

fn compare(gpu: &Gpu, forward: &Forward, shader: &Shader, lights: &[AreaLight], slice: Option<u32>) {
    let table = tables::anisotropic(Mapping::Linear, Mapping::Linear);
    let texture = TableTextures::upload(gpu, &table).unwrap();
    let slices = BakedSlices::bake(gpu, &table, &[(0.9, 0.1), (0.4, 0.2)].map(widths)).unwrap();
    let tables = Tables { anisotropic: Some(&texture), baked: Some(&slices), ..Tables::default() };
    let eye = Vec3::new(0.5, 2.0, 5.0);
    let clip_from_world = looking(eye, Vec3::ZERO, 1.5);
    let view = ForwardView { clip_from_world, eye, width: 48, height: 32 };
    let material = ForwardMaterial {
        alpha_x: 0.4,
        alpha_y: 0.2,
        isotropic: false,
        slice,
        f0: Vec3::splat(0.5),
        f90: 1.0,
        albedo: Vec3::new(0.1, 0.2, 0.3),
    };
    let drawn = forward.draw(gpu, tables, &view, &material, &floor(), lights).unwrap();
    assert_eq!(drawn.len(), 48 * 32);

    // The floor's points under the middles of the pixels.
    let world_from_clip = clip_from_world.as_dmat4().inverse();
    let mut points = Vec::new();
    let mut shown = Vec::new();
    for (i, pixel) in drawn.iter().enumerate() {
        if pixel[3] == 0.0 {
            continue;
        }
        let (x, y) = ((i % 48) as f32 + 0.5, (i / 48) as f32 + 0.5);
        let clip = Vec3::new(x / 24.0 - 1.0, 1.0 - y / 16.0, 0.5).as_dvec3();
        let (far, eye_64) = (world_from_clip.project_point3(clip), eye.as_dvec3());
        let position = (eye_64 + (far - eye_64) * (eye_64.y / (eye_64.y - far.y))).as_vec3();
        points.push(SurfacePoint {
            position,
            normal: Vec3::Y,
            tangent: Vec3::new(1.0, 0.0, 0.3),
            wo: eye - position,
            alpha_x: material.alpha_x,
            alpha_y: material.alpha_y,
            isotropic: false,
            slice,
            f0: material.f0,
            f90: material.f90,
            albedo: material.albedo,
        });
        shown.push(*pixel);
    }
    assert!(points.len() > 500 && points.len() < 48 * 32, "{} of the pixels show the floor", points.len());
    let deferred = shader.shade(gpu, tables, &points, lights).unwrap();
    let difference = |a: &[[f32; 3]]| {
        let each = shown.iter().zip(a).flat_map(|(p, d)| (0..3).map(move |c| (p[c] - d[c]).abs()));
        each.fold(0.0_f32, f32::max)
    };
    println!("forward and deferred differ by up to {:.1e}", difference(&deferred));
    assert!(difference(&deferred) < TOLERANCE, "{}", difference(&deferred));
    assert!(deferred.iter().any(|r| r[0] > 0.5), "something is lit");
    // The control: the neighbouring pixel's light.
    let mut shifted = deferred.clone();
    shifted.rotate_left(1);
    assert!(difference(&shifted) > 10.0 * TOLERANCE);
}
