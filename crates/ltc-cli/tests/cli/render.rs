//! `ltc render`

use std::path::{Path, PathBuf};

use crate::support::{ltc, names_in, text};

const WIDTH: u32 = 24;
const HEIGHT: u32 = 16;

/// A small scene with both kinds of material, its fields to be changed.
fn scene(folder: &Path, change: impl Fn(&mut serde_json::Value)) -> PathBuf {
    let mut scene = serde_json::json!({
        "camera": {
            "position": [0, 1.5, 5], "look_at": [0, 0.8, 0], "fov_y_degrees": 40, "width": WIDTH, "height": HEIGHT
        },
        "objects": [
            { "type": "plane", "point": [0, 0, 0], "material": { "roughness": 0.4, "diffuse": [0.4, 0.4, 0.4] } },
            { "type": "sphere", "center": [0, 1, 0], "radius": 1, "material": { "alpha_x": 0.5, "alpha_y": 0.1, "f0": [1, 0.8, 0.3] } }
        ],
        "lights": [
            { "type": "rectangle", "center": [0, 4, 2], "half_u": [1, 0, 0], "half_v": [0, 0, 1], "intensity": 10, "two_sided": true }
        ]
    });
    change(&mut scene);
    let path = folder.join("scene.json");
    std::fs::write(&path, scene.to_string()).unwrap();
    path
}

/// Width and height of a PNG, from its header.
fn png_size(bytes: &[u8]) -> (u32, u32) {
    assert_eq!(&bytes[..8], b"\x89PNG\r\n\x1a\n");
    assert_eq!(&bytes[12..16], b"IHDR");
    let word = |at: usize| u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap());
    (word(16), word(20))
}

#[test]
fn every_back_end_renders_a_picture() {
    let folder = tempfile::tempdir().unwrap();
    let scene = scene(folder.path(), |_| ());
    let path = folder.path().join("picture.png");
    for backend in ["cpu", "reference", "gpu"] {
        let args = [
            "render",
            text(&scene),
            "-o",
            text(&path),
            "--backend",
            backend,
            "--reference-samples",
            "16",
            "--json",
        ];
        let run = ltc(&args);
        if backend == "gpu" && run.err.contains("no GPU adapter") {
            assert!(std::env::var_os("CI").is_none(), "{}", run.err);
            println!("skipped the GPU: {}", run.err);
            continue;
        }
        let said = run.json();
        assert_eq!((&said["width"], &said["height"]), (&WIDTH.into(), &HEIGHT.into()), "{backend}");
        let bytes = std::fs::read(&path).unwrap();
        assert_eq!(png_size(&bytes), (WIDTH, HEIGHT), "{backend}");
        assert!(bytes.len() > 300, "{backend}: a picture of one colour? {} bytes", bytes.len());
        std::fs::remove_file(&path).unwrap();
    }
}

#[test]
fn a_comparison_is_three_pictures_wide_and_tells_the_error() {
    let folder = tempfile::tempdir().unwrap();
    let scene = scene(folder.path(), |_| ());
    let path = folder.path().join("beside.png");
    let args = [
        "render",
        text(&scene),
        "-o",
        text(&path),
        "--backend",
        "cpu",
        "--compare",
        "reference",
        "--reference-samples",
        "64",
        "--json",
    ];
    let said = ltc(&args).json();
    let rmse = said["errors"]["rmse"].as_f64().unwrap();
    assert!(rmse > 0.0 && rmse < 0.2, "{said}");
    let (width, height) = png_size(&std::fs::read(&path).unwrap());
    assert!(width >= 3 * WIDTH && height >= HEIGHT, "{width} {height}");
    let exr = folder.path().join("picture.exr");
    ltc(&["render", text(&scene), "-o", text(&exr), "--backend", "cpu"]).good();
    assert_eq!(&std::fs::read(&exr).unwrap()[..4], b"\x76\x2f\x31\x01");
}

#[test]
fn what_cannot_be_rendered_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let good = scene(folder.path(), |_| ());
    let path = folder.path().join("picture.png");
    let render = |scene: &Path, output: &Path, rest: &[&str]| {
        ltc(&[&["render", text(scene), "-o", text(output), "--backend", "cpu"], rest].concat())
    };
    render(Path::new("none.json"), &path, &[]).refused(&["none.json"]);
    render(&good, &folder.path().join("picture.gif"), &[]).refused(&["picture.gif", ".png or .exr"]);
    render(&good, &folder.path().join("none/picture.png"), &[]).refused(&["none"]);
    render(&good, &path, &["--isotropic-table", "nonesuch"]).refused(&["nonesuch", "ggx-isotropic"]);
    render(&good, &path, &["--anisotropic-table", "ggx-isotropic"]).refused(&["anisotropic"]);
    render(&good, &path, &["--exposure", "NaN"]).refused(&["--exposure"]);
    render(&good, &path, &["--samples-per-pixel", "5"]).refused(&["5"]);
    let broken = |change: fn(&mut serde_json::Value), words: &[&str]| {
        render(&scene(folder.path(), change), &path, &[]).refused(words);
    };
    broken(|s| s["objects"][1]["radius"] = (-1).into(), &["objects[1].radius", "-1"]);
    broken(|s| s["camera"]["width"] = 0.into(), &["camera.width"]);
    broken(|s| s["lights"][0]["colour"] = 1.into(), &["colour"]);
    broken(|s| s["objects"][0]["type"] = "torus".into(), &["torus"]);
    broken(|s| s["lights"][0]["intensity"] = serde_json::Value::Null, &["null"]);
    std::fs::write(folder.path().join("scene.json"), "{").unwrap();
    render(&folder.path().join("scene.json"), &path, &[]).refused(&["scene.json"]);
    assert_eq!(names_in(folder.path()), ["scene.json"]);
}
