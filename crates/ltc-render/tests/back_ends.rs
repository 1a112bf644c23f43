//! The back ends against each other.

#![expect(clippy::unwrap_used, reason = "a test fails by a panic")]

#[path = "../../ltc-shade-gpu/tests/gpu/tables.rs"]
mod tables;

use std::path::Path;
use std::sync::Mutex;

use ltc_render::{
    Backend, Image, RenderError, RenderOptions, RenderTables, Rendered, Scene, ToneMap, compare, render,
};
use ltc_table::{Mapping, Table};

struct Both {
    isotropic: Table,
    anisotropic: Table,
}

impl Both {
    fn new() -> Self {
        let anisotropic = tables::anisotropic(Mapping::Linear, Mapping::Sqrt);
        Self { isotropic: tables::isotropic(), anisotropic }
    }

    fn tables(&self) -> RenderTables<'_> {
        RenderTables { isotropic: &self.isotropic, anisotropic: &self.anisotropic }
    }

    fn render(&self, scene: &Scene, backend: Backend, options: &RenderOptions<'_>) -> Rendered {
        render(scene, &self.tables(), backend, options).unwrap()
    }
}

/// A plane and spheres of every kind of material, under a one-sided and a two-sided light.
fn scene() -> Scene {
    serde_json::from_str(
        r#"{
        "camera": {"position": [0, 2, 7], "look_at": [0, 0.8, 0], "fov_y_degrees": 40, "width": 96, "height": 54},
        "background": [0.01, 0.02, 0.03],
        "objects": [
            {"type": "plane", "point": [0, 0, 0],
                "material": {"roughness": 0.5, "anisotropy": 0.4, "rotation_degrees": 30, "diffuse": [0.3, 0.2, 0.1]}},
            {"type": "sphere", "center": [-2, 1, 0], "radius": 1,
                "material": {"alpha_x": 0.1, "alpha_y": 0.5, "rotation_degrees": 70, "f0": [0.9, 0.8, 0.3]}},
            {"type": "sphere", "center": [0, 1, 0], "radius": 1, "material": {"roughness": 0.4, "diffuse": [0, 0.5, 0.2]}},
            {"type": "sphere", "center": [2, 1, 0], "radius": 1,
                "material": {"roughness": 0.4, "anisotropy": 0.7, "f0": [0.8, 0.8, 0.8], "f90": 0.9}}
        ],
        "lights": [
            {"type": "rectangle", "center": [-2, 4, 2], "half_u": [1, 0, 0], "half_v": [0, 0.3, 1], "color": [1, 0.7, 0.4],
                "intensity": 2},
            {"type": "rectangle", "center": [3, 1, 2], "half_u": [0, 0.8, 0], "half_v": [0.3, 0, 0.4], "color": [0.2, 0.5, 1],
                "intensity": 3, "two_sided": true}
        ]
    }"#,
    )
    .unwrap()
}

/// The scene's first light.
fn rectangle(scene: &mut Scene) -> &mut ltc_render::Rectangle {
    match &mut scene.lights[0] {
        ltc_render::Light::Rectangle(light) => light,
        other => panic!("{other:?}"),
    }
}

