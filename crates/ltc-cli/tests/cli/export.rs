//! `ltc export`

use ltc_table::{Precision, npz};

use crate::support::{ltc, names_in, text};

fn manifest_axes(name: &str) -> Vec<ltc_table::Axis> {
    let manifest = ltc(&["inspect", name, "--json"]).json();
    serde_json::from_value(manifest["axes"].clone()).unwrap()
}

#[test]
fn npz_comes_back_and_is_the_payload_in_full_precision() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("table.npz");
    for name in ["ggx-anisotropic", "ggx-isotropic"] {
        let export = |precision: &str| {
            ltc(&["export", name, "--format", "npz", "--precision", precision, "-o", text(&path), "--json"])
                .json()
        };
        let full = export("f64");
        let digest = ltc(&["inspect", name, "--json"]).json()["digest"].clone();
        assert_eq!(full["digest"], digest, "the file in full precision is the payload");
        let table = npz::read(&std::fs::read(&path).unwrap(), &manifest_axes(name)).unwrap();
        for (precision, name) in [(Precision::F32, "f32"), (Precision::F16, "f16")] {
            let said = export(name);
            let bytes = std::fs::read(&path).unwrap();
            assert_eq!(said["bytes"], bytes.len());
            assert_ne!(said["digest"], digest);
            assert_eq!(npz::read(&bytes, table.axes()).unwrap(), table.rounded(precision).unwrap());
        }
    }
    assert_eq!(names_in(folder.path()), ["table.npz"]);
}

#[test]
fn ktx2_has_the_identifier_and_the_size_of_its_texels() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("table.ktx2");
    for name in ["ggx-anisotropic", "ggx-isotropic"] {
        let mut sizes = Vec::new();
        for precision in ["f16", "f32"] {
            ltc(&["export", name, "--format", "ktx2", "--precision", precision, "-o", text(&path)]).good();
            let bytes = std::fs::read(&path).unwrap();
            assert_eq!(&bytes[1..7], b"KTX 20");
            sizes.push(bytes.len());
        }
        // Both hold the same 3 groups of 4 numbers for each of 4,096 entries, and the same manifest.
        let difference = (sizes[1] - sizes[0]) as i64 - 4096 * 12 * 2;
        assert!(difference.abs() <= 16, "{name}: {sizes:?}");
    }
}

#[test]
fn a_crop_keeps_the_nodes_around_its_range() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("part.npz");
    let said = ltc(&[
        "export",
        "ggx-anisotropic",
        "--format",
        "npz",
        "--channels",
        "magnitude,fresnel",
        "--crop",
        "alpha=0.3..0.5",
        "--crop",
        "theta=0..0.4",
        "-o",
        text(&path),
        "--json",
    ])
    .json();
    let shape: Vec<u64> = said["shape"].as_array().unwrap().iter().map(|n| n.as_u64().unwrap()).collect();
    let whole: Vec<u64> = manifest_axes("ggx-anisotropic").iter().map(|a| a.len as u64).collect();
    assert!(shape[0] < whole[0] && shape[2] < whole[2] && shape[0] >= 2 && shape[2] >= 2, "{said}");
    assert_eq!((shape[1], shape[3]), (whole[1], whole[3]));
}

#[test]
fn what_cannot_be_written_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("table.ktx2");
    let export = |rest: &[&str]| ltc(&[&["export", "ggx-isotropic", "-o", text(&path)], rest].concat());
    export(&["--format", "ktx2", "--precision", "f64"]).refused(&["KTX2", "f64"]);
    export(&["--format", "ktx2", "--channels", "m"]).refused(&["--channels"]);
    export(&["--format", "npz", "--crop", "alpha=0.5..0.1"]).refused(&["alpha"]);
    export(&["--format", "npz", "--crop", "alpha=NaN..0.1"]).refused(&["alpha"]);
    export(&["--format", "npz", "--crop", "lambda=0.1..0.5"]).refused(&["lambda"]);
    assert!(names_in(folder.path()).is_empty());
    let nowhere = folder.path().join("none/table.npz");
    ltc(&["export", "ggx-isotropic", "--format", "npz", "-o", text(&nowhere)]).refused(&["table.npz"]);
    // A good file stays when its successor cannot be written.
    export(&["--format", "ktx2"]).good();
    let before = std::fs::read(&path).unwrap();
    export(&["--format", "ktx2", "--precision", "f64"]).refused(&["f64"]);
    assert_eq!(std::fs::read(&path).unwrap(), before);
    assert_eq!(names_in(folder.path()), ["table.ktx2"]);
}
