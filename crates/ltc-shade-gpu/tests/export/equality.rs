//! What the exported languages compute, run as an engine would run them, against the CPU in f64.

use std::fs;
use std::path::{Path, PathBuf};

use ltc_shade_gpu::{Feature, Language, LightKind, ShaderRequest};

use crate::host_wgsl;
use crate::support::{has, hosts, random, run_program, verdict};
use crate::triples::{Triple, compare, triples};
use crate::vulkan::{Bindings, Vulkan};

/// Of each kind of light.
const EACH: usize = 1_000;

/// Every light, with every cut and both sides: what the hosts in `examples/hosts` ask for.
pub fn request() -> ShaderRequest {
    ShaderRequest::new(LightKind::ALL, [Feature::SurfaceHorizon, Feature::CosineHorizon, Feature::TwoSided])
}

pub fn words(triples: &[Triple]) -> Vec<u32> {
    triples.iter().flat_map(Triple::words).collect()
}

/// Compiles a host of `examples/hosts` as its head says, beside `library`.
pub fn compiled(host: &str, library: (&str, &[u8]), args: &[&str], folder: &Path) -> Vec<u32> {
    let copy: PathBuf = folder.join(Path::new(host).file_name().unwrap());
    fs::copy(hosts().join(host), &copy).unwrap();
    fs::write(folder.join(library.0), library.1).unwrap();
    let words = copy.with_extension("spv");
    run_program(
        "glslangValidator",
        &[args, &[copy.to_str().unwrap(), "-o", words.to_str().unwrap()]].concat(),
    );
    verdict("spirv-val", &["--target-env", "vulkan1.0"], &words).unwrap();
    bytemuck::pod_collect_to_vec(&fs::read(words).unwrap())
}

fn run_host(vulkan: &Vulkan, spirv: &[u32], triples: &[Triple]) -> Vec<f32> {
    let jobs = words(triples);
    let bindings = Bindings {
        group: 0,
        count: triples.len() as u32,
        inputs: &[(1, &jobs)],
        output: 2,
        ..Bindings::default()
    };
    vulkan.run(spirv, "main", &bindings)
}

#[test]
fn glsl_through_glslang_computes_the_same() {
    if !(has("glslangValidator") && has("spirv-val")) {
        return;
    }
    let Some(vulkan) = Vulkan::open() else { return };
    let folder = tempfile::tempdir().unwrap();
    let library = request().export(Language::Glsl).unwrap().bytes();
    let spirv = compiled("glsl/batch.comp", ("ltc.glsl", &library), &["-V"], folder.path());
    let triples = triples(&LightKind::ALL, EACH, random(11));
    let largest = compare(&triples, &run_host(&vulkan, &spirv, &triples)).unwrap();
    println!("GLSL: largest error {largest:.4} of what is allowed");
}

/// The control of these tests: a constant in the exported code that is off by a thousandth.
#[test]
fn a_planted_constant_is_seen() {
    let Some(vulkan) = Vulkan::open() else { return };
    let quads = ShaderRequest::new([LightKind::Quad], request().features);
    let mut spirv: Vec<u32> = bytemuck::pod_collect_to_vec(&quads.export(Language::Spirv).unwrap().bytes());
    let triples = &triples(&[LightKind::Quad], EACH, random(14));
    let jobs = words(triples);
    // wgpu numbers bindings without gaps: the one of vertices is filled, although quads have none.
    let inputs = [(1, &jobs[..]), (2, &[0; 4][..])];
    let bindings =
        Bindings { group: 0, count: EACH as u32, inputs: &inputs, output: 3, ..Bindings::default() };
    compare(triples, &vulkan.run(&spirv, "ltc_quad_batch", &bindings)).unwrap();
    let full_turn = (2.0 * std::f32::consts::PI).to_bits();
    let planted = spirv.iter_mut().filter(|word| **word == full_turn);
    assert!(planted.map(|word| *word = 6.29_f32.to_bits()).count() > 0, "2 pi is no constant of it");
    compare(triples, &vulkan.run(&spirv, "ltc_quad_batch", &bindings)).unwrap_err();
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
    let spirv = compiled("hlsl/batch.hlsl", ("ltc.hlsl", &library), &args, folder.path());
    let triples = triples(&LightKind::ALL, EACH, random(12));
    let largest = compare(&triples, &run_host(&vulkan, &spirv, &triples)).unwrap();
    println!("HLSL: largest error {largest:.4} of what is allowed");
}

#[test]
fn the_kernels_of_spirv_compute_the_same() {
    let Some(vulkan) = Vulkan::open() else { return };
    let spirv: Vec<u32> = bytemuck::pod_collect_to_vec(&request().export(Language::Spirv).unwrap().bytes());
    let all = triples(&LightKind::ALL, EACH, random(13));
    for (kind, triples) in LightKind::ALL.iter().zip(all.chunks(EACH)) {
        let mut jobs = words(triples);
        let mut vertices = vec![0; 4];
        if *kind == LightKind::Polygon {
            vertices.clear();
            for job in jobs.as_chunks_mut::<32>().0 {
                let first = vertices.len() as u32 / 4;
                vertices.extend_from_slice(&job[12..28]);
                job[12..28].fill(0);
                job[12..14].copy_from_slice(&[first, 4]);
            }
        }
        let inputs = [(1, &jobs[..]), (2, &vertices[..])];
        let bindings = Bindings {
            group: 0,
            count: triples.len() as u32,
            inputs: &inputs,
            output: 3,
            ..Bindings::default()
        };
        let entry_point = format!("ltc_{}_batch", kind.name().replace('-', "_"));
        let largest = compare(triples, &vulkan.run(&spirv, &entry_point, &bindings))
            .unwrap_or_else(|e| panic!("{kind}: {e}"));
        println!("SPIR-V, {kind}: largest error {largest:.4} of what is allowed");
    }
}

#[test]
fn wgsl_in_its_host_computes_the_same() {
    if Vulkan::open().is_none() {
        return;
    }
    let triples = triples(&[LightKind::Quad], EACH, random(16));
    let jobs: Vec<_> = triples.iter().map(Triple::words).collect();
    let largest = compare(&triples, &host_wgsl::fractions(&jobs).unwrap()).unwrap();
    println!("WGSL: largest error {largest:.4} of what is allowed");
}
