//! Functions of the pure modules that no pipeline of this crate reaches, run on the device by themselves.

use glam::{DVec3, Mat3, Vec3};
use ltc_core::points::SplitMix64;
use ltc_core::{EdgeForm, Ltc, PrefilteredTexture, Rational, Sides, TexelGrid, TexturedPolygon};

use crate::compute::{Batch, Kernel};
use crate::modules::compose;
use crate::{Gpu, GpuError, GpuOptions};

/// Runs `body`, which reads `inputs[first]`, … and sets `results[4u * id.x]`, …, once for each `each` of the inputs.
fn run(
    roots: &[&str],
    symbols: &[&str],
    body: &str,
    inputs: &[[f32; 4]],
    each: usize,
) -> Option<Vec<[f32; 4]>> {
    let gpu = match Gpu::new(GpuOptions::default()) {
        Ok(gpu) => gpu,
        Err(error @ GpuError::NoAdapter { .. }) => {
            assert!(std::env::var_os("CI").is_none(), "{error}");
            eprintln!("skipped, because no GPU adapter can run this: {error}");
            return None;
        }
        Err(error) => panic!("{error}"),
    };
    let main = format!(
        "@group(0) @binding(0) var<uniform> count: vec4u;
        @group(0) @binding(1) var<storage, read> inputs: array<vec4f>;
        @group(0) @binding(2) var<storage, read_write> results: array<vec4f>;
        @compute @workgroup_size(64)
        fn main(@builtin(global_invocation_id) id: vec3u) {{
            if id.x >= count.x {{ return; }}
            let first = id.x * {each}u;
            {body}
        }}"
    );
    let source = wgpu::ShaderSource::Wgsl(format!("{}\n{main}", compose(roots, symbols)).into());
    let module = gpu.device().create_shader_module(wgpu::ShaderModuleDescriptor { label: None, source });
    let kernel = Kernel::new(&gpu, &module, "main", None, 1).unwrap();
    let items = inputs.len() / each;
    let batch = Batch {
        item: "input",
        first: 0,
        items,
        counts: [items as u32, 0, 0, 0],
        inputs: &[bytemuck::cast_slice(inputs)],
        floats_each: 4,
        tables: None,
    };
    Some(kernel.run(&gpu, &batch).unwrap().as_chunks::<4>().0.to_vec())
}

fn in_cube(rng: &mut SplitMix64) -> Vec3 {
    DVec3::new(rng.range(-1.0, 1.0), rng.range(-1.0, 1.0), rng.range(-1.0, 1.0)).as_vec3()
}

#[test]
fn textures_are_fetched_where_the_cpu_fetches_them() {
    let mut rng = SplitMix64::new(4);
    let (mut inputs, mut frames) = (Vec::new(), Vec::new());
    while frames.len() < 2000 {
        let (x, y, z) = (in_cube(&mut rng), in_cube(&mut rng), in_cube(&mut rng));
        let m = Mat3::from_cols(x, y, z);
        if m.determinant() < 0.05 {
            continue;
        }
        let (origin, u, v) = (in_cube(&mut rng) * 3.0, in_cube(&mut rng), in_cube(&mut rng));
        if u.cross(v).length() < 0.1 {
            continue;
        }
        inputs.extend([x, y, z, origin, u, v].map(|v| v.extend(0.0).to_array()));
        frames.push((m, [origin, u, v]));
    }
    let body = "
        let lobe = ltc_lobe(mat3x3f(inputs[first].xyz, inputs[first + 1u].xyz, inputs[first + 2u].xyz));
        let found = ltc_texture_fetch(lobe, inputs[first + 3u].xyz, inputs[first + 4u].xyz, inputs[first + 5u].xyz);
        results[id.x] = vec4f(found.uv, found.sigma, 0.0);";
    let Some(results) = run(&["textured"], &[], body, &inputs, 6) else { return };
    let texture =
        PrefilteredTexture::new(TexelGrid { width: 1, height: 1, colours: &[[1.0; 3]], coverage: None })
            .unwrap();
    for ((m, frame), [u, v, sigma, _]) in frames.iter().zip(results) {
        let [o, a, b] = frame.map(Vec3::as_dvec3);
        let corners = [o, o + a, o + a + b, o + b];
        let light = TexturedPolygon::<f64>::filled(&corners, Sides::Two, &texture).unwrap();
        let expected = light.texture_fetch(&Ltc::new(m.as_dmat3()).unwrap());
        let size = 1.0 + expected.uv[0].abs() + expected.uv[1].abs() + expected.sigma;
        for (value, expected) in [(u, expected.uv[0]), (v, expected.uv[1]), (sigma, expected.sigma)] {
            assert!((f64::from(value) - expected).abs() < 2e-4 * size, "{value} {expected}");
        }
    }
}

