//! Representative exports that are checked in, so that a change of them is seen in review.
//!
//! `LTC_GOLDEN=write cargo test -p ltc-shade-gpu --test export golden` writes them again.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use ltc_shade_gpu::{Feature, Language, LightKind, ShaderRequest};

/// File, language and request.
fn goldens() -> Vec<(&'static str, Language, ShaderRequest)> {
    use Feature::{CosineHorizon, Fresnel, Isotropic, RationalEdges, SurfaceHorizon};
    let thin = ShaderRequest::new([LightKind::Line], [SurfaceHorizon]);
    let quad = ShaderRequest::new([LightKind::Quad], [Isotropic, Fresnel, SurfaceHorizon, CosineHorizon]);
    let bare = ShaderRequest::new([LightKind::Quad], [RationalEdges]);
    vec![
        ("quad.wgsl", Language::Wgsl, bare.clone()),
        ("quad.450.glsl", Language::Glsl, quad),
        ("quad.300es.glsl", Language::GlslEs, bare),
        ("textured.300es.glsl", Language::GlslEs, ShaderRequest::new([], [Feature::Textured])),
        ("line.hlsl", Language::Hlsl, thin.clone()),
        ("line.metal", Language::Msl, thin.clone()),
        ("line.spv", Language::Spirv, thin),
    ]
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden")
}

#[test]
fn goldens_are_current() {
    let write = std::env::var_os("LTC_GOLDEN").is_some_and(|value| value == "write");
    let mut names = BTreeSet::new();
    for (name, language, request) in goldens() {
        let bytes = request.export(language).unwrap().bytes();
        assert_eq!(bytes, request.export(language).unwrap().bytes(), "{name} differs from run to run");
        let path = folder().join(name);
        if write {
            fs::create_dir_all(folder()).unwrap();
            fs::write(&path, &bytes).unwrap();
        }
        let same = fs::read(&path).is_ok_and(|found| found == bytes);
        let how = "LTC_GOLDEN=write cargo test -p ltc-shade-gpu --test export golden";
        assert!(same, "{} is not current: `{how}` writes it again; look at the difference", path.display());
        names.insert(name.to_owned());
    }
    let found = fs::read_dir(folder()).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap());
    assert_eq!(found.collect::<BTreeSet<_>>(), names);
}
