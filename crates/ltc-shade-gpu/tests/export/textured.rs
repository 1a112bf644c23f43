//! Textured quads in exported languages, run as an engine would run them, against the CPU in f64.

use glam::{DMat3, DVec3, Vec3};
use ltc_core::points::SplitMix64;
use ltc_core::{Horizon, Ltc, PrefilteredTexture, Sides, TexelGrid, TexturedPolygon};
use ltc_shade_gpu::{Feature, Language, LightKind, ShaderRequest, TextureAtlas};

use crate::equality::compiled;
use crate::support::has;
use crate::vulkan::{Bindings, Vulkan};

const COUNT: usize = 2_000;
/// The bound that the workspace promises; texels are up to 1, condition numbers below 100.
const TOLERANCE: f64 = 2e-4;

/// What the hosts in `examples/hosts` ask for.
fn request() -> ShaderRequest {
    let features = [Feature::Textured, Feature::SurfaceHorizon, Feature::CosineHorizon, Feature::TwoSided];
    ShaderRequest::new([LightKind::Quad], features)
}

fn textures() -> Vec<PrefilteredTexture> {
    let mut rng = SplitMix64::new(3);
    let mut texture = |width: usize, height: usize| {
        let colours: Vec<[f32; 3]> = (0..width * height).map(|_| [0; 3].map(|_| rng.unit() as f32)).collect();
        PrefilteredTexture::new(TexelGrid { width, height, colours: &colours, coverage: None }).unwrap()
    };
    vec![texture(16, 16), texture(1, 1), texture(31, 3)]
}

/// As words for the hosts, with what each comes to.
fn jobs(textures: &[PrefilteredTexture]) -> (Vec<u32>, Vec<[f64; 3]>) {
    let mut rng = SplitMix64::new(8);
    let (mut words, mut expected) = (Vec::new(), Vec::new());
    for i in 0..COUNT {
        let mut r = |low: f64, high: f64| rng.range(low, high);
        let widths = DVec3::new(r(0.05, 1.0), r(0.05, 1.0), 1.0);
        let turn = DMat3::from_rotation_z(r(0.0, 6.3)) * DMat3::from_rotation_y(r(-1.2, 0.0));
        let m = (turn * DMat3::from_diagonal(widths)).as_mat3();
        let mut vector =
            |scale: f64| (DVec3::new(r(-1.0, 1.0), r(-1.0, 1.0), r(-1.0, 1.0)) * scale).as_vec3();
        let center = vector(1.5) + Vec3::new(0.0, 0.0, 1.2);
        let (u, v) = (vector(1.0), vector(1.0));
        let corners = [center - u - v, center + u - v, center + u + v, center - u + v];
        let number = i % textures.len();
        for column in [m.x_axis, m.y_axis, m.z_axis] {
            words.extend(column.extend(0.0).to_array().map(f32::to_bits));
        }
        for (k, corner) in corners.iter().enumerate() {
            let w = if k == 0 { number as f32 } else { 0.0 };
            words.extend(corner.extend(w).to_array().map(f32::to_bits));
        }
        words.extend([0, 0, 0, 256]);
        let corners = corners.map(Vec3::as_dvec3);
        let light = TexturedPolygon::<f64>::filled(&corners, Sides::Two, &textures[number]).unwrap();
        expected.push(light.integrate_colour(&Ltc::new(m.as_dmat3()).unwrap(), Horizon::BOTH));
    }
    (words, expected)
}

/// The largest error; NaN counts as infinite.
fn largest(found: &[f32], expected: &[[f64; 3]]) -> f64 {
    assert_eq!(found.len(), 4 * expected.len());
    let off = |(found, expected): (&[f32; 4], &[f64; 3])| {
        (0..3).map(|c| (f64::from(found[c]) - expected[c]).abs()).fold(0.0, |a, b| if b <= a { a } else { b })
    };
    let errors = found.as_chunks::<4>().0.iter().zip(expected).map(off);
    errors.fold(0.0, |a, b| if b <= a { a } else { b })
}

/// Where the host has the textures, and what it writes.
struct Host {
    language: &'static str,
    entry_point: &'static str,
    textures: u32,
    output: u32,
}

fn run(vulkan: &Vulkan, spirv: &[u32], host: &Host) {
    let textures = textures();
    let atlas = TextureAtlas::of(&textures);
    let (words, expected) = jobs(&textures);
    let lit = expected.iter().filter(|c| c[0] > 1e-3).count();
    assert!(lit > COUNT / 4, "only {lit} are lit");
    // wgpu numbers bindings without gaps: those of the kernels of other lights are filled.
    let none = [0; 4];
    let inputs = [(1, &words[..]), (2, &none[..]), (3, &none[..])];
    let bindings = Bindings {
        count: COUNT as u32,
        inputs: &inputs[..if host.output == 2 { 1 } else { 3 }],
        output: host.output,
        colours: true,
        textures: Some((host.textures, &atlas)),
        ..Bindings::default()
    };
    let found = vulkan.run(spirv, host.entry_point, &bindings);
    let error = largest(&found, &expected);
    println!("{}: textured quads, largest error {error:.1e}", host.language);
    assert!(error < TOLERANCE, "{error}");
    // The control: the next job's result.
    let mut shifted = found;
    shifted.rotate_left(4);
    assert!(largest(&shifted, &expected) > 0.1);
}

#[test]
fn glsl_through_glslang_computes_the_same() {
    if !(has("glslangValidator") && has("spirv-val")) {
        return;
    }
    let Some(vulkan) = Vulkan::open() else { return };
    let folder = tempfile::tempdir().unwrap();
    let library = request().export(Language::Glsl).unwrap().bytes();
    let spirv = compiled("glsl/textured.comp", ("ltc.glsl", &library), &["-V"], folder.path());
    let host = Host { language: "GLSL", entry_point: "main", textures: 3, output: 2 };
    run(&vulkan, &spirv, &host);
}

#[test]
fn hlsl_through_glslang_computes_the_same() {
    if !(has("glslangValidator") && has("spirv-val")) {
        return;
    }
    let Some(vulkan) = Vulkan::open() else { return };
    let folder = tempfile::tempdir().unwrap();
    let library = request().export(Language::Hlsl).unwrap().bytes();
    let args = ["-D", "-V", "-S", "comp", "-e", "main"];
    let spirv = compiled("hlsl/textured.hlsl", ("ltc.hlsl", &library), &args, folder.path());
    let host = Host { language: "HLSL", entry_point: "main", textures: 3, output: 2 };
    run(&vulkan, &spirv, &host);
}

#[test]
fn the_kernel_of_spirv_computes_the_same() {
    let Some(vulkan) = Vulkan::open() else { return };
    let spirv: Vec<u32> = bytemuck::pod_collect_to_vec(&request().export(Language::Spirv).unwrap().bytes());
    let host = Host { language: "SPIR-V", entry_point: "ltc_textured_quad_batch", textures: 4, output: 5 };
    run(&vulkan, &spirv, &host);
}