#[test]
fn gltf_materials_are_what_the_extension_says() {
    let inputs = [[0.8, 0.4, 0.1, 0.25], [0.6, 0.5, 0.0, 0.0], [1.0, 1.0, 0.7, 0.0], [0.0, 0.0, 0.0, 0.0]];
    // Roughness, metallic, strength, rotation.
    let body = "
        let plain = ltc_metallic_roughness(vec3f(0.5, 0.2, 0.1), inputs[first].y, inputs[first].x);
        let material = ltc_anisotropy(plain, inputs[first].z);
        let tangent = ltc_anisotropy_tangent(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 1.0, 0.0), inputs[first].w);
        results[id.x] = vec4f(material.alpha_x, material.alpha_y, material.f0.x + 10.0 * material.albedo.x, tangent.y);";
    let Some(results) = run(&["material"], &[], body, &inputs, 1) else { return };
    for ([roughness, metallic, strength, rotation], result) in inputs.into_iter().zip(results) {
        let alpha = (roughness * roughness).max(ltc_core::ALPHA_MIN as f32);
        let along = alpha + (1.0 - alpha) * strength * strength;
        let f0 = 0.04 + (0.5 - 0.04) * metallic;
        let albedo = 0.5 * (1.0 - metallic);
        for (value, expected) in result.into_iter().zip([along, alpha, f0 + 10.0 * albedo, rotation.sin()]) {
            assert!((value - expected).abs() < 2e-6, "{value} {expected}");
        }
    }
}

#[test]
fn the_rational_edge_is_that_of_the_cpu() {
    let inputs: Vec<[f32; 4]> = (0..=1000)
        .map(|i| {
            let (sin, cos) = (f64::from(i) * 1e-3 * core::f64::consts::PI).sin_cos();
            [sin as f32, cos as f32, 0.0, 0.0]
        })
        .collect();
    let body =
        "results[id.x] = vec4f(ltc_edge_angle(3.0 * inputs[first].x, 3.0 * inputs[first].y), 0.0, 0.0, 0.0);";
    let exact = run(&["edge"], &[], body, &inputs, 1);
    let (Some(exact), Some(rational)) = (exact, run(&["edge"], &["rational_edges"], body, &inputs, 1)) else {
        return;
    };
    for (([sin, cos, ..], exact), rational) in inputs.iter().zip(exact).zip(rational) {
        let angle = sin.atan2(*cos);
        assert!((exact[0] - angle).abs() < 5e-7, "{} {angle}", exact[0]);
        assert!((rational[0] - angle).abs() < 3e-6, "{} {angle}", rational[0]);
        let on_cpu = Rational::angle_over_sine(*cos, *sin) * *sin;
        assert!((rational[0] - on_cpu).abs() < 2e-6, "{} {on_cpu}", rational[0]);
    }
}

/// Nearly parallel vectors, whose plain cross product in `f32` is noise.
#[test]
fn cross_products_and_differences_of_squares_keep_their_digits() {
    let mut rng = SplitMix64::new(6);
    let mut inputs = Vec::new();
    for _ in 0..1000 {
        let a = in_cube(&mut rng);
        let b = a * 0.7 + in_cube(&mut rng) * 1e-6;
        inputs.extend([a.extend(0.0), b.extend(0.0)].map(|v| v.to_array()));
    }
    let body = "
        let a = inputs[first].xyz;
        let b = inputs[first + 1u].xyz;
        results[id.x] = vec4f(ltc_cross(a, b), ltc_difference_of_squares(ltc_split(0.7 * a), ltc_split(b)));";
    let Some(results) = run(&["precise"], &[], body, &inputs, 2) else { return };
    let mut noise = 0.0_f64;
    for (pair, result) in inputs.as_chunks::<2>().0.iter().zip(results) {
        let [a, b] = pair.map(|v| Vec3::new(v[0], v[1], v[2]));
        let exact = a.as_dvec3().cross(b.as_dvec3());
        let found = DVec3::new(result[0].into(), result[1].into(), result[2].into());
        assert!((found - exact).length() < 1e-10, "{found} {exact}");
        noise = noise.max((a.cross(b).as_dvec3() - exact).length());
        let scaled = (a * 0.7).as_dvec3();
        let squares = scaled.length_squared() - b.as_dvec3().length_squared();
        assert!((f64::from(result[3]) - squares).abs() < 1e-9, "{} {squares}", result[3]);
    }
    assert!(noise > 1e-8, "the control: plainly it would be noise, {noise:e}");
}