fn largest_difference(a: &Image, b: &Image) -> f32 {
    let (a, b) = (a.pixels().as_flattened(), b.pixels().as_flattened());
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

#[cfg(feature = "gpu")]
#[test]
fn the_gpu_paints_what_the_cpu_paints() {
    /// The promise of 1e-4 for a light of unit radiance, for the lights of the scene.
    const TOLERANCE: f32 = 1e-4 * (2.0 + 3.0);
    let both = Both::new();
    let options = RenderOptions { samples_per_pixel: 4, ..RenderOptions::default() };
    let gpu = match render(&scene(), &both.tables(), Backend::Gpu, &options) {
        Err(RenderError::Gpu(error @ ltc_shade_gpu::GpuError::NoAdapter { .. })) => {
            assert!(std::env::var_os("CI").is_none(), "{error}");
            eprintln!("skipped, because no GPU adapter can run this: {error}");
            return;
        }
        other => other.unwrap(),
    };
    let cpu = both.render(&scene(), Backend::Cpu, &options);
    let difference = largest_difference(&gpu.image, &cpu.image);
    println!("{}: largest difference from the CPU {difference:.2e}", gpu.device);
    assert!(difference <= TOLERANCE, "{difference}");
    assert!(cpu.image.pixels().iter().any(|p| p[0] > 0.5), "nothing is lit");

    // The control: a light that is a hundredth brighter is seen.
    let mut brighter = scene();
    let light = rectangle(&mut brighter);
    light.intensity *= 1.01;
    let brighter = both.render(&brighter, Backend::Cpu, &options);
    assert!(largest_difference(&gpu.image, &brighter.image) > TOLERANCE);
}

/// Without a specular lobe LTC is exact: what is left is the reference's noise.
#[test]
fn diffuse_light_is_that_of_the_reference() {
    let both = Both::new();
    let mut matt = scene();
    for object in &mut matt.objects {
        let material = match object {
            ltc_render::Object::Sphere(sphere) => &mut sphere.material,
            ltc_render::Object::Plane(plane) => &mut plane.material,
        };
        (material.f0, material.f90, material.diffuse) = ([0.0; 3], 0.0, [0.8, 0.5, 0.9]);
    }
    let comparison = |reference_samples| {
        let options = RenderOptions { reference_samples, ..RenderOptions::default() };
        compare(&matt, &both.tables(), Backend::Cpu, &options).unwrap()
    };
    let few = comparison(128).errors;
    let many = comparison(8192);
    println!("diffuse against the reference: {:?}, with fewer samples {few:?}", many.errors);
    assert!(many.errors.pixels > 3_000 && many.errors.relative_rmse.unwrap() < 1e-3, "{:?}", many.errors);
    assert!(many.errors.rmse < 0.1 * few.rmse, "noise falls with the number of samples, a bias would not");

    // The control: the light seen from its other side is another picture.
    let truth = many.reference.image;
    let mut turned = matt.clone();
    let light = rectangle(&mut turned);
    light.half_u = light.half_u.map(|u| u.map(|x| -x));
    let turned = both.render(&turned, Backend::Cpu, &RenderOptions::default());
    assert!(largest_difference(&turned.image, &truth) > 0.1);
}

#[test]
fn the_reference_is_decided_by_its_seed_and_reports_progress() {
    let both = Both::new();
    let seen = Mutex::new(Vec::new());
    let note = |part: f32| seen.lock().unwrap().push(part);
    let options = RenderOptions { reference_samples: 4, progress: Some(&note), ..RenderOptions::default() };
    let first = both.render(&scene(), Backend::Reference, &options);
    let again = both.render(&scene(), Backend::Reference, &options);
    assert_eq!(first.image, again.image);
    let other = both.render(&scene(), Backend::Reference, &RenderOptions { seed: 2, ..options });
    assert_ne!(first.image, other.image);
    let seen = seen.into_inner().unwrap();
    assert_eq!(seen.last(), Some(&1.0));
    assert!(seen[..seen.len() / 3].is_sorted());
}

#[test]
fn a_comparison_is_three_panels() {
    let both = Both::new();
    let options = RenderOptions { reference_samples: 2, ..RenderOptions::default() };
    let comparison = compare(&scene(), &both.tables(), Backend::Cpu, &options).unwrap();
    assert!(comparison.errors.rmse > 0.0 && comparison.errors.max_abs >= comparison.errors.rmse);
    let folder = tempfile::tempdir().unwrap();
    for name in ["a.png", "a.exr"] {
        comparison.write(&folder.path().join(name), ToneMap::default()).unwrap();
    }
    let file = std::io::BufReader::new(std::fs::File::open(folder.path().join("a.png")).unwrap());
    let reader = png::Decoder::new(file).read_info().unwrap();
    assert_eq!((reader.info().width, reader.info().height), (3 * 96, 54));
    let exr = exr::meta::MetaData::read_from_file(folder.path().join("a.exr"), true).unwrap();
    assert_eq!(exr.headers[0].layer_size, exr::math::Vec2(3 * 96, 54));
    let error = comparison.write(&folder.path().join("a.bmp"), ToneMap::default()).unwrap_err();
    assert!(matches!(error, RenderError::UnknownFormat { .. }));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
}

#[test]
fn more_samples_only_smooth_the_picture() {
    let both = Both::new();
    let mean = |samples_per_pixel| {
        let options = RenderOptions { samples_per_pixel, ..RenderOptions::default() };
        let image = both.render(&scene(), Backend::Cpu, &options).image;
        image.pixels().as_flattened().iter().map(|x| f64::from(*x)).sum::<f64>() / (3 * 96 * 54) as f64
    };
    let (one, nine) = (mean(1), mean(9));
    assert!((one - nine).abs() < 0.02 * nine, "{one} {nine}");
}

#[test]
fn impossible_options_and_tables_are_refused() {
    let both = Both::new();
    let message = |options: RenderOptions<'_>| {
        render(&scene(), &both.tables(), Backend::Cpu, &options).unwrap_err().to_string()
    };
    let usual = RenderOptions::default();
    for samples_per_pixel in [0, 2, 81] {
        let expected = format!("samples per pixel is {samples_per_pixel}, must be a square number");
        assert!(message(RenderOptions { samples_per_pixel, ..usual }).starts_with(&expected));
    }
    assert!(message(RenderOptions { reference_samples: 0, ..usual }).starts_with("reference samples is 0"));
    let swapped = RenderTables { isotropic: &both.anisotropic, anisotropic: &both.isotropic };
    let error = render(&scene(), &swapped, Backend::Cpu, &usual).unwrap_err();
    assert!(matches!(error, RenderError::WrongTable { expected: "isotropic" }));
}

#[test]
fn every_example_scene_is_valid() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/scenes");
    let mut count = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|e| e == "json") {
            Scene::load(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
            count += 1;
        }
    }
    assert!(count >= 3);
}
