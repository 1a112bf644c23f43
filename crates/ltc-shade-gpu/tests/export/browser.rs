//! GLSL ES in headless Chromium: WebGL 2, on SwiftShader.

use std::fs;
use std::path::Path;
use std::process::Command;

use ltc_shade_gpu::{Code, Language, LightKind, ShaderRequest};

use crate::equality::request;
use crate::support::{has, hosts, random};
use crate::triples::{Triple, compare, triples};

/// Of each kind of light.
const EACH: usize = 500;

/// What the page `batch.html` computes for lights of these kinds, `EACH` of each.
fn in_chromium(libraries: &[(LightKind, String)], triples: &[Triple]) -> Vec<f32> {
    let folder = tempfile::tempdir().unwrap();
    let page = folder.path().join("batch.html");
    fs::copy(hosts().join("glsl-es/batch.html"), &page).unwrap();
    let sources = libraries.iter().map(|(kind, text)| format!("\"{kind}\": {}", json_string(text)));
    write_script(&folder.path().join("library.js"), "LTC_GLSL", sources.collect());
    let jobs = libraries.iter().zip(triples.chunks(EACH)).map(|((kind, _), triples)| {
        let words: Vec<String> = triples.iter().flat_map(Triple::words).map(|w| w.to_string()).collect();
        format!("\"{kind}\": [{}]", words.join(","))
    });
    write_script(&folder.path().join("jobs.js"), "LTC_JOBS", jobs.collect());
    let dom = dump(&page, &folder.path().join("profile"));
    let results = dom.split_once("<pre id=\"results\">{").and_then(|(_, rest)| rest.split_once("}</pre>"));
    let (lists, _) = results.unwrap_or_else(|| panic!("Chromium gave no results: {dom}"));
    let number = |text: &str| text.parse().unwrap_or(f32::NAN);
    // "quad":[1,2],"line":[3] in the order of the jobs.
    let lists = lists.split('[').skip(1).map(|list| list.split(']').next().unwrap());
    lists.flat_map(|list| list.split(',').map(number)).collect()
}

fn write_script(file: &Path, name: &str, entries: Vec<String>) {
    fs::write(file, format!("const {name} = {{{}}};\n", entries.join(",\n"))).unwrap();
}

fn json_string(text: &str) -> String {
    let escaped = text.replace('\\', "\\\\").replace('"', "\\\"").replace('\n', "\\n");
    format!("\"{escaped}\"")
}

/// The page after its scripts have run.
fn dump(page: &Path, profile: &Path) -> String {
    let output = Command::new("chromium")
        .args(["--headless", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"])
        // Compiling takes longer than it thinks that anything may.
        .arg("--disable-gpu-watchdog")
        .arg(format!("--user-data-dir={}", profile.display()))
        .args(["--dump-dom", &format!("file://{}", page.display())])
        .output()
        .unwrap();
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// A program for each of these kinds.
fn computes_the_same(kinds: &[LightKind]) {
    let library = |kind: &LightKind| {
        let request = ShaderRequest::new([*kind], request().features);
        let Code::Text(library) = request.export(Language::GlslEs).unwrap().code else { panic!("no text") };
        (*kind, library)
    };
    let libraries: Vec<_> = kinds.iter().map(library).collect();
    let triples = triples(kinds, EACH, random(15));
    let results = in_chromium(&libraries, &triples);
    let largest = compare(&triples, &results).unwrap();
    println!("GLSL ES: largest error {largest:.4} of what is allowed");
    // The control: the results of one light, taken for its neighbour's.
    let mut swapped = results;
    swapped.rotate_left(1);
    compare(&triples, &swapped).unwrap_err();
}

#[test]
fn glsl_es_in_chromium_computes_the_same() {
    if has("chromium") {
        let all = LightKind::ALL.into_iter();
        computes_the_same(&all.filter(|kind| *kind != LightKind::Cylinder).collect::<Vec<_>>());
    }
}

#[test]
fn glsl_es_in_chromium_computes_the_same_cylinder() {
    if !has("chromium") {
        return;
    }
    if std::env::var_os("CI").is_none() && std::env::var_os("LTC_CYLINDER_IN_CHROMIUM").is_none() {
        eprintln!(
            "skipped, because SwiftShader takes three minutes to compile a cylinder: set LTC_CYLINDER_IN_CHROMIUM, or CI"
        );
        return;
    }
    computes_the_same(&[LightKind::Cylinder]);
}
