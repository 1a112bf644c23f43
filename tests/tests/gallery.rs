//! Every scene of `examples/scenes` on CPU and GPU against ground truth, with the error that each has.
//!
//! What is left between LTC and ground truth is the shape of the lobe: the figures are those of the shipped tables. A failure
//! writes the expected, the actual and the amplified difference beside each other.

#![expect(clippy::unwrap_used, reason = "a test fails by a panic")]

use std::path::{Path, PathBuf};

use ltc_render::{
    Backend, Comparison, RenderError, RenderOptions, RenderTables, Rendered, Scene, ToneMap, compare, render,
};
use ltc_table::Table;
use ltc_tests::table;

/// Relative RMSE of each scene against the reference with 256 samples a technique, at 32 × 18; a tenth more is allowed.
const ERRORS: &[(&str, f64)] = &[
    ("all-shapes", 0.0798),
    ("anisotropic-spheres", 0.1128),
    ("brushed-steel-rotations", 0.1213),
    ("cornell-like-matt", 0.0088),
    ("cylinder-columns", 0.0258),
    ("cylinder-end-on", 0.1121),
    ("cylinder-solid", 0.0694),
    ("disk-overhead", 0.0723),
    ("disk-upright", 0.0723),
    ("disks-coloured", 0.0678),
    ("ellipse-two-sided", 0.0603),
    ("ellipse-wide", 0.0589),
    ("ground-grazing", 0.2221),
    ("isotropic-roughness", 0.0843),
    ("line-fan", 0.1628),
    ("line-through-floor", 0.0669),
    ("line-tube", 0.1006),
    ("many-small-lights", 0.0795),
    ("mirror-like-floor", 0.0146),
    ("polygon-star", 0.0586),
    ("polygon-triangle-two-sided", 0.0639),
    ("polygon-window", 0.0702),
    ("roughness-row-round-lights", 0.0709),
    ("sphere-half-sunk", 0.0625),
    ("sphere-lamp", 0.0720),
    ("sphere-lamps-small", 0.1060),
    ("strip-ceiling", 0.1441),
    ("textured-checker-spheres", 0.0868),
    ("textured-stained-glass", 0.1802),
    ("textured-two-sided-star", 0.0672),
    ("two-sided-panel", 0.0564),
];

/// GPU against CPU f64: each light to 1e-4 of its radiance, and to 1e-3 of the picture's brightest.
const GPU: f32 = 1e-3;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/scenes")
}

/// A scene, as small as the figures are for.
fn scene(name: &str) -> Scene {
    let mut scene = Scene::load(&folder().join(format!("{name}.json"))).unwrap();
    (scene.camera.width, scene.camera.height) = (32, 18);
    scene
}

fn write_failure(name: &str, comparison: &Comparison) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}.png"));
    comparison.write(&path, ToneMap::default()).unwrap();
    path
}

struct Both(Table, Table);

impl Both {
    fn new() -> Self {
        Self(table("ggx-isotropic"), table("ggx-anisotropic"))
    }

    fn tables(&self) -> RenderTables<'_> {
        RenderTables { isotropic: &self.0, anisotropic: &self.1 }
    }
}

fn options() -> RenderOptions<'static> {
    RenderOptions { reference_samples: 256, ..RenderOptions::default() }
}

#[test]
fn every_scene_is_as_near_to_the_truth_as_stated() {
    let both = Both::new();
    let mut failures = Vec::new();
    for (name, stated) in ERRORS {
        let comparison = compare(&scene(name), &both.tables(), Backend::Cpu, &options()).unwrap();
        let error = comparison.errors.relative_rmse.unwrap();
        println!("    (\"{name}\", {error:.4}),");
        if error > stated * 1.1 {
            let path = write_failure(name, &comparison);
            failures.push(format!("{name}: {error} instead of {stated}, see {}", path.display()));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// The control: light that is a twentieth brighter is further from the truth than stated.
#[test]
fn brighter_light_is_seen() {
    let (name, stated) = ERRORS.iter().find(|(name, _)| *name == "cornell-like-matt").unwrap();
    let both = Both::new();
    let mut brighter = scene(name);
    for light in &mut brighter.lights {
        if let ltc_render::Light::Rectangle(light) = light {
            light.intensity *= 1.05;
        }
    }
    let test = render(&brighter, &both.tables(), Backend::Cpu, &options()).unwrap();
    let truth = render(&scene(name), &both.tables(), Backend::Reference, &options()).unwrap();
    assert!(Comparison::of(test, truth).errors.relative_rmse.unwrap() > 3.0 * stated);
}

#[test]
fn the_figures_are_of_all_scenes_and_there_are_many() {
    let mut names: Vec<String> = std::fs::read_dir(folder())
        .unwrap()
        .filter_map(|entry| {
            entry.unwrap().path().file_name()?.to_str()?.strip_suffix(".json").map(str::to_owned)
        })
        .collect();
    names.sort();
    let stated: Vec<&str> = ERRORS.iter().map(|(name, _)| *name).collect();
    assert_eq!(names, stated);
    assert!(names.len() >= 20);
}

/// The largest difference over the picture's brightest channel.
fn difference(a: &Rendered, b: &Rendered) -> f32 {
    let (a, b) = (a.image.pixels().as_flattened(), b.image.pixels().as_flattened());
    let brightest = b.iter().copied().fold(0.0, f32::max);
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max) / brightest
}

#[test]
fn the_gpu_paints_every_scene_as_the_cpu_does() {
    let both = Both::new();
    let (mut failures, mut last) = (Vec::new(), None);
    for (name, _) in ERRORS {
        let scene = scene(name);
        let gpu = match render(&scene, &both.tables(), Backend::Gpu, &options()) {
            Err(RenderError::Gpu(error @ ltc_shade_gpu::GpuError::NoAdapter { .. })) => {
                assert!(std::env::var_os("CI").is_none(), "{error}");
                println!("skipped, because no GPU adapter can run this: {error}");
                return;
            }
            other => other.unwrap(),
        };
        let cpu = render(&scene, &both.tables(), Backend::Cpu, &options()).unwrap();
        let error = difference(&gpu, &cpu);
        println!("{name}: the GPU differs by up to {error:.1e}");
        if error > GPU {
            let path = write_failure(&format!("gpu-{name}"), &Comparison::of(gpu, cpu));
            failures.push(format!("{name}: {error}, see {}", path.display()));
        } else if let Some(other) = last.replace(gpu) {
            // The control: another scene is another picture.
            assert!(difference(&other, &cpu) > GPU, "{name}");
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}
