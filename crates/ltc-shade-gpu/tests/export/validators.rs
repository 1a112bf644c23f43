//! Every permutation in every language, by compilers that we did not write.

use std::fs;
use std::path::Path;

use ltc_shade_gpu::{Code, ExportError, Language, ShaderRequest};

use crate::support::{errors, has, verdict};

fn source(request: &ShaderRequest, language: Language) -> String {
    match request.export(language).unwrap_or_else(|e| panic!("{request:?}: {e}")).code {
        Code::Text(text) => text,
        Code::Words(_) => panic!("{language} is text"),
    }
}

/// The library as a program that a validator takes.
fn program(library: &str, version: &str) -> String {
    format!("#version {version}\n{library}\n{}void main() {{}}\n", texels(library, "vec4"))
}

/// What a host defines where tables are functions.
fn texels(library: &str, four: &str) -> String {
    let names = ["ltc_isotropic_texel", "ltc_anisotropic_texel", "ltc_baked_texel"];
    let declared = names.into_iter().filter(|name| library.contains(&format!("\n{four} {name}(")));
    declared
        .map(|name| {
            format!("{four} {name}(uint entry, uint group) {{ return {four}(0.0, 0.0, 0.0, 0.0); }}\n")
        })
        .collect()
}

/// What is given to compilers: all lights at once under every choice, each light alone under none and under all, each lookup
/// and each further feature. What naga's own validator sees (`modules.rs`) is every light alone under every choice, too.
fn classes() -> Vec<ShaderRequest> {
    let mut list = ShaderRequest::permutations();
    list.retain(|request| request.lights.len() != 1 || [0, 4].contains(&request.features.len()));
    assert_eq!(list.len(), 69);
    list
}

fn check(file: &Path, bytes: &[u8], program: &str, args: &[&str]) -> Result<(), String> {
    fs::write(file, bytes).map_err(|e| e.to_string())?;
    verdict(program, args, file)
}

#[test]
fn glslang_takes_every_permutation_of_glsl() {
    if !(has("glslangValidator") && has("spirv-val")) {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let found = errors(&classes(), |i, request| {
        let text = program(&source(request, Language::Glsl), "450");
        let (file, words) = (folder.path().join(format!("{i}.frag")), folder.path().join(format!("{i}.spv")));
        check(&file, text.as_bytes(), "glslangValidator", &["-V", "-o", words.to_str().unwrap()])?;
        verdict("spirv-val", &["--target-env", "vulkan1.0"], &words)
    });
    assert!(found.is_empty(), "{} refused: {}", found.len(), found[0]);
}

#[test]
fn glslang_takes_every_permutation_of_glsl_es() {
    if !has("glslangValidator") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let found = errors(&classes(), |i, request| {
        let text = program(&source(request, Language::GlslEs), "300 es");
        check(&folder.path().join(format!("{i}.frag")), text.as_bytes(), "glslangValidator", &[])
    });
    assert!(found.is_empty(), "{} refused: {}", found.len(), found[0]);
}

#[test]
fn spirv_val_takes_every_permutation_of_spirv() {
    if !has("spirv-val") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let all = classes();
    let found = errors(&all, |i, request| {
        let bytes = match request.export(Language::Spirv) {
            Ok(exported) => exported.bytes(),
            // The four features that are neither light nor lookup, each alone.
            Err(ExportError::NoKernel) if request.lights.is_empty() => return Ok(()),
            Err(error) => return Err(format!("{request:?}: {error}")),
        };
        check(&folder.path().join(format!("{i}.spv")), &bytes, "spirv-val", &["--target-env", "vulkan1.1"])
    });
    assert!(found.is_empty(), "{} refused: {}", found.len(), found[0]);
    let written = fs::read_dir(folder.path()).unwrap().count();
    assert_eq!(written, all.len() - 4);
}

/// By glslang's own reader of HLSL; Microsoft's compilers run elsewhere.
#[test]
fn glslang_takes_every_permutation_of_hlsl() {
    if !(has("glslangValidator") && has("spirv-val")) {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let found = errors(&classes(), |i, request| {
        let main = "float4 main() : SV_Target { return float4(0.0, 0.0, 0.0, 0.0); }";
        let library = source(request, Language::Hlsl);
        let text = format!("{library}\n{}{main}\n", texels(&library, "float4"));
        let (file, words) = (folder.path().join(format!("{i}.hlsl")), folder.path().join(format!("{i}.spv")));
        let args = ["-D", "-V", "-S", "frag", "-e", "main", "-o", words.to_str().unwrap()];
        check(&file, text.as_bytes(), "glslangValidator", &args)?;
        verdict("spirv-val", &["--target-env", "vulkan1.0"], &words)
    });
    assert!(found.is_empty(), "{} refused: {}", found.len(), found[0]);
}

/// No compiler of it is at hand: what can be told from the text alone.
#[test]
fn msl_holds_the_functions_that_were_asked_for() {
    let found = errors(&classes(), |_, request| {
        let text = source(request, Language::Msl);
        let balanced = text.matches('{').count() == text.matches('}').count();
        let lacking = request.lights.iter().find(|light| {
            let name = light.name().replace('-', "_");
            !text.contains(&format!("\nfloat ltc_{name}("))
                && !text.contains(&format!("\nLtcPolygon ltc_{name}("))
        });
        match (balanced, lacking) {
            (true, None) => Ok(()),
            _ => Err(format!("braces balanced: {balanced}, lacking: {lacking:?}, of {request:?}")),
        }
    });
    assert!(found.is_empty(), "{}", found[0]);
}

#[test]
fn a_planted_fault_is_refused_by_each_validator() {
    if !(has("glslangValidator") && has("spirv-val")) {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let request = ShaderRequest::permutations().remove(0);
    for (language, version) in [(Language::Glsl, "450"), (Language::GlslEs, "300 es")] {
        // A name that nothing defines.
        let text = program(&source(&request, language), version).replace("LTC_TINY)", "LTC_TINNY)");
        let file = folder.path().join(format!("{language}.frag"));
        let said = check(&file, text.as_bytes(), "glslangValidator", &[]).unwrap_err();
        assert!(said.contains("LTC_TINNY"), "{said}");
    }
    let mut words = request.export(Language::Spirv).unwrap().bytes();
    let end = words.len() - 4;
    words.truncate(end);
    let file = folder.path().join("cut.spv");
    check(&file, &words, "spirv-val", &["--target-env", "vulkan1.1"]).unwrap_err();
}
