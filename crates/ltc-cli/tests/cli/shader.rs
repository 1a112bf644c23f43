//! `ltc shader`.

use crate::support::{ltc, text};

const QUAD: [&str; 7] = ["shader", "--lights", "quad", "--features", "surface-horizon", "--lang", "glsl"];

#[test]
fn source_goes_to_stdout_or_to_a_file() {
    let printed = ltc(&QUAD).good().out;
    assert!(
        printed.contains("float ltc_quad(LtcLobe lobe, vec3 v0, vec3 v1, vec3 v2, vec3 v3)"),
        "{printed}"
    );
    assert!(printed.starts_with("// ") && !printed.contains("ltc_disk("));
    // The command that the head names makes the same again.
    let command = printed.lines().find_map(|line| line.strip_prefix("//   ltc ")).unwrap().replace('\'', "");
    assert_eq!(ltc(&command.split_whitespace().collect::<Vec<_>>()).good().out, printed);
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("quad.glsl");
    let said = ltc(&[&QUAD[..], &["-o", text(&file), "--json"]].concat()).json();
    assert_eq!(std::fs::read_to_string(&file).unwrap(), printed);
    assert_eq!(said["bytes"], printed.len());
    assert_eq!(said["language"], "glsl");
}

#[test]
fn spirv_is_words_and_can_be_described() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("line.spv");
    let line = ["shader", "--lang", "spirv", "--lights", "line"];
    ltc(&[&line[..], &["-o", text(&file)]].concat()).good();
    let bytes = std::fs::read(&file).unwrap();
    assert_eq!(bytes[..4], 0x0723_0203_u32.to_le_bytes());
    let described = ltc(&[&line[..], &["--describe"]].concat()).good().out;
    assert!(described.contains("ltc_line_batch: a, b ends, a.w radius"), "{described}");
}

#[test]
fn every_name_is_listed_and_others_are_refused_with_the_list() {
    let all = ltc(&["shader", "--list"]).good().out;
    for name in ["glsl-es", "line-with-caps", "  rational-edges"] {
        assert!(all.contains(name), "{all}");
    }
    ltc(&["shader", "--lang", "glsl", "--lights", "blob"]).misused(&["blob", "quad", "sphere"]);
    ltc(&["shader", "--lang", "glsl", "--features", "magic"]).misused(&["magic", "two-sided"]);
    ltc(&["shader", "--lang", "basic", "--lights", "quad"]).misused(&["basic", "glsl-es"]);
    ltc(&["shader", "--lang", "glsl"]).refused(&["nothing was asked for", "quad", "isotropic"]);
    ltc(&["shader", "--lang", "spirv", "--features", "fresnel"]).refused(&["kernel"]);
    ltc(&["shader"]).misused(&["required"]);
}
